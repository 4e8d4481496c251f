// SPDX-License-Identifier: Apache-2.0
// Brings the layers above the tiles up to date after tiles changed: around the change where that is enough, else over
// the whole map. Both ways lead to the same map.
#pragma once

#include <cstdint>
#include <vector>

#include "cluxel/progress.hpp"
#include "mapping/build/tile_stages.hpp"
#include "mapping/change/map_things.hpp"
#include "mapping/change/object_changes.hpp"
#include "mapping/facts/semantic_layer.hpp"

namespace cluxel::mapping {

/// With the objects that differ.
struct SemanticUpdate : DifferentObjects {
  bool is_local = false;                                   ///< computed around the change
  bool took_decisions = false;                             ///< of another map
  std::size_t tiles_decided = 0;                           ///< in which the rules ran: a window, or all
  std::uint64_t objects = 0, cluxels = 0, primitives = 0;  ///< of the map afterwards
  std::vector<StatementOutcome> statements;
  std::vector<WholeRule> whole_rules;  ///< SPARQL rules that were evaluated for the whole map, as inferAll() tells them
};

/// For writeThings(): whether an object that the update does not list exists before and after.
IsInBoth keptBy(const rdf::ReadTransaction& transaction, const SemanticUpdate& update);

/// What may have changed since the layers were made.
enum class ChangedInputs : std::uint8_t {
  Scans,      ///< scans, poses and statements
  Inference,  ///< only SPARQL rules, or an ontology with the same classes, superclasses and parts
  Rules,      ///< all these, and the rules that decide about objects
  Any,        ///< classes, model or settings too
};

inline constexpr double kNoWindowLimit = 2;  ///< a window never gives way to the whole map

struct UpdateParams {
  unsigned threads = 1;  ///< the result is the same for every number
  /// Largest window, as a fraction of the tiles. A change that needs a larger one is computed over the whole map.
  double max_window_share = 0.6;
  /// A map of more cluxels, of which all is to be decided, is decided strip by strip.
  std::uint64_t whole_cluxels = 1'500'000;
  bool lists_objects = true;       ///< SemanticUpdate tells the objects that differ
  bool is_first_of_commit = true;  ///< the layers are as the commit before has them
};

/// Takes the changes of `stages`. Stores everything but inputs and history.
SemanticUpdate updateSemanticLayer(rdf::WriteTransaction& transaction, const ParsedInputs& parsed, TileStages& stages,
                                   ChangedInputs inputs, const UpdateParams& params, ProgressSink& sink,
                                   const rdf::InferenceCheck& check = {});

}  // namespace cluxel::mapping
