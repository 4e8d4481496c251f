// SPDX-License-Identifier: Apache-2.0
// How the bytes of a map file are divided among its tables.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "rdf/file/environment.hpp"

namespace cluxel::rdf {

struct LayerSize {
  std::string name;              ///< of a block table, "terms", "hashes", an index, "other pages" or "free pages"
  std::uint64_t entries = 0;     ///< blocks, terms, quads; pages in the last two rows
  std::uint64_t file_bytes = 0;  ///< with the heads of entries, and whole pages where an entry has its own
  bool operator==(const LayerSize&) const = default;
};

/// The block tables by name, then the tables of the RDF, then pages that no entry fills and pages that are free. The
/// sum of `file_bytes` is the size of the part of the file that the commit knows. Cost: the keys of all blocks are
/// read, and the indexes are compared with their sums.
std::vector<LayerSize> layerSizes(const ReadTransaction& transaction);

struct FreeSpace {
  std::uint64_t bytes = 0;          ///< that a rewrite would free
  std::uint64_t file_bytes = 0;     ///< size of the file up to the last page of the commit
  std::uint64_t in_free_pages = 0;  ///< the share of `bytes` in free pages; the rest lies in half-filled index pages
  std::uint64_t disk_bytes = 0;     ///< that the file takes on the disk, without its holes

  /// What free pages take on the disk, where they are no holes.
  std::uint64_t freeOnDisk() const {
    const std::uint64_t in_use = file_bytes - in_free_pages;
    return disk_bytes - std::min(disk_bytes, in_use);
  }
};
/// Cost: the list of free pages is read.
FreeSpace freeSpaceOf(const ReadTransaction& transaction);

}  // namespace cluxel::rdf
