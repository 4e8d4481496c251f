// SPDX-License-Identifier: Apache-2.0
// Ontology, rules, facts and closure, in the order of their dependencies.
#include "mapping/facts/semantic_layer.hpp"

#include <algorithm>
#include <future>

#include "cluxel/error.hpp"
#include "mapping/build/freed_tiles.hpp"
#include "mapping/build/way_telling.hpp"
#include "mapping/build/way_tiles.hpp"
#include "mapping/clouds/scan_store.hpp"
#include "mapping/facts/map_facts.hpp"
#include "mapping/facts/map_oracle.hpp"
#include "mapping/facts/object_facts.hpp"
#include "mapping/facts/scene_facts.hpp"
#include "mapping/facts/way_facts.hpp"
#include "mapping/inference/infer_facts.hpp"
#include "mapping/inference/sparql_rules.hpp"
#include "mapping/layers/layer_update.hpp"
#include "mapping/layers/rule_margins.hpp"
#include "mapping/presence/object_presence.hpp"
#include "mapping/splits_store.hpp"
#include "mapping/statements/overruled_objects.hpp"
#include "mapping/statements/statement_facts.hpp"
#include "mapping/statements/statement_places.hpp"
#include "perception/segments/primitive_inputs.hpp"
#include "rdf/io/rdf_io.hpp"
#include "rdf/ontology/ontology.hpp"
#include "rdf/vocabulary.hpp"
#include "rules/decide/reason.hpp"
#include "rules/language/rule_loader.hpp"

namespace cluxel::mapping {

namespace {

std::vector<rules::RuleSource> ruleSources(const std::vector<NamedText>& texts) {
  std::vector<rules::RuleSource> sources;
  sources.reserve(texts.size());
  for (const NamedText& text : texts) sources.push_back({text.name, text.text});
  return sources;
}

ParsedInputs parsedWith(const MapInputs& inputs, const rules::ClassCatalogue& catalogue,
                        const rules::RuleLoadOptions& options) {
  ParsedInputs parsed;
  parsed.inputs = inputs;
  parsed.model = perception::parseModel(inputs.model.text, inputs.model.name);
  perception::checkRanges(inputs.params);
  parsed.rules = loadRuleTexts(ruleSources(inputs.rules), inputs.rule_roots, catalogue, options).require();
  // The volumes of two cluxels that touch grow towards each other, from seeds that lie in them.
  constexpr double kInside_m = 0.8;
  const double edge_m = 2 * parsed.model.perception.clustering.max_reach_m + kInside_m;
  parsed.rules.contact_m = std::max(parsed.rules.contact_m, edge_m);
  checkSparqlRules(inputs.sparql_rules);
  return parsed;
}

/// Makes the observed graph hold the facts of the scene, of `reasoning`, of statements and of ways. Returns the ways.
std::vector<ToldWay> writeObserved(SceneFacts& of_scene, const ObservedMap& map,
                                   const std::vector<StatementOutcome>& statements, const WayGraph& ways) {
  of_scene.collect();
  FactSink& facts = of_scene.sink();
  for (const StatementOutcome& outcome : statements)
    if (outcome.object) facts.addToUnits(*outcome.object);
  addObjectFacts(map, facts);
  addStatementFacts(statements, facts);
  ToldWays told = addWayFacts(ways, {}, facts);
  facts.finish();
  return std::move(told.now);
}

/// The ways of the map, as far as they are known before objects: with what gone things left in the ground as of the
/// commit before; with all of it when rules ask the map. With `is_beside` another thread makes them, which alone uses
/// the transaction until then.
std::shared_future<WayGraph> beginWays(rdf::WriteTransaction& transaction, TileStages& stages, unsigned threads,
                                       bool asks_map, bool is_beside) {
  if (asks_map) stages.noteEven({}, eraseFreedTiles(transaction));
  std::shared_future<WayGraph> ways = std::async(is_beside ? std::launch::async : std::launch::deferred, [&, threads] {
    stages.updateWays(transaction, std::max(1U, threads - 1));
    return storedWays(transaction);
  });
  if (!is_beside) ways.wait();
  return ways;
}

}  // namespace

void writeOntology(rdf::WriteTransaction& transaction, const MapInputs& inputs) {
  rdf::QuadWriter writer(transaction);
  writer.clearGraph(writer.intern(Term::iri(rdf::vocabulary::kGraphOntology)));
  loadOntology(ontologySources(inputs.ontology), writer);
  writer.flush();
}

void writeMapFacts(rdf::WriteTransaction& transaction, const MapInputs& inputs) {
  FactSink facts(transaction, rdf::vocabulary::kGraphObserved, FactsOf::Collected);
  addMap(inputs, {}, facts);
  for (const rdf::QuadIds& fact : facts.take()) facts.writer().add(fact);
  facts.writer().flush();
}

void writeObjectsSoFar(rdf::WriteTransaction& transaction, const MapInputs& inputs, const std::vector<Cloud>& clouds,
                       const perception::Scene& scene, const TileStages& stages, const WayGraph& ways,
                       std::span<const rules::SemanticObject> objects) {
  const rules::ReasoningResult so_far{{objects.begin(), objects.end()}, {}};
  const std::vector<std::uint32_t> object_of = objectOfCluxel(so_far, scene.cluxels.size());
  const auto sightings = sightingsOf(stages.summaries(), stages.grid(), object_of);
  const auto wide = mergedParts(wideTilesOf(scene, stages.summaries(), so_far.objects));
  SceneFacts facts(transaction, inputs, clouds, scene);
  writeObserved(
      facts, {inputs, clouds, scene, so_far, sightings, {}, {}, nearOf(so_far.objects, scene.cluxels, object_of), wide},
      {}, ways);
  inferClosure(transaction);
}

ParsedInputs parseInputs(const MapInputs& inputs) {
  return parsedWith(inputs, classCatalogueOf(inputs.ontology), withCheckedQueries());
}

ParsedInputs parseNewInputs(const MapInputs& inputs, const rdf::OntologyView& ontology) {
  rules::RuleLoadOptions options = withCheckedNewQueries();
  options.requires_objects = true;
  return parsedWith(inputs, rules::catalogueOf(ontology), options);
}

std::vector<WholeRule> inferFacts(rdf::WriteTransaction& transaction, const MapInputs& inputs, ProgressSink& sink,
                                  const rdf::InferenceCheck& check) {
  return inferAll(transaction, inputs.sparql_rules, sink, check);
}

SemanticLayer writeSemanticLayer(rdf::WriteTransaction& transaction, const ParsedInputs& parsed, TileStages& stages,
                                 unsigned threads, ProgressSink& sink, const rdf::InferenceCheck& check) {
  writeOntology(transaction, parsed.inputs);
  const std::vector<Cloud> clouds = storedClouds(transaction);
  rules::KnownSplits splits = storedSplits(transaction);
  const bool is_beside = threads > 1 && !parsed.rules.asks_map;  // ways and facts of the scene need no objects
  const std::shared_future<WayGraph> ways = beginWays(transaction, stages, threads, parsed.rules.asks_map, is_beside);
  perception::Scene scene = stages.takeScene(clouds);
  sink.progress("scene", scene.primitives.size(), scene.primitives.size());
  MapOracle oracle(transaction, [&](std::span<const rules::SemanticObject> objects) {
    if (check) check(0);
    writeObjectsSoFar(transaction, parsed.inputs, clouds, scene, stages, ways.get(), objects);
  });
  SceneFacts facts(transaction, parsed.inputs, clouds, scene);
  if (is_beside) facts.begin(ways);
  rules::ThresholdMargins margins(scene, parsed.rules);
  rules::ReasoningResult result =
      reason(scene, parsed.rules,
             {.oracle = &oracle, .threads = threads, .splits = &splits, .margins = &margins, .keeps_paths = false});
  facts.wait();
  if (check) check(0);
  const std::vector<std::uint64_t> traces = result.traces;
  AppliedStatements stated = appliedStatements(transaction, stages, parsed.model.perception.thin, clouds, scene,
                                               parsed.rules.catalogue, std::move(result.objects));
  result.objects = std::move(stated.objects);
  sink.progress("objects", result.objects.size(), result.objects.size());
  const std::vector<std::uint32_t> object_of = objectOfCluxel(result, scene.cluxels.size());
  const auto policy = threads > 1 ? std::launch::async : std::launch::deferred;
  auto near = std::async(policy, [&] { return nearOf(result.objects, scene.cluxels, object_of); });
  auto wide_tiles = std::async(policy, [&] { return wideTilesOf(scene, stages.summaries(), result.objects); });
  auto seen_as = std::async(policy, [&] { return sightingsOf(stages.summaries(), stages.grid(), object_of); });
  const ObjectPresence presence =
      updatePresence(transaction, rayTargets(scene, result.objects, parsed.rules), Covered::All, clouds, {}, threads);
  const auto sightings = seen_as.get();
  const std::vector<WideTile> wide = wide_tiles.get();
  auto blocks = std::async(policy, [&] {  // nothing below needs them before storeLayers()
    const std::vector<std::uint64_t> hashes = perception::inputHashes(scene, stages.summaries());
    return layerBlocks({.scene = scene, .objects = result.objects, .traces = traces, .inputs = hashes});
  });
  const auto storeAll = [&] {
    if (blocks.valid()) storeLayers(transaction, {.scene = scene, .objects = result.objects}, blocks.get());
  };
  if (mayHaveFreedTiles(transaction)) storeAll();  // what objects left in the ground is looked up in them
  const bool has_other_ways = freeWays(transaction, parsed, stages, threads);
  const std::vector<ToldWay> told_ways =
      writeObserved(facts,
                    {parsed.inputs, clouds, scene, result, sightings, presence.times, presence.rays, near.get(),
                     mergedParts(wide), threads},
                    stated.outcomes, has_other_ways ? storedWays(transaction) : ways.get());
  storeToldWays(transaction, told_ways);
  storeWideTiles(transaction, wide);
  std::vector<WholeRule> whole_rules = inferFacts(transaction, parsed.inputs, sink, check);
  storeAll();
  storeOverruled(transaction, stated.overruled, scene);
  storeStatementTiles(transaction, stated.tiles);
  storeSplits(transaction, splits);
  storeMargins(transaction, margins.found(), parsed.rules);
  sink.progress("facts", 1, 1);
  return {std::move(scene), std::move(result.objects), std::move(stated.outcomes), std::move(whole_rules)};
}

}  // namespace cluxel::mapping
