// SPDX-License-Identifier: Apache-2.0
// Verifies a whole map.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace cluxel::rdf {

/// Version of the layout of a map file; none of a later one is opened. A map of version 1 is read too, and becomes one
/// of version 2 with the next commit. Of a map before version 3 the RDF is read and changed; its points and tiles are
/// not: they were stored in another form.
inline constexpr int kMapFormat = 6;

struct MapCheck {
  std::uint64_t blocks = 0, terms = 0, quads = 0;  ///< numbers of checked items
  std::vector<std::string> faults;                 ///< in words for a person; at most some dozens
  bool sound() const { return faults.empty(); }
};

/// Verifies the structure of all pages, the checksum of every block, every term and its entry in the hash index, and
/// that each index holds exactly the quads that belong in it, all of known terms, and that the index of geometries fits
/// the map. Does not crash on a damaged file. Throws Error (StoreUnavailable) when there is no map. Cost: reads the
/// whole file.
MapCheck checkMap(const std::filesystem::path& file);

/// True when the file begins with an LMDB meta page. Cost: one page read.
bool looksLikeMap(const std::filesystem::path& file);

/// True when a process was killed after it had begun the file and before it had committed anything: nothing is in it.
/// Cost: two page reads.
bool hasNoCommit(const std::filesystem::path& file);

}  // namespace cluxel::rdf
