// SPDX-License-Identifier: Apache-2.0
// Ontology, rules, facts and closure, in the order in which they build on each other.
#include "mapping/semantic_layer.hpp"

#include "cluxel/base/diagnostic.hpp"
#include "cluxel/knowledge/ontology.hpp"
#include "cluxel/knowledge/rdf_io.hpp"
#include "cluxel/knowledge/vocabulary.hpp"
#include "cluxel/mapping/ask_check.hpp"
#include "cluxel/mapping/class_catalogue_of.hpp"
#include "cluxel/reasoning/reason.hpp"
#include "cluxel/reasoning/rule_loader.hpp"
#include "mapping/ask_oracle.hpp"
#include "mapping/map_facts.hpp"
#include "mapping/object_store.hpp"
#include "mapping/scan_store.hpp"
#include "mapping/sparql_rules.hpp"

namespace cluxel {

namespace {

std::vector<RdfSource> ontologySources(const std::vector<NamedText>& texts) {
  std::vector<RdfSource> sources;
  sources.reserve(texts.size());
  for (const NamedText& text : texts)
    sources.push_back({text.text, text.name, RdfFormat::Turtle, std::string(vocabulary::kClx),
                       Term::iri(vocabulary::kGraphOntology)});
  return sources;
}

std::vector<RuleSource> ruleSources(const std::vector<NamedText>& texts) {
  std::vector<RuleSource> sources;
  sources.reserve(texts.size());
  for (const NamedText& text : texts) sources.push_back({text.name, text.text});
  return sources;
}

/// Makes the observed graph hold the facts of the scene and of `reasoning`.
void writeObserved(WriteTransaction& transaction, const ObservedMap& map) {
  QuadWriter writer(transaction);
  FactSink facts(writer, vocabulary::kGraphObserved);
  addObservedFacts(map, facts);
  writer.flush();
  facts.writeTo(QuadReader(static_cast<const ReadTransaction&>(transaction)));
  writer.flush();
}

}  // namespace

void writeOntology(WriteTransaction& transaction, const MapInputs& inputs) {
  QuadWriter writer(transaction);
  writer.clearGraph(writer.intern(Term::iri(vocabulary::kGraphOntology)));
  loadOntology(ontologySources(inputs.ontology), writer);
  writer.flush();
}

void writeObjectsSoFar(WriteTransaction& transaction, const MapInputs& inputs, const std::vector<Cloud>& clouds,
                       const Scene& scene, const TileStages& stages, std::span<const SemanticObject> objects) {
  const ReasoningResult so_far{{objects.begin(), objects.end()}, {}};
  const auto sightings = sightingsOf(stages.points(), stages.cluxels(), objectOfCluxel(so_far, scene.cluxels.size()));
  writeObserved(transaction, {inputs, clouds, scene, so_far, sightings});
  inferClosure(transaction);
}

ClassCatalogue classCatalogueOf(const std::vector<NamedText>& ontology) {
  ClassCatalogue catalogue;
  for (const OntologyClass& known : ontologyViewOf(ontologySources(ontology)).classes)
    catalogue.classes.push_back({known.iri, known.superclasses, known.parts});
  return catalogue;
}

ParsedInputs parseInputs(const MapInputs& inputs) {
  ParsedInputs parsed;
  parsed.inputs = inputs;
  parsed.model = parseModel(inputs.model.text, inputs.model.name);
  checkRanges(inputs.params);
  parsed.rules = loadRuleTexts(ruleSources(inputs.rules), inputs.rule_roots, classCatalogueOf(inputs.ontology),
                               withCheckedQueries())
                     .require();
  checkSparqlRules(inputs.sparql_rules);
  return parsed;
}

SemanticCounts writeSemanticLayer(WriteTransaction& transaction, const ParsedInputs& parsed, const TileStages& stages,
                                  ProgressSink& sink) {
  writeOntology(transaction, parsed.inputs);
  const Scene scene = stages.scene();
  sink.progress("scene", scene.primitives.size(), scene.primitives.size());
  const std::vector<Cloud> clouds = storedClouds(transaction);
  MapOracle oracle(transaction, [&](std::span<const SemanticObject> objects) {
    writeObjectsSoFar(transaction, parsed.inputs, clouds, scene, stages, objects);
  });
  const ReasoningResult result = reason(scene, parsed.rules, {&oracle});
  sink.progress("objects", result.objects.size(), result.objects.size());
  const auto sightings = sightingsOf(stages.points(), stages.cluxels(), objectOfCluxel(result, scene.cluxels.size()));
  writeObserved(transaction, {parsed.inputs, clouds, scene, result, sightings});
  inferClosure(transaction);
  runSparqlRules(transaction, parsed.inputs.sparql_rules);
  storeObjects(transaction, result.objects);
  sink.progress("facts", 1, 1);
  return {scene.cluxels.size(), scene.primitives.size(), result.objects.size()};
}

}  // namespace cluxel
