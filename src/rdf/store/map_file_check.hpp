// SPDX-License-Identifier: Apache-2.0
// Checks a file before LMDB maps it: LMDB does not validate page numbers and crashes on one beyond the end.
#pragma once

#include <cstdint>
#include <filesystem>

namespace cluxel::rdf {

/// The relevant fields of the two meta pages.
struct MapFileHead {
  std::uint64_t page_size = 0, last_page = 0, file_size = 0, transaction = 0;
};

/// Reads the meta pages of an open file; throws Error (StoreUnavailable) when they are not those of a map. The
/// page_size of an empty file is 0. Cost: two page reads.
MapFileHead readMapFileHead(int descriptor, const std::filesystem::path& file);

/// True when checkMapStructure() should run before opening: the file is small, or shorter than its meta pages state.
bool needsStructureCheck(const MapFileHead& head);

/// Visits every page reachable from the meta page of `transaction`; throws Error (StoreUnavailable) at the first that
/// lies beyond the end, is reached twice or is malformed. Never reads outside the file. Cost: one read per page,
/// without overflow pages.
void checkMapStructure(int descriptor, const std::filesystem::path& file, std::uint64_t transaction);

}  // namespace cluxel::rdf
