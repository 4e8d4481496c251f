// SPDX-License-Identifier: Apache-2.0
// Loads a rule set: gather files, read names and constants, read rules, then check them against each other.
#include "rules/language/rule_loader.hpp"

#include <algorithm>
#include <set>

#include "base/nearest_name.hpp"
#include "rdf/vocabulary.hpp"
#include "rules/language/rule_definitions.hpp"
#include "rules/language/rule_reading.hpp"
#include "rules/language/rule_sources.hpp"
#include "rules/language/rule_thresholds.hpp"

namespace cluxel::rules {

namespace {

constexpr double kDefaultNothing = -3;  ///< one in twenty

void readNames(const GatheredRules& gathered, RuleReading& reading) {
  for (const auto& [key, value] : gathered.prefixes)
    if (const auto iri = readText(value, "an IRI", reading.faults)) reading.prefixes[key.text] = *iri;
  for (const auto& [key, value] : gathered.constants) {
    const auto quantity = parseQuantity(value, reading.faults);
    reading.constants[key.text] = {quantity.value_or(Quantity{}), key.at, false, !quantity.has_value()};
  }
}

void readOrder(const GatheredRules& gathered, RuleReading& reading, RuleSet& rules) {
  for (const std::vector<YamlNode>& nodes : gathered.order) {
    std::vector<std::string> stratum;
    for (const YamlNode& node : nodes)
      if (const auto iri = readClass(node, reading)) {
        if (std::find(rules.order.begin(), rules.order.end(), *iri) != rules.order.end())
          reading.faults.error(node.at, "'" + node.text + "' stands in the order twice");
        rules.order.push_back(*iri);
        stratum.push_back(*iri);
      }
    rules.strata.push_back(std::move(stratum));
  }
}

/// `nothing: { column: -1 }`: by label, the log-odds that a primitive which a rule accepts is no object.
void readNothing(const GatheredRules& gathered, RuleReading& reading, RuleSet& rules) {
  rules.nothing.fill(kDefaultNothing);
  for (const auto& [key, value] : gathered.nothing) {
    const auto label = scan::primitiveLabelOf(key.text);
    const std::vector<std::string> known{scan::kPrimitiveLabelNames.begin(), scan::kPrimitiveLabelNames.end()};
    if (!label) reading.faults.error(key.at, "unknown label '" + key.text + "'", suggestion(key.text, known));
    const auto log_odds = readQuantity(value, perception::Dimension::Ratio, reading);
    if (label && log_odds) rules.nothing[static_cast<std::size_t>(*label)] = log_odds->value;
  }
}

/// Whether the class is decided in the rule's own stratum, in competition with it.
bool isOfRival(const std::string& object_class, const Rule& rule, const RuleSet& rules) {
  if (object_class.empty() || rule.leftovers) return false;
  const auto own = std::find_if(rules.strata.begin(), rules.strata.end(), [&](const auto& stratum) {
    return std::find(stratum.begin(), stratum.end(), rule.class_iri) != stratum.end();
  });
  return own != rules.strata.end() && own->size() > 1 &&
         std::any_of(own->begin(), own->end(), [&](const auto& iri) { return rules.catalogue.isA(iri, object_class); });
}

/// Marks what looks at objects of rivals; true when there is any.
bool markRivals(Condition& condition, const Rule& rule, const RuleSet& rules, FaultList& faults) {
  bool any = false;
  const std::string& object_class = condition.target ? condition.target->object_class : condition.class_iri;
  if (isOfRival(object_class, rule, rules)) {
    any = condition.asks_rivals = true;
    const bool is_gap = condition.kind == Condition::Kind::Pair &&
                        (condition.measure == PairMeasure::Gap || condition.measure == PairMeasure::HorizontalGap);
    if (!is_gap)
      faults.error(condition.at,
                   rules.shorten(object_class) + " is decided together with " + rules.shorten(rule.class_iri) +
                       ": evidence may measure the gap to it only",
                   "write it as 'gap_to' or 'horizontal_gap_to'");
  }
  for (Condition& operand : condition.operands) any = markRivals(operand, rule, rules, faults) || any;
  return any;
}

void markRivals(RuleSet& rules, FaultList& faults) {
  for (Rule& rule : rules.rules) {
    const auto mark = [&](std::vector<EvidenceLine>& lines) {
      for (EvidenceLine& line : lines) line.asks_rivals = markRivals(line.measure, rule, rules, faults);
    };
    mark(rule.evidence);
    for (TreeNode& node : rule.nodes)
      if (auto* accept = std::get_if<AcceptLeaf>(&node.what)) mark(accept->evidence);
  }
}

/// A condition may only refer to objects of its own class or of classes in earlier strata. Those of its own stratum are
/// decided at the same time.
void checkEarlier(const std::string& object_class, const SourceLocation& at, const Rule& rule, const RuleSet& rules,
                  FaultList& faults) {
  if (object_class.empty() || rule.class_iri.empty()) return;
  if (rules.catalogue.isA(rule.class_iri, object_class)) return;
  bool beside = false;
  for (const std::vector<std::string>& stratum : rules.strata) {
    const bool made = std::any_of(stratum.begin(), stratum.end(),
                                  [&](const auto& iri) { return rules.catalogue.isA(iri, object_class); });
    const bool own = std::find(stratum.begin(), stratum.end(), rule.class_iri) != stratum.end();
    if (made && (!own || rule.leftovers)) return;
    beside = beside || (made && own);
    if (own) break;
  }
  if (beside)
    faults.error(at, rules.shorten(object_class) + " is decided together with " + rules.shorten(rule.class_iri),
                 "put it into an earlier stratum of 'order', or give the rule 'leftovers: true'");
  else
    faults.error(
        at, "no " + rules.shorten(object_class) + " exists yet when " + rules.shorten(rule.class_iri) + " has its turn",
        "classes that a rule looks at come earlier in 'order'");
}

/// A query sees the objects of earlier strata, not those of its own. What operators have stated it sees in every
/// stratum, so a late class may still be found: this is a warning. Classes that no stratum makes are left alone: they
/// may be of parts, primitives and places, which are in the map before.
void checkAsked(const std::string& object_class, const SourceLocation& at, const Rule& rule, const RuleSet& rules,
                FaultList& faults) {
  if (rule.class_iri.empty() || !rules.catalogue.isA(object_class, rdf::vocabulary::clx("Object"))) return;
  bool is_late = false;
  for (const std::vector<std::string>& stratum : rules.strata) {
    const bool makes = std::any_of(stratum.begin(), stratum.end(),
                                   [&](const auto& iri) { return rules.catalogue.isA(iri, object_class); });
    is_late = is_late || std::find(stratum.begin(), stratum.end(), rule.class_iri) != stratum.end();
    if (makes && !is_late) return;
    if (makes)
      return faults.warning(
          at,
          "the query looks for " + rules.shorten(object_class) + ", and no such object exists yet when " +
              rules.shorten(rule.class_iri) +
              " has its turn: this pattern finds only what operators have stated, as in a loaded register",
          "to find objects that rules make, put their class earlier in 'order'");
  }
}

void checkCondition(const Condition& condition, const Rule& rule, const RuleSet& rules, FaultList& faults) {
  if (condition.target && !condition.asks_rivals)
    checkEarlier(condition.target->object_class, condition.at, rule, rules, faults);
  if (!condition.asks_rivals) checkEarlier(condition.class_iri, condition.at, rule, rules, faults);
  for (const std::string& asked : condition.query_classes) checkAsked(asked, condition.at, rule, rules, faults);
  for (const Condition& operand : condition.operands) checkCondition(operand, rule, rules, faults);
}

void checkEvidence(const std::vector<EvidenceLine>& lines, const Rule& rule, const RuleSet& rules, FaultList& faults) {
  for (const EvidenceLine& line : lines) checkCondition(line.measure, rule, rules, faults);
}

void checkNodes(const Rule& rule, const RuleSet& rules, FaultList& faults) {
  std::vector<std::string> ids;
  for (const Rule& other : rules.rules) ids.push_back(other.id);
  for (const TreeNode& node : rule.nodes) {
    if (const auto* branch = std::get_if<BranchNode>(&node.what))
      checkCondition(branch->condition, rule, rules, faults);
    if (const auto* find = std::get_if<FindNode>(&node.what)) {
      checkEarlier(find->object_class, node.at, rule, rules, faults);
      for (const Condition& condition : find->where) checkCondition(condition, rule, rules, faults);
    }
    if (const auto* accept = std::get_if<AcceptLeaf>(&node.what)) checkEvidence(accept->evidence, rule, rules, faults);
    const auto* reject = std::get_if<RejectLeaf>(&node.what);
    if (reject != nullptr && !reject->hint.empty() && rules.find(reject->hint) == nullptr)
      faults.error(node.at, "the hint names no rule: '" + reject->hint + "'", suggestion(reject->hint, ids));
  }
}

/// `merge_into: related` needs a test of a relation to an object on the path to the leaf.
void checkMerges(const Rule& rule, NodeIndex index, bool related, FaultList& faults) {
  const TreeNode& node = rule.nodes[index];
  auto meetsObject = [](const auto& self, const Condition& c) -> bool {
    const bool object = c.target && c.target->kind == Target::Kind::Object;
    return object || std::any_of(c.operands.begin(), c.operands.end(), [&](const auto& o) { return self(self, o); });
  };
  if (const auto* branch = std::get_if<BranchNode>(&node.what)) {
    if (branch->yes != 0)
      checkMerges(rule, branch->yes, related || meetsObject(meetsObject, branch->condition), faults);
    if (branch->no != 0) checkMerges(rule, branch->no, related, faults);
  } else if (const auto* find = std::get_if<FindNode>(&node.what)) {
    if (find->found != 0) checkMerges(rule, find->found, related, faults);
    if (find->missing != 0) checkMerges(rule, find->missing, related, faults);
  } else if (const auto* accept = std::get_if<AcceptLeaf>(&node.what);
             accept != nullptr && accept->merge_into == MergeInto::Related) {
    if (!related)
      faults.error(node.at, "'merge_into: related', but no relation to an object was tested on the way",
                   "test: { relation: near, with: { object: clx:Building } }");
  }
}

/// Warns of unused names. Only in a file without errors, because errors cause such warnings.
void warnOfUnused(const GatheredRules& gathered, const RuleReading& reading, const std::set<std::string>& with_rules,
                  FaultList& faults) {
  for (const std::vector<YamlNode>& stratum : gathered.order)
    for (const YamlNode& node : stratum) {
      const auto prefix = reading.prefixes.find(node.text.substr(0, node.text.find(':')));
      if (prefix == reading.prefixes.end()) continue;
      if (with_rules.count(prefix->second + node.text.substr(node.text.find(':') + 1)) == 0)
        faults.warning(node.at, "no rule makes '" + node.text + "'");
    }
  for (const auto& [name, constant] : reading.constants)
    if (!constant.used) faults.warning(constant.at, "the constant '" + name + "' is not used");
}

/// Questions find objects by clx:Object: those of a class that does not lead there would be missing in every answer.
void checkIsObject(const Rule& rule, const RuleSet& rules, FaultList& faults) {
  if (rule.class_iri.empty() || rules.catalogue.isA(rule.class_iri, rdf::vocabulary::clx("Object"))) return;
  const std::string name = rules.shorten(rule.class_iri);
  faults.error(rule.at,
               "the class " + name + " of rule '" + rule.id +
                   "' is not below clx:Object, by which questions find objects of any class",
               "write in the ontology: " + name + " rdfs:subClassOf clx:Object, or a class that is below it");
}

/// `faulty`: rules of which some part was not read.
void checkTogether(const GatheredRules& gathered, const RuleReading& reading, const RuleSet& rules,
                   const std::set<std::string>& faulty, FaultList& faults) {
  std::set<std::string> with_rules;
  for (const Rule& rule : rules.rules) {
    with_rules.insert(rule.class_iri);
    const bool ordered = std::find(rules.order.begin(), rules.order.end(), rule.class_iri) != rules.order.end();
    if (!ordered && !rule.class_iri.empty() && !gathered.is_order_faulty)
      faults.error(rule.at,
                   "the class " + rules.shorten(rule.class_iri) + " of rule '" + rule.id +
                       "' does not stand in 'order', so the rule never runs",
                   "add it to 'order'");
    if (reading.options.requires_objects) checkIsObject(rule, rules, faults);
    checkEvidence(rule.evidence, rule, rules, faults);
    checkNodes(rule, rules, faults);
    if (!rule.nodes.empty() && !faulty.contains(rule.id)) checkMerges(rule, 0, false, faults);
  }
  if (faults.errorCount() == 0) warnOfUnused(gathered, reading, with_rules, faults);
}

LoadedRules load(const std::vector<std::string>& roots, const FindSource& findSource, const ClassCatalogue& catalogue,
                 const RuleLoadOptions& options) {
  FaultList faults;
  GatheredRules gathered = gatherRules(roots, findSource, faults);
  expandDefinitions(gathered, faults);
  RuleReading reading{catalogue, options, faults};
  readNames(gathered, reading);
  RuleSet rules;
  rules.name = gathered.name;
  rules.version = gathered.version;
  rules.description = gathered.description;
  rules.prefixes = reading.prefixes;
  rules.catalogue = catalogue;
  readOrder(gathered, reading, rules);
  readNothing(gathered, reading, rules);
  std::set<std::string> faulty;
  for (const YamlNode& node : gathered.rules) {
    const std::size_t faults_before = faults.errorCount() + reading.unread;
    auto rule = readRule(node, reading);
    if (!rule) continue;
    if (faults.errorCount() + reading.unread == faults_before)
      checkReachability(*rule, faults);
    else
      faulty.insert(rule->id);
    rules.rules.push_back(std::move(*rule));
  }
  if (rules.rules.empty() && faults.errorCount() == 0) {
    SourceLocation at;
    at.file = roots.empty() ? "" : roots.front();
    faults.error(at, "there are no rules in it");
  }
  rules.asks_map = reading.asks_map;
  markRivals(rules, faults);
  checkTogether(gathered, reading, rules, faulty, faults);
  rules.sources = std::move(gathered.sources);
  numberThresholds(rules);
  LoadedRules loaded;
  loaded.diagnostics = faults.sorted();
  if (faults.errorCount() == 0) loaded.rules = std::move(rules);
  return loaded;
}

std::vector<std::string> namesOf(std::span<const std::filesystem::path> paths) {
  std::vector<std::string> names;
  for (const auto& path : paths) names.push_back(path.string());
  return names;
}

/// A file without the word "include" includes nothing: its YAML need not be read to know that. Nothing when a file has
/// the word or cannot be read.
std::optional<std::vector<RuleSource>> sourcesWithoutIncludes(std::span<const std::filesystem::path> paths) {
  std::vector<RuleSource> sources;
  for (const std::string& name : namesOf(paths)) {
    FoundSource found = findFile(name, "");
    if (!found.fault.empty() || found.text.find("include") != std::string::npos) return std::nullopt;
    sources.push_back({std::move(found.shown), std::move(found.text)});
  }
  return sources;
}

}  // namespace

RuleSet LoadedRules::require() && {
  if (!rules) throw InputError(diagnostics);
  return std::move(*rules);
}

LoadedRules loadRules(std::span<const std::filesystem::path> paths, const ClassCatalogue& catalogue,
                      const RuleLoadOptions& options) {
  return load(namesOf(paths), findFile, catalogue, options);
}

std::optional<std::vector<RuleSource>> readRuleSources(std::span<const std::filesystem::path> paths) {
  if (auto alone = sourcesWithoutIncludes(paths)) return alone;
  FaultList faults;
  GatheredRules gathered = gatherRules(namesOf(paths), findFile, faults);
  if (faults.errorCount() > 0) return std::nullopt;
  return std::move(gathered.sources);
}

LoadedRules loadRuleTexts(std::span<const RuleSource> texts, std::size_t roots, const ClassCatalogue& catalogue,
                          const RuleLoadOptions& options) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < std::min(roots, texts.size()); ++i) names.push_back(texts[i].name);
  auto findText = [&](const std::string& name, const std::string& from_key) {
    FoundSource found;
    const auto beside = (std::filesystem::path(from_key).parent_path() / name).lexically_normal().string();
    for (const RuleSource& source : texts)
      if (found.key.empty() && (source.name == name || source.name == beside))
        found = {source.name, source.name, source.text, {}};
    if (found.key.empty()) found.shown = name;
    if (found.key.empty()) found.fault = "is not among the files that are given";
    return found;
  };
  return load(names, findText, catalogue, options);
}

std::vector<Diagnostic> checkRules(std::span<const std::filesystem::path> paths, const ClassCatalogue& catalogue,
                                   const RuleLoadOptions& options) {
  return loadRules(paths, catalogue, options).diagnostics;
}

}  // namespace cluxel::rules
