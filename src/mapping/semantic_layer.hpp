// SPDX-License-Identifier: Apache-2.0
// From the scene to the map's knowledge: ontology, objects by rules, facts, closure.
#pragma once

#include <span>
#include <vector>

#include "cluxel/base/progress.hpp"
#include "cluxel/knowledge/environment.hpp"
#include "cluxel/mapping/cloud.hpp"
#include "cluxel/mapping/map_inputs.hpp"
#include "cluxel/perception/scene.hpp"
#include "cluxel/reasoning/rule_set.hpp"
#include "cluxel/reasoning/semantic_object.hpp"
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

/// Makes graph ontology hold the inputs' ontology.
void writeOntology(WriteTransaction& transaction, const MapInputs& inputs);
/// Makes the graphs observed and inferred hold what a query of the reasoning stage may see: the scene, and the objects
/// of the classes that have had their turn.
void writeObjectsSoFar(WriteTransaction& transaction, const MapInputs& inputs, const std::vector<Cloud>& clouds,
                       const Scene& scene, const TileStages& stages, std::span<const SemanticObject> objects);

struct SemanticCounts {
  std::size_t cluxels = 0, primitives = 0, objects = 0;
};

/// Computes objects and facts of what `stages` holds and stores them. The graphs ontology, observed and inferred become
/// a function of the stages' outputs and the inputs.
SemanticCounts writeSemanticLayer(WriteTransaction& transaction, const ParsedInputs& parsed, const TileStages& stages,
                                  ProgressSink& sink);

}  // namespace cluxel
