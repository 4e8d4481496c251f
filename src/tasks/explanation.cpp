// SPDX-License-Identifier: Apache-2.0
// Finds what a name means in a map and has the rules explain it.
#include "tasks/explanation.hpp"

#include <algorithm>
#include <charconv>
#include <map>
#include <nlohmann/json.hpp>

#include "base/ascii.hpp"
#include "base/nearest_name.hpp"
#include "cluxel/error.hpp"
#include "mapping/change/map_things.hpp"
#include "mapping/change/statement_change.hpp"
#include "mapping/facts/ask_replay.hpp"
#include "mapping/statements/applied_statements.hpp"
#include "rdf/map_iris.hpp"
#include "rules/explain/part_run.hpp"
#include "rules/explain/path_tree.hpp"
#include "rules/explain/why_not.hpp"
#include "rules/language/rule_loader.hpp"

namespace cluxel::tasks {

namespace {

constexpr std::size_t kMinDigits = 4;  ///< of a hash

rules::RuleSet rulesOf(const mapping::MapInputs& inputs) {
  std::vector<rules::RuleSource> sources;
  for (const mapping::NamedText& text : inputs.rules) sources.push_back({text.name, text.text});
  return loadRuleTexts(sources, inputs.rule_roots, classCatalogueOf(inputs.ontology)).require();
}

/// Names rule files relative to the folder of the first: the map holds the paths of the machine that built it.
void shortenFiles(rules::Decision& decision, const mapping::MapInputs& inputs) {
  if (inputs.rules.empty()) return;
  const std::filesystem::path folder = std::filesystem::path(inputs.rules.front().name).parent_path();
  const auto shorten = [&](std::string& name) { name = mapping::nameWithin(folder, name).string(); };
  for (rules::DecisionStep& step : decision.path) shorten(step.file);
  for (rules::EvidenceStep& step : decision.evidence) shorten(step.file);
}

void shortenFiles(rules::Explanation& explanation, const mapping::MapInputs& inputs) {
  for (rules::ExplainedDecision& explained : explanation.decisions) shortenFiles(explained.decision, inputs);
}

/// The name without what tables and other formats write around it: <IRI>, map:object/HEX.
std::string plainName(const std::string& written) {
  std::string_view name = trimmed(written);  // lines of CSV end in CR LF
  if (name.starts_with('<') && name.ends_with('>')) name = name.substr(1, name.size() - 2);
  if (name.starts_with("map:")) name.remove_prefix(4);
  return std::string(name);
}

bool isNamed(const std::string& kind, const ContentHash& id, const std::string& name) {
  const std::string hex = id.hex(), path = kind + "/" + hex;
  return path.starts_with(name) || hex.starts_with(name) || name.ends_with("/map/" + path);
}

/// The place of the only item that has the name; none when there is none.
template <typename Items>
std::optional<std::size_t> findOne(const Items& items, const std::string& kind, const std::string& name) {
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (!isNamed(kind, items[i].id, name)) continue;
    if (found) throw Error(ErrorKind::NotFound, "'" + name + "' names more than one " + kind + "; write more digits");
    found = i;
  }
  return found;
}

std::optional<std::size_t> numberIn(std::string_view digits) {
  std::size_t number = 0;
  const auto [end, fault] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  const bool is_number = fault == std::errc() && end == digits.data() + digits.size();
  return is_number ? std::optional(number) : std::nullopt;
}

/// "#17", or "17" where it is too short for a hash.
std::optional<std::size_t> objectNumber(const std::string& name, std::size_t objects) {
  const bool is_marked = name.starts_with('#');
  if (!is_marked && name.size() >= kMinDigits) return std::nullopt;
  const auto number = numberIn(std::string_view(name).substr(is_marked ? 1 : 0));
  if (number && *number >= objects)
    throw Error(ErrorKind::NotFound, "there is no object #" + std::to_string(*number) + ": the map has " +
                                         std::to_string(objects) + " objects, numbered from 0");
  if (!number && is_marked) throw Error(ErrorKind::InvalidArgument, "'" + name + "' is not the number of an object");
  return number;
}

/// What a name means: one of these.
struct Named {
  std::optional<std::size_t> object, primitive;
};

std::optional<mapping::FormerName> formerName(const mapping::MapReader& map, const std::string& name) {
  std::vector<ContentHash> present;
  for (const rules::SemanticObject& object : map.objects()) present.push_back(object.id);
  return mapping::Lineage(map.quads(), present).find(name);
}

std::size_t numberOf(const std::vector<rules::SemanticObject>& objects, const ContentHash& id) {
  const auto found = std::find_if(objects.begin(), objects.end(), [&](const auto& object) { return object.id == id; });
  return static_cast<std::size_t>(found - objects.begin());
}

Named find(const mapping::MapReader& map, const std::string& name) {
  Named named;
  named.object = objectNumber(name, map.objects().size());
  if (named.object) return named;
  if (name.size() < kMinDigits)
    throw Error(ErrorKind::InvalidArgument,
                "'" + name + "' is too short: write the number of an object, or at least four digits of a hash");
  named.object = findOne(map.objects(), "object", name);
  named.primitive = findOne(map.scene().primitives, "primitive", name);
  // Four digits or more may be meant as a number too; a hash that begins so comes first, "#" makes it a number.
  if (!named.object && !named.primitive)
    if (const auto number = numberIn(name); number && *number < map.objects().size()) named.object = number;
  if (!named.object && !named.primitive)
    if (const auto former = formerName(map, name)) named.object = numberOf(map.objects(), former->object);
  if (named.object && named.primitive)
    throw Error(ErrorKind::NotFound, "'" + name + "' names an object and a primitive; write more digits, or object/" +
                                         name + " or primitive/" + name);
  if (named.object || named.primitive) return named;
  for (const mapping::OverruledObject& overruled : map.overruled())
    if (!overruled.now && isNamed("object", overruled.by_rules.id, name))
      throw Error(ErrorKind::NotFound, "object/" + overruled.by_rules.id.hex() +
                                           " was removed by an operator statement; it is back once that is withdrawn");
  throw Error(ErrorKind::NotFound, "nothing in the map is named '" + name + "'; the question objects.rq lists objects");
}

std::vector<perception::PrimitiveIndex> primitivesOf(const mapping::MapReader& map, const Named& named) {
  if (named.primitive) return {static_cast<perception::PrimitiveIndex>(*named.primitive)};
  return primitivesOf(map.objects()[*named.object]);
}

std::optional<rules::PartRun> partAround(const mapping::MapReader& map, const Named& named,
                                         const rules::RuleSet& rules) {
  const std::vector<std::uint64_t> traces = map.decisionTraces();
  const std::vector<rules::SemanticObject> by_rules = map.objectsByRules();
  return runInPart(map.scene(), rules, {traces, by_rules}, primitivesOf(map, named));
}

/// The object's thing, and what operators state about it.
std::string historyOf(const mapping::MapReader& map, std::size_t number, nlohmann::ordered_json& json) {
  const rules::SemanticObject& object = map.objects()[number];
  const std::string thing = thingOf(mapping::storedThings(map.quads()), object.id).iri;
  json["thing"] = thing;
  std::string text = "thing/" + mapping::localName(thing) + "\n";
  for (const mapping::KnownStatement& known : mapping::knownStatements(map.quads())) {
    if (known.object != rdf::iriOfObject(object.id)) continue;
    json["stated"].push_back({{"statement", known.statement.id().hex()},
                              {"states", textOf(known.statement)},
                              {"effect", known.effect},
                              {"author", known.author},
                              {"statedAt", known.stated_at},
                              {"rulesSay", known.rules_class},
                              {"contradictsRules", known.contradicts}});
    text += "stated" + (known.author.empty() ? "" : " by " + known.author) +
            (known.stated_at.empty() ? "" : " " + known.stated_at) + ": " + textOf(known.statement) + " (" +
            known.effect + (known.contradicts ? ", against the rules" : "") + ")\n";
  }
  if (object.rule_id == mapping::kOperatorRule) text += "without the statement the rules decide:\n";
  return text;
}

/// An explanation, with the part of the scene that its numbers refer to when it is not the whole.
struct Explained {
  rules::Explanation explanation;
  std::optional<rules::PartRun> run;

  const perception::Scene& sceneOf(const mapping::MapReader& map) const { return run ? run->part : map.scene(); }
};

Explained explanationOf(const mapping::MapReader& map, const Named& named, const rules::RuleSet& rules) {
  const rules::SemanticObject* object = named.primitive ? nullptr : &map.byRules(map.objects()[*named.object]);
  if (auto run = partAround(map, named, rules)) {
    std::optional<rules::Explanation> explanation;
    if (object == nullptr)
      explanation = explanationIn(run->result, rules, run->primitives.front());
    else
      explanation = explanationIn(run->result, rules, object->id);
    if (explanation) return {std::move(*explanation), std::move(run)};
  }
  mapping::AskReplay oracle(map);
  const rules::ReasoningContext context{.oracle = &oracle};
  if (object == nullptr) return {explain(map.scene(), rules, context, primitivesOf(map, named).front()), std::nullopt};
  std::optional<rules::Explanation> explanation = explain(map.scene(), rules, context, *object);
  if (!explanation)
    throw Error(ErrorKind::NotFound, "the map's rules make no object '" + object->id.hex() + "' any more");
  return {std::move(*explanation), std::nullopt};
}

struct WhyNotOfThing {
  rules::WhyNot why;
  std::string headline;
};

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

WhyNotOfThing whyNotOf(const mapping::MapReader& map, const rules::RuleSet& rules, const mapping::MapInputs& inputs,
                       const std::string& written, const std::string& class_name) {
  const Named named = find(map, plainName(written));
  const std::string class_iri = classNamed(rules, class_name);
  const auto id = named.object ? std::optional(map.byRules(map.objects()[*named.object]).id) : std::nullopt;
  mapping::AskReplay oracle(map);
  const rules::ReasoningContext context{.oracle = &oracle};
  const perception::Scene& scene = map.scene();
  const std::vector<perception::PrimitiveIndex> primitives = primitivesOf(map, named);
  const rules::ReasoningResult made = reason(scene, rules, context);
  const rules::SemanticObject* owner = ownerOf(made.objects, primitives, id);
  WhyNotOfThing thing{whyNot(scene, rules, context, made, owner, primitives, class_iri), ""};
  thing.headline = owner == nullptr ? "belongs to no object: unknown"
                                    : "belongs to " + rules.shorten(owner->class_iri) + " " + owner->id.hex() +
                                          ", by rule " + owner->rule_id;
  for (rules::RuleVerdict& verdict : thing.why.rules) shortenFiles(verdict.decision, inputs);
  return thing;
}

}  // namespace

std::string classNamed(const rules::RuleSet& rules, const std::string& written) {
  const std::string name =
      written.starts_with('<') && written.ends_with('>') ? written.substr(1, written.size() - 2) : written;
  std::vector<std::string> known;
  for (const rules::ClassEntry& entry : rules.catalogue.classes) {
    const std::string local = mapping::localName(entry.iri);
    if (name == entry.iri || name == local || name == rules.shorten(entry.iri)) return entry.iri;
    known.push_back(local);
  }
  const std::string hint = suggestion(name, known);
  throw Error(ErrorKind::NotFound, "the ontology knows no class '" + name + "'" + (hint.empty() ? "" : "; " + hint));
}

std::string classNamed(const rules::ClassCatalogue& classes, const std::string& written) {
  rules::RuleSet rules;
  rules.catalogue = classes;
  rules.prefixes["clx"] = rdf::vocabulary::kClx;
  return classNamed(rules, written);
}

std::string nameNote(const mapping::MapReader& map, const std::string& written) {
  const std::string name = plainName(written);
  const auto known = [&](const auto& items, const std::string& kind) { return findOne(items, kind, name).has_value(); };
  if (name.size() < kMinDigits || name.starts_with('#') || known(map.objects(), "object")) return {};
  if (known(map.scene().primitives, "primitive")) return {};
  const auto former = formerName(map, name);
  return former ? former->meaning + " is now object/" + former->object.hex() : "";
}

std::size_t objectNamed(const mapping::MapReader& map, const std::string& name) {
  const Named named = find(map, plainName(name));
  if (!named.object) throw Error(ErrorKind::NotFound, "'" + name + "' names a primitive, not an object");
  return *named.object;
}

ExplanationTexts explainWhyNot(const mapping::MapReader& map, const std::string& name, const std::string& class_name) {
  const mapping::MapInputs inputs = map.inputs();
  const rules::RuleSet rules = rulesOf(inputs);
  const WhyNotOfThing thing = whyNotOf(map, rules, inputs, name, class_name);
  return {thing.headline + "\n" + textOf(thing.why, rules), jsonOf(thing.why, rules)};
}

std::string explanationGraph(const mapping::MapReader& map, const std::string& name, const std::string& class_name) {
  const mapping::MapInputs inputs = map.inputs();
  const rules::RuleSet rules = rulesOf(inputs);
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
  const rules::Explanation explanation = explanationOf(map, find(map, plainName(name)), rules).explanation;
  const rules::Decision* told = nullptr;
  for (const rules::ExplainedDecision& explained : explanation.decisions)
    if (told == nullptr || explained.decision.accepted) told = &explained.decision;
  if (told == nullptr) throw Error(ErrorKind::NotFound, "no rule decided about '" + name + "'");
  return graphOf(*told);
}

ExplanationTexts explainThing(const mapping::MapReader& map, const std::string& written) {
  const Named named = find(map, plainName(written));
  const mapping::MapInputs inputs = map.inputs();
  const rules::RuleSet rules = rulesOf(inputs);
  Explained explained = explanationOf(map, named, rules);
  shortenFiles(explained.explanation, inputs);
  const perception::Scene& scene = explained.sceneOf(map);
  auto json = nlohmann::ordered_json::parse(jsonOf(explained.explanation, rules, scene));
  std::string text = textOf(explained.explanation, rules, scene);
  if (named.object) {
    json["number"] = *named.object;
    text = "object #" + std::to_string(*named.object) + "\n" + historyOf(map, *named.object, json) + text;
  }
  return {std::move(text), json.dump(2)};
}

std::string explainThing(const mapping::MapReader& map, const std::string& name, bool as_json) {
  ExplanationTexts texts = explainThing(map, name);
  return as_json ? std::move(texts.json) : std::move(texts.text);
}

std::vector<std::string> explainObjects(const mapping::MapReader& map) {
  const mapping::MapInputs inputs = map.inputs();
  const rules::RuleSet rules = rulesOf(inputs);
  mapping::AskReplay oracle(map);
  const rules::ReasoningContext context{.oracle = &oracle};
  const rules::ReasoningResult result = reason(map.scene(), rules, context);
  std::vector<rules::Explanation> explanations = explainAll(map.scene(), rules, context, result);
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
