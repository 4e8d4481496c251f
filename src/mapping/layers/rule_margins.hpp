// SPDX-License-Identifier: Apache-2.0
// How far the thresholds of the rules may move before something in a tile is decided anew, in the map file.
#pragma once

#include <optional>

#include "perception/tile.hpp"
#include "rdf/file/environment.hpp"
#include "rules/decide/threshold_margins.hpp"

namespace cluxel::mapping {

/// Makes the map hold the margins of a run over all of it.
void storeMargins(rdf::WriteTransaction& transaction, const rules::TileMargins& margins, const rules::RuleSet& rules);

/// Takes those of a run over some `tiles`. In those that are `decided` everything was decided anew. In the others some
/// things were decided in earlier runs, whose margins stay: so they may be narrower than those of a build, which costs
/// time and changes no decision.
void updateMargins(rdf::WriteTransaction& transaction, const rules::TileMargins& margins,
                   const perception::TileSet& tiles, const perception::TileSet& decided);

/// The map is now decided by these rules: stores what the margins of its tiles do not tell of them.
void storeNumbers(rdf::WriteTransaction& transaction, const rules::RuleSet& rules);

struct RuleChange {
  perception::TileSet tiles;  ///< in which other rules may decide otherwise than those of the map
  double former_reach_m = 0;  ///< how far those of the map look
};
/// Absent when that is not known: the rules differ by more than numbers of which margins are stored. Cost: about 20 us
/// a tile.
std::optional<RuleChange> changeOfRules(const rdf::ReadTransaction& transaction, const rules::RuleSet& rules);

}  // namespace cluxel::mapping
