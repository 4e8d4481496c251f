// SPDX-License-Identifier: Apache-2.0
// Strips of a map's tiles, across the direction in which they spread most: a strip has a short border. What is too
// large to be computed at once goes strip by strip.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <vector>

#include "perception/segments/summary_tile.hpp"
#include "perception/tile.hpp"
#include "rdf/file/environment.hpp"

namespace cluxel::mapping {

/// All tiles in `count` strips or fewer, of about the same weight, from one end of the area to the other.
std::vector<perception::TileSet> stripsOf(const perception::TileSet& tiles, std::size_t count,
                                          const std::function<std::uint64_t(const perception::TileKey&)>& weight_of);

/// How many cluxels the tiles have. Those that are not among `at_hand` are read.
std::uint64_t cluxelsIn(const rdf::ReadTransaction& transaction, const perception::TileSet& tiles,
                        const std::map<perception::TileKey, perception::SummaryTile>& at_hand);

/// As stripsOf(), of tiles whose layers are to be decided. They have some `cluxels`; a map of `whole_cluxels` could be
/// decided at once.
std::vector<perception::TileSet> layerStripsOf(const rdf::ReadTransaction& transaction,
                                               const perception::TileSet& tiles, std::uint64_t cluxels,
                                               std::uint64_t whole_cluxels);

}  // namespace cluxel::mapping
