// SPDX-License-Identifier: Apache-2.0
// Looking a whole map over for damage.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace cluxel {

struct MapCheck {
  std::uint64_t blocks = 0, terms = 0, quads = 0;  ///< how many were looked at
  std::vector<std::string> faults;                 ///< in words for a person; at most some dozens
  bool sound() const { return faults.empty(); }
};

/// Reads everything: the structure of all pages, the checksum of every block, every term with its entry in the hash
/// index, and that the four indexes hold the same quads of known terms. Never crashes on a damaged file. Error
/// (StoreUnavailable) when there is no map to look at. Cost: reads the file.
MapCheck checkMap(const std::filesystem::path& file);

/// Whether the file begins as LMDB's files do, whatever its name. Cost: one page read.
bool looksLikeMap(const std::filesystem::path& file);

}  // namespace cluxel
