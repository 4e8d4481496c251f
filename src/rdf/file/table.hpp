// SPDX-License-Identifier: Apache-2.0
// The LMDB databases of a map file.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace cluxel::rdf {

/// An index is one constant key with sorted 16-byte values. Maps of earlier formats lack index psog.
enum class Table : std::uint8_t { Blocks, Terms, TermHashes, Spog, Posg, Ospg, Gspo, Psog };
inline constexpr std::size_t kTableCount = 8;
inline constexpr std::array<const char*, kTableCount> kTableNames = {"blocks", "terms", "hashes", "spog",
                                                                     "posg",   "ospg",  "gspo",   "psog"};
inline constexpr std::array<Table, 6> kIndexTables = {Table::TermHashes, Table::Spog, Table::Posg,
                                                      Table::Ospg,       Table::Gspo, Table::Psog};

}  // namespace cluxel::rdf
