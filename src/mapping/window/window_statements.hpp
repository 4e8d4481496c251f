// SPDX-License-Identifier: Apache-2.0
// Operator statements about what lies in a window: they are applied to what the rules decide there. A statement, and an
// object that it changes, is decided anew as a whole or not at all.
#pragma once

#include <optional>
#include <set>
#include <vector>

#include "mapping/facts/semantic_layer.hpp"
#include "mapping/layers/semantic_state.hpp"
#include "mapping/statements/overruled_objects.hpp"
#include "mapping/statements/statement_places.hpp"
#include "mapping/window/map_window.hpp"
#include "mapping/window/window_change.hpp"
#include "mapping/window/window_decision.hpp"

namespace cluxel::mapping {

class WindowStatements {
 public:
  /// `before`: the map as it was, or the maps that were joined; a statement of one may be
  /// about what another has. `now`: the clouds and statements that there are. The references must outlive it.
  WindowStatements(const rdf::ReadTransaction& transaction, const ParsedInputs& parsed, TileStages& stages,
                   const std::vector<Cloud>& clouds, const OutputChanges& changes,
                   const std::vector<SemanticState>& before, const SemanticState& now);

  /// The tiles in which all has to be decided anew because of statements; they count as changed.
  const perception::TileSet& tiles() const { return tiles_; }

  /// Applies the statements that `decision` concerns, and puts the objects that follow into it. False when more has to
  /// be decided anew: then tiles() has grown, or needsWholeMap() holds.
  bool apply(const MapWindow& window, const WindowChange& change, WindowDecision& decision);
  /// More tiles do not help, or what a withdrawn statement said of a class-wide object has to be removed.
  bool needsWholeMap() const { return needs_whole_map_; }

  /// After apply().
  const std::vector<StatementOutcome>& outcomes() const { return applied_.outcomes; }
  /// Statements whose facts are to be removed: those of outcomes(), and withdrawn ones.
  std::vector<ContentHash> exchanged() const;
  /// Writes what is kept about statements.
  void store(rdf::WriteTransaction& transaction, const MapWindow& window);

 private:
  struct Touched;

  void grow(const perception::TileSet& tiles);
  bool growByPartlyDecided(const MapWindow& window, const WindowChange& change, const WindowDecision& decision,
                           const Touched& touched);
  bool growByPartlyChanged(const MapWindow& window, const WindowDecision& decision);
  void addAboutWideObjects();
  bool saysOfWideObject(const ContentHash& id) const;

  const rdf::ReadTransaction& transaction_;
  const ParsedInputs& parsed_;
  TileStages& stages_;
  const std::vector<Cloud>& clouds_;
  std::vector<Statement> statements_;  ///< ascending by id
  std::vector<ContentHash> withdrawn_;
  StatementTiles places_;                 ///< of the statements that there are
  std::vector<OverruledRecord> records_;  ///< as stored
  perception::TileSet tiles_;
  std::set<ContentHash> concerned_;  ///< statements of which all points lie in tiles_
  std::set<ContentHash> erased_;     ///< records
  bool needs_whole_map_ = false;
  AppliedStatements applied_;
};

}  // namespace cluxel::mapping
