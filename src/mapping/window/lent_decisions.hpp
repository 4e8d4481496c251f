// SPDX-License-Identifier: Apache-2.0
// What another map decided about tiles that a map takes from it: a merge then decides around the border alone.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "mapping/build/tile_stages.hpp"
#include "mapping/layers/semantic_state.hpp"
#include "mapping/window/lent_facts.hpp"
#include "mapping/window/window_decision.hpp"
#include "rdf/file/environment.hpp"

namespace cluxel::mapping {

/// Whether a map may take over what `lender`, a map of the same inputs and frame, decided: class-wide objects are
/// ground only, scans of both have the same pose and time, and facts about presence are told in both or in none. False
/// also where more than `max_share` of all tiles are likely to be decided anew, and where the border has more than
/// `max_border_tiles` tiles: it goes through the stages and is decided at once.
bool canLendDecisions(const rdf::ReadTransaction& map, const rdf::ReadTransaction& lender, double max_share,
                      std::size_t max_border_tiles);

/// Lends layers, records, margins, ways and facts of the tiles that only the lender had. With them the map is what two
/// maps side by side are: what lies within reach of both is to be decided anew.
class LentDecisions {
 public:
  /// The stages have taken the lender's tiles already, and layers of them are absent.
  LentDecisions(rdf::WriteTransaction& transaction, const rdf::ReadTransaction& lender);

  /// Gives the map all but the facts. `changes` then tells what differs from the map of each tile. Cost: that of
  /// copying the blocks, and some 10 us for each object and tile of the lender.
  void lend(OutputChanges& changes, TileStages& stages);
  /// Removes the lent layers, margins and records. Ways stay, because they follow from the tiles alone. Statement rows
  /// stay, because a run over the whole map replaces them.
  void takeBack();
  /// Adds the lender's facts about what was lent. Returns the ground patches (IRIs) that nothing may touch any more.
  /// Cost: some 2 us a fact.
  std::set<std::string> addFacts() { return facts_->add(transaction_); }

  /// Of both maps: clouds, statements, counts.
  const SemanticState& state() const { return state_; }
  /// Of each map.
  std::vector<SemanticState> statesOfMaps() const { return {own_state_, state_of_lender_}; }
  /// Where the maps meet: tiles of both, and those of the lender beside tiles of the map. Everything in them counts as
  /// new.
  const TileSet& border() const { return border_; }
  /// A lent tile of each class-wide object, which is told anew.
  const TileSet& tilesOfWide() const { return tiles_of_wide_; }
  /// Objects of each map that rays of the other's clouds may pass.
  const std::set<ContentHash>& passed() const { return passed_; }
  /// Whether a decision covers all objects that reach from lent tiles into common ones, and the wide ones.
  bool isCoveredBy(const WindowDecision& decision, const std::vector<rules::SemanticObject>& wide) const;

 private:
  void readCommonTiles();
  void lendRows();
  void lendRecords();
  void lendStatements();
  void lendRecord(const ContentHash& id, const ObjectRecord& record);
  void noteChanges(OutputChanges& changes, TileStages& stages) const;

  rdf::WriteTransaction& transaction_;
  const rdf::ReadTransaction& lender_;
  TileSet own_, lent_, common_, border_, tiles_of_wide_;
  std::set<ContentHash> passed_;
  SemanticState own_state_, state_of_lender_, state_;
  NotLent not_lent_;
  std::set<ContentHash> reaching_;              ///< objects of the lender in lent and common tiles
  std::set<ContentHash> added_;                 ///< records
  std::map<ContentHash, std::string> widened_;  ///< records that the map had of class-wide objects
  std::optional<LentFacts> facts_;
};

}  // namespace cluxel::mapping
