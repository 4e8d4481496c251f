// SPDX-License-Identifier: Apache-2.0
// Finds what a name means in a map and has the rules explain it.
#include "tasks/explanation.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/nearest_name.hpp"
#include "cluxel/error.hpp"
#include "mapping/facts/ask_replay.hpp"
#include "mapping/facts/semantic_layer.hpp"
#include "mapping/map_part.hpp"
#include "mapping/splits_store.hpp"
#include "mapping/statements/applied_statements.hpp"
#include "rdf/vocabulary.hpp"
#include "rules/decide/local_reach.hpp"
#include "rules/explain/part_run.hpp"
#include "rules/explain/path_tree.hpp"
#include "rules/explain/why_not.hpp"
#include "tasks/derived_classes.hpp"
#include "tasks/explanation_names.hpp"
#include "tasks/named_class.hpp"
#include "tasks/stated_of_things.hpp"
#include "tasks/thing_names.hpp"

namespace cluxel::tasks {

namespace {

constexpr double kAll = std::numeric_limits<double>::infinity();

/// What is explained: an object or a primitive.
struct Explainable {
  std::optional<ContentHash> object, primitive;
  std::optional<perception::TileKey> tile;  ///< of the primitive, if it is known
};

/// An object that reaches through the map is explained at one of its primitives.
Explainable explainableOf(const mapping::MapReader& map, const NamedThing& named) {
  if (named.object && map.isClassWide(*named.object))
    if (const auto sample = map.samplePrimitiveOf(*named.object)) return {{}, sample->primitive, sample->tile};
  return {named.object, named.primitive, {}};
}

std::optional<mapping::MapPart> partAround(const mapping::MapReader& map, const Explainable& what,
                                           const mapping::PartSize& size) {
  auto part = what.tile        ? map.partAroundTile(*what.tile, size)
              : what.primitive ? map.partAroundPrimitive(*what.primitive, size)
                               : map.partAroundObject(*what.object, size);
  return part ? std::optional(withObjectsByRules(map, *std::move(part))) : std::nullopt;
}

std::vector<perception::PrimitiveIndex> primitivesIn(const perception::Scene& scene,
                                                     const std::vector<rules::SemanticObject>& objects,
                                                     const Explainable& what) {
  if (what.object)
    for (const rules::SemanticObject& object : objects)
      if (object.id == *what.object) return primitivesOf(object);
  if (what.primitive)
    for (perception::PrimitiveIndex i = 0; i < scene.primitives.size(); ++i)
      if (scene.primitives[i].id == *what.primitive) return {i};
  return {};
}

/// A run over a part of the map that decides about the thing as the run over the map did. Parts of some tiles are tried
/// before the map is read as a whole.
std::optional<rules::PartRun> runAround(const mapping::MapReader& map, const Explainable& what,
                                        const rules::RuleSet& rules) {
  if (rules.asks_map) return std::nullopt;
  struct Around {
    mapping::PartSize size;
    std::vector<double> margins_m;  ///< smaller ones were tried with fewer rings
  };
  constexpr double near_m = rules::kSameOwnersWithin_m;  // a cut object there would be decided otherwise
  // A larger part mostly depends on what lies around it. With the next ring it costs little more.
  constexpr std::size_t kFewCluxels = 150'000;
  rules::KnownSplits splits = mapping::storedSplitsIfFew(map.transaction());
  for (const Around& around :
       {Around{{1, near_m, kFewCluxels}, {kAll}}, Around{{2, near_m}, {kAll}}, Around{{3, near_m}, {30, kAll}}}) {
    std::optional<mapping::MapPart> part = partAround(map, what, around.size);
    if (!part) continue;
    const auto primitives = primitivesIn(part->scene, part->objects, what);
    const auto scene = std::make_shared<const perception::Scene>(std::move(part->scene));
    if (auto run = runInPart(scene, rules, {part->traces, part->objects, &splits}, primitives, {around.margins_m, 1}))
      return run;
  }
  const std::vector<std::uint64_t> traces = map.decisionTraces();
  const std::vector<rules::SemanticObject> by_rules = map.objectsByRules();
  return runInPart(map.scene(), rules, {traces, by_rules, &splits}, primitivesIn(map.scene(), map.objects(), what));
}

/// An explanation, with the part of the scene that its numbers refer to when it is not the whole.
struct Explained {
  rules::Explanation explanation;
  std::optional<rules::PartRun> run;

  const perception::Scene& sceneOf(const mapping::MapReader& map) const { return run ? *run->part : map.scene(); }
};

/// The name that the rules gave to an object of the map.
ContentHash idByRules(const mapping::MapReader& map, const ContentHash& object) {
  for (const mapping::OverruledObject& overruled : map.overruled())
    if (overruled.now == object) return overruled.by_rules.id;
  return object;
}

Explained explanationOf(const mapping::MapReader& map, const NamedThing& named, const rules::RuleSet& rules) {
  const Explainable what = explainableOf(map, named);
  if (auto run = runAround(map, what, rules)) {
    std::optional<rules::Explanation> explanation;
    if (what.object)
      explanation = explanationIn(run->result, rules, idByRules(map, *what.object));
    else
      explanation = explanationIn(run->result, rules, run->primitives.front());
    if (explanation) return {std::move(*explanation), std::move(run)};
  }
  mapping::AskReplay oracle(map);
  const rules::ReasoningContext context{.oracle = &oracle};
  if (!what.object)
    return {explain(map.scene(), rules, context, primitivesIn(map.scene(), {}, what).front()), std::nullopt};
  const rules::SemanticObject* object = &map.byRules(map.objects()[named.number]);
  std::optional<rules::Explanation> explanation = explain(map.scene(), rules, context, *object);
  if (!explanation)
    throw Error(ErrorKind::NotFound, "the map's rules make no object '" + object->id.hex() + "' any more");
  return {std::move(*explanation), std::nullopt};
}

struct WhyNotOfThing {
  rules::WhyNot why;
  std::string headline;
  std::optional<rules::SemanticObject> owner;  ///< as the rules make it
};

std::optional<rules::SemanticObject> copyOf(const rules::SemanticObject* object) {
  return object == nullptr ? std::nullopt : std::optional(*object);
}

std::string headlineOf(const rules::SemanticObject* owner, const rules::RuleSet& rules) {
  if (owner == nullptr) return "belongs to no object: unknown";
  return "belongs to " + rules.shorten(owner->class_iri) + " " + owner->id.hex() + ", by rule " + owner->rule_id;
}

/// The object that is named, or that owns the named primitive; null when there is none. `primitives` are the named
/// ones by their numbers in the run that made `objects`.
const rules::SemanticObject* ownerOf(const std::vector<rules::SemanticObject>& objects,
                                     const std::vector<perception::PrimitiveIndex>& primitives,
                                     const std::optional<ContentHash>& id) {
  const rules::SemanticObject* owner = nullptr;
  for (const rules::SemanticObject& object : objects) {
    const auto owned = rules::primitivesOf(object);
    if (id ? object.id == *id : std::binary_search(owned.begin(), owned.end(), primitives.front())) owner = &object;
  }
  return owner;
}

/// From the tiles around the thing, with what the whole map would tell. Absent when they may not be enough.
std::optional<WhyNotOfThing> whyNotAround(const mapping::MapReader& map, const rules::RuleSet& rules,
                                          const Explainable& what, const std::string& class_iri) {
  const std::optional<double> reach_m = rules::localReach(rules).reach_m;
  if (!reach_m || *reach_m > perception::kTileSize_m) return std::nullopt;
  const mapping::ThingPlace place =
      what.object ? map.placeOfObject(*what.object) : map.placeOfPrimitive(*what.primitive);
  rules::KnownSplits splits = mapping::storedSplitsIfFew(map.transaction());
  // The first holds the narrowest seam next to the thing; the wider ones were chosen, not measured.
  for (const mapping::LayersAround& around : {mapping::LayersAround{4, 0}, {7, 2}, {13, 4}}) {
    auto part = map.partOfLayers(place, rules, *reach_m, around);
    if (!part) return std::nullopt;
    part = withObjectsByRules(map, *std::move(part));
    const std::vector<perception::PrimitiveIndex> primitives = primitivesIn(part->scene, part->objects, what);
    std::vector<char> is_dirty(part->scene.primitives.size(), 0);
    for (const perception::PrimitiveIndex primitive : primitives) is_dirty[primitive] = 1;
    auto said = considerIn({part->scene, is_dirty, part->is_open, {}, {part->traces.begin(), part->traces.end()}},
                           rules, {.splits = &splits}, class_iri, *reach_m);
    if (!said) continue;
    const auto run = runInPart(part->scene, rules, {part->traces, part->objects, &splits}, primitives, {{16, kAll}, 1});
    if (!run) continue;
    const auto id = what.object ? std::optional(idByRules(map, *what.object)) : std::nullopt;
    const rules::SemanticObject* owner = ownerOf(run->result.objects, run->primitives, id);
    return WhyNotOfThing{whyNot(*std::move(said), rules, run->result, owner, class_iri), headlineOf(owner, rules),
                         copyOf(owner)};
  }
  return std::nullopt;
}

WhyNotOfThing whyNotInMap(const mapping::MapReader& map, const rules::RuleSet& rules, const Explainable& what,
                          const std::string& class_iri) {
  mapping::AskReplay oracle(map);
  const rules::ReasoningContext context{.oracle = &oracle};
  const std::vector<perception::PrimitiveIndex> primitives = primitivesIn(map.scene(), map.objects(), what);
  const rules::ReasoningResult made = reason(map.scene(), rules, context);
  const auto id = what.object ? std::optional(idByRules(map, *what.object)) : std::nullopt;
  const rules::SemanticObject* owner = ownerOf(made.objects, primitives, id);
  auto said = considerFor(map.scene(), rules, context, class_iri, primitives);
  return {whyNot(std::move(said), rules, made, owner, class_iri), headlineOf(owner, rules), copyOf(owner)};
}

WhyNotOfThing whyNotOf(const mapping::MapReader& map, const rules::RuleSet& rules, const mapping::MapInputs& inputs,
                       const std::string& written, const std::string& class_name) {
  const NamedThing named = thingNamed(map, written);
  const std::string class_iri = classNamed(map, class_name);
  const Explainable what{named.object, named.primitive, {}};
  const bool reaches_far = named.object && map.isClassWide(*named.object);
  auto around = reaches_far ? std::nullopt : whyNotAround(map, rules, what, class_iri);
  WhyNotOfThing thing = around ? *std::move(around) : whyNotInMap(map, rules, what, class_iri);
  for (rules::RuleVerdict& verdict : thing.why.rules) shortenFiles(verdict.decision, inputs);
  return thing;
}

}  // namespace

ExplanationTexts explainWhyNot(const mapping::MapReader& map, const std::string& name, const std::string& class_name) {
  const mapping::MapInputs inputs = map.inputs();
  const rules::RuleSet rules = mapping::parseInputs(inputs).rules;
  const WhyNotOfThing thing = whyNotOf(map, rules, inputs, name, class_name);
  auto json = nlohmann::ordered_json::parse(jsonOf(thing.why, rules));
  const std::string stated = statedOf(map, rules, thing.owner, json);
  const std::string derived =
      sparqlRulesText(map, rules, inputs, thingNamed(map, name).object, thing.why.class_iri, json);
  return {stated + thing.headline + "\n" + derived + textOf(thing.why, rules), json.dump(2)};
}

std::string explanationGraph(const mapping::MapReader& map, const std::string& name, const std::string& class_name) {
  const mapping::MapInputs inputs = map.inputs();
  const rules::RuleSet rules = mapping::parseInputs(inputs).rules;
  const auto graphOf = [&](const rules::Decision& decision) { return dotOf(*rules.find(decision.rule_id), decision); };
  if (!class_name.empty()) {
    const WhyNotOfThing thing = whyNotOf(map, rules, inputs, name, class_name);
    const auto judged = std::find_if(thing.why.rules.begin(), thing.why.rules.end(),
                                     [](const auto& verdict) { return verdict.nearness <= rules::Nearness::Rejected; });
    if (judged == thing.why.rules.end())
      throw Error(ErrorKind::NotFound,
                  "no rule of class '" + class_name + "' looked at '" + name + "': ask for the text to see why");
    return graphOf(judged->decision);
  }
  const rules::Explanation explanation = explanationOf(map, thingNamed(map, name), rules).explanation;
  const rules::Decision* told = nullptr;
  for (const rules::ExplainedDecision& explained : explanation.decisions)
    if (told == nullptr || explained.decision.accepted) told = &explained.decision;
  if (told == nullptr) throw Error(ErrorKind::NotFound, "no rule decided about '" + name + "'");
  return graphOf(*told);
}

ExplanationTexts explainThing(const mapping::MapReader& map, const std::string& written) {
  const NamedThing named = thingNamed(map, written);
  const mapping::MapInputs inputs = map.inputs();
  const rules::RuleSet rules = mapping::parseInputs(inputs).rules;
  Explained explained = explanationOf(map, named, rules);
  shortenFiles(explained.explanation, inputs);
  const perception::Scene& scene = explained.sceneOf(map);
  auto json = nlohmann::ordered_json::parse(jsonOf(explained.explanation, rules, scene));
  std::string text = textOf(explained.explanation, rules, scene);
  if (named.object) {
    json["number"] = named.number;
    const std::string history = historyOf(map, *named.object, json);
    const std::string derived = derivedClassesText(map, rules, *named.object, json);
    text = "object #" + std::to_string(named.number) + "\n" + history + derived + text;
  } else {
    text = statedOf(map, rules, explained.explanation.object, json) + text;
  }
  return {std::move(text), json.dump(2)};
}

std::string explainThing(const mapping::MapReader& map, const std::string& name, bool as_json) {
  ExplanationTexts texts = explainThing(map, name);
  return as_json ? std::move(texts.json) : std::move(texts.text);
}

std::string explainObject(const mapping::MapReader& map, std::size_t number) {
  const mapping::MapInputs inputs = map.inputs();
  const rules::RuleSet rules = mapping::parseInputs(inputs).rules;
  Explained explained = explanationOf(map, {map.objectIds().at(number), std::nullopt, number}, rules);
  shortenFiles(explained.explanation, inputs);
  return nlohmann::ordered_json::parse(jsonOf(explained.explanation, rules, explained.sceneOf(map))).dump();
}

std::vector<std::string> explainObjects(const mapping::MapReader& map) {
  const mapping::MapInputs inputs = map.inputs();
  const rules::RuleSet rules = mapping::parseInputs(inputs).rules;
  mapping::AskReplay oracle(map);
  const rules::ReasoningContext context{.oracle = &oracle};
  const rules::ReasoningResult result = reason(map.scene(), rules, context);
  std::map<ContentHash, perception::PrimitiveIndex> samples;
  for (const rules::SemanticObject& object : map.objects())
    if (const Explainable what = explainableOf(map, NamedThing{object.id, std::nullopt, 0}); what.tile)
      samples.emplace(map.byRules(object).id, primitivesIn(map.scene(), {}, what).front());
  std::vector<rules::Explanation> explanations = explainAll(map.scene(), rules, context, result, samples);
  std::map<ContentHash, std::string> by_object;
  for (rules::Explanation& explanation : explanations) {
    shortenFiles(explanation, inputs);
    by_object[explanation.object->id] = nlohmann::ordered_json::parse(jsonOf(explanation, rules, map.scene())).dump();
  }
  std::vector<std::string> texts;
  texts.reserve(map.objects().size());
  for (const rules::SemanticObject& object : map.objects()) texts.push_back(by_object[map.byRules(object).id]);
  return texts;
}

}  // namespace cluxel::tasks
