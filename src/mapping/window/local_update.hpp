// SPDX-License-Identifier: Apache-2.0
// The layers above the tiles, brought up to date around a change.
#pragma once

#include <optional>
#include <set>
#include <vector>

#include "mapping/layers/semantic_state.hpp"
#include "mapping/window/semantic_update.hpp"
#include "mapping/window/window_facts.hpp"

namespace cluxel::mapping {

class LentDecisions;

/// What an update of the layers works with. All must outlive it.
struct LayerWork {
  rdf::WriteTransaction& transaction;
  const ParsedInputs& parsed;
  TileStages& stages;
  const UpdateParams& params;
  ProgressSink& sink;
  const rdf::InferenceCheck& check;
};

/// One step of a change that is decided strip by strip. Only the tiles in `shown` take part.
struct MapStrip {
  perception::TileSet shown;             ///< the tiles of this strip and of those before
  perception::TileSet anew;              ///< this strip, and what lies beside it: everything there counts as new
  RetiredThings retired;                 ///< in the former layers of the strip, and not made again so far
  std::vector<SeenCloud> told_clouds;    ///< as the facts have them
  std::set<ContentHash> wide;            ///< class-wide objects that the map had
  rules::KnownSplits* splits = nullptr;  ///< may be absent
  perception::TileSet as_before;         ///< tiles that count as they were; their cluxels may get other seeds
  bool keeps_lists = false;              ///< SemanticUpdate tells the objects that differ
  LaterTargets* later = nullptr;         ///< gets the objects that were made: rays are looked at after all strips
};

/// Decides a window around the changed tiles and writes layers and facts. With `strip` (else null), inference and
/// presence are left to the caller. `lent`: decisions of another map, or null. `changes` gets the tiles in which
/// statements require a new decision. Absent, with no decision written, when the whole map has to be computed.
std::optional<SemanticUpdate> updateAround(const LayerWork& work, OutputChanges& changes, ChangedInputs inputs,
                                           LentDecisions* lent, const MapStrip* strip);

/// The ids of the operator's statements, ascending.
std::vector<ContentHash> statementIds(const rdf::ReadTransaction& transaction);

}  // namespace cluxel::mapping
