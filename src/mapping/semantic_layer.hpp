// SPDX-License-Identifier: Apache-2.0
// From the scene to the map's knowledge: ontology, objects by rules, facts, closure.
#pragma once

#include <vector>

#include "cluxel/base/progress.hpp"
#include "cluxel/knowledge/environment.hpp"
#include "cluxel/mapping/map_inputs.hpp"
#include "cluxel/perception/scene.hpp"
#include "cluxel/reasoning/rule_set.hpp"
#include "mapping/tile_stages.hpp"

namespace cluxel {

/// The inputs of a map, understood: all faults have been reported before anything is written.
struct ParsedInputs {
  MapInputs inputs;
  LabelModel model;
  RuleSet rules;
};
/// Throws InputError with all faults of ontology, rules or model.
ParsedInputs parseInputs(const MapInputs& inputs);

struct SemanticCounts {
  std::size_t cluxels = 0, primitives = 0, objects = 0;
};

/// Computes objects and facts of what `stages` holds and stores them. The graphs ontology, observed and inferred become a
/// function of the stages' outputs and the inputs.
SemanticCounts writeSemanticLayer(WriteTransaction& transaction, const ParsedInputs& parsed, const TileStages& stages,
                                  ProgressSink& sink);

}  // namespace cluxel
