// SPDX-License-Identifier: Apache-2.0
// From the scene to the semantic layer: ontology, objects, facts, closure, SPARQL rules.
#pragma once

#include <span>
#include <vector>

#include "cluxel/progress.hpp"
#include "mapping/build/tile_stages.hpp"
#include "mapping/clouds/cloud.hpp"
#include "mapping/inference/whole_rules.hpp"
#include "mapping/map_inputs.hpp"
#include "mapping/statements/applied_statements.hpp"
#include "mapping/ways/ways.hpp"
#include "perception/segments/scene.hpp"
#include "rdf/file/environment.hpp"
#include "rdf/ontology/ontology.hpp"
#include "rules/language/rule_set.hpp"
#include "rules/objects/semantic_object.hpp"

namespace cluxel::mapping {

/// The parsed inputs of a map. Parsing reports all faults before anything is written.
struct ParsedInputs {
  MapInputs inputs;
  perception::LabelModel model;
  rules::RuleSet rules;
};
/// Throws InputError with all faults of ontology, rules or model.
ParsedInputs parseInputs(const MapInputs& inputs);
/// The same for rules and an ontology that no map has yet: rules of classes that are not below clx:Object are refused.
/// A map of an earlier program may have such rules, and can still be read and changed.
/// `ontology`: ontologyOf() the inputs.
ParsedInputs parseNewInputs(const MapInputs& inputs, const rdf::OntologyView& ontology);

/// Replaces graph ontology by the inputs' ontology.
void writeOntology(rdf::WriteTransaction& transaction, const MapInputs& inputs);
/// Adds to graph observed what is told of the map itself.
void writeMapFacts(rdf::WriteTransaction& transaction, const MapInputs& inputs);
/// Replaces the graphs observed and inferred by what a query of the reasoning stage may see: the scene and `objects`,
/// those of the classes decided so far.
void writeObjectsSoFar(rdf::WriteTransaction& transaction, const MapInputs& inputs, const std::vector<Cloud>& clouds,
                       const perception::Scene& scene, const TileStages& stages, const WayGraph& ways,
                       std::span<const rules::SemanticObject> objects);

/// Makes graph inferred hold the closure and what SPARQL rules derive. Notes and gives what inferAll() does.
std::vector<WholeRule> inferFacts(rdf::WriteTransaction& transaction, const MapInputs& inputs, ProgressSink& sink,
                                  const rdf::InferenceCheck& check = {});

struct SemanticLayer {
  perception::Scene scene;
  std::vector<rules::SemanticObject> objects;  ///< sorted by id
  std::vector<StatementOutcome> statements;    ///< what became of the operator's statements
  std::vector<WholeRule> whole_rules;          ///< as inferAll() tells them
};

/// Computes objects and facts of the stages' outputs and stores them. The graphs ontology, observed and inferred are
/// then a function of these outputs and the inputs.
SemanticLayer writeSemanticLayer(rdf::WriteTransaction& transaction, const ParsedInputs& parsed, TileStages& stages,
                                 unsigned threads, ProgressSink& sink, const rdf::InferenceCheck& check = {});

}  // namespace cluxel::mapping
