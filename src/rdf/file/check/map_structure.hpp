// SPDX-License-Identifier: Apache-2.0
// Checks the pages of a map file: LMDB trusts them, and ends the program on numbers that a damaged file states.
#pragma once

#include <cstdint>
#include <filesystem>

#include "rdf/file/block_keys.hpp"

namespace cluxel::rdf {

enum class MapScope : std::uint8_t {
  Reading,  ///< what LMDB itself reads for a reader: the tables' records, the blocks' keys, the list of free pages
  /// What LMDB reads for a writer, without the leaves of indexes and terms and the heads of long blocks: page guards,
  /// term directories and requireHead() check those.
  Writing,
  Whole,  ///< every page but the contents of values and the keys in leaves of indexes
};

/// Visits the pages reachable from the meta page of commit `transaction`, which a read transaction pins. Throws Error
/// (StoreUnavailable) at the first page that is malformed, lies outside the file, is reached twice, or is listed as
/// free, and when a table holds more or less than its record states. Never reads outside the file. Cost of Reading: one
/// step per block; of Writing: also one per page of an index and of terms, and per page of a long value; of Whole: one
/// per block, per term, per page of an index, and per page of a long value.
/// `mapped`: the whole file in memory, if it is there already. Returns the keys of the blocks.
PresentKeys checkMapStructure(int descriptor, const std::filesystem::path& file, std::uint64_t transaction,
                              MapScope scope, const std::uint8_t* mapped = nullptr);

}  // namespace cluxel::rdf
