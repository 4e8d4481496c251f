// SPDX-License-Identifier: Apache-2.0
// The LMDB databases of a map file.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace cluxel::rdf {

/// An index is one constant key with sorted 16-byte values.
enum class Table : std::uint8_t { Blocks, Terms, TermHashes, Spog, Posg, Ospg, Gspo };
inline constexpr std::size_t kTableCount = 7;
inline constexpr std::array<const char*, kTableCount> kTableNames = {"blocks", "terms", "hashes", "spog",
                                                                     "posg",   "ospg",  "gspo"};

}  // namespace cluxel::rdf
