// SPDX-License-Identifier: Apache-2.0
// Reads the meta pages of a map file before LMDB maps it.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "rdf/file/lmdb_page.hpp"
#include "rdf/file/table.hpp"

namespace cluxel::rdf {

/// The relevant fields of the two meta pages.
struct MapFileHead {
  std::uint64_t page_size = 0, last_page = 0, file_size = 0, transaction = 0;
  std::array<std::optional<lmdb_page::Meta>, 2> metas;

  /// The meta page of a commit, when it is one of the last two.
  const lmdb_page::Meta* metaOf(std::uint64_t transaction) const;
};

/// Reads the meta pages of an open file; throws Error (StoreUnavailable) when they are not those of a map. The
/// page_size of an empty file is 0. Cost: two page reads.
MapFileHead readMapFileHead(int descriptor, const std::filesystem::path& file);

[[noreturn]] void refuseFile(const std::filesystem::path& file, const std::string& what);
/// "the map is damaged: `what`; restore ...".
[[noreturn]] void refuseDamaged(const std::filesystem::path& file, const std::string& what);
/// "the map is damaged: index NAME `what`; restore ...".
[[noreturn]] void refuseIndex(const std::filesystem::path& file, Table index, const std::string& what);

}  // namespace cluxel::rdf
