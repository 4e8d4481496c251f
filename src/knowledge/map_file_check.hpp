// SPDX-License-Identifier: Apache-2.0
// Looks at a file before LMDB maps it: LMDB trusts what it reads, and a page number beyond the end is a
// crash.
#pragma once

#include <cstdint>
#include <filesystem>

namespace cluxel {

/// What the two meta pages say.
struct MapFileHead {
  std::uint64_t page_size = 0, last_page = 0, file_size = 0, transaction = 0;
};

/// Reads the meta pages of an open file; Error (StoreUnavailable) when they are not those of a map. A file of
/// no bytes has page_size 0. Cost: two pages read.
MapFileHead readMapFileHead(int descriptor, const std::filesystem::path& file);

/// True when an open should be preceded by checkMapStructure: the file is small, or shorter than its meta
/// pages say.
bool needsStructureCheck(const MapFileHead& head);

/// Walks every page reachable from the meta page of `transaction` and throws Error (StoreUnavailable) at the
/// first that lies beyond the end, is reached twice or is malformed. Never reads outside the file. Cost: one
/// read per page, but long values are passed over.
void checkMapStructure(int descriptor, const std::filesystem::path& file, std::uint64_t transaction);

}  // namespace cluxel
