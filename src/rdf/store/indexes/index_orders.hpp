// SPDX-License-Identifier: Apache-2.0
// The keys of quads in the order of each index, from quads that are sorted already.
#pragma once

#include <span>
#include <vector>

#include "rdf/file/page_directory.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::rdf {

/// The keys of an index, ascending. `quads` are ascending. Cost: at most two passes over the quads, which distribute
/// them by one id each.
std::vector<Key128> keysOf(std::span<const QuadIds> quads, QuadOrder order);

}  // namespace cluxel::rdf
