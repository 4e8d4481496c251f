// SPDX-License-Identifier: Apache-2.0
// Order of evaluation: included files, the file's own rules, its overrides. A file is read once, however often it is
// included.
#include "rules/language/rule_sources.hpp"

#include <algorithm>
#include <filesystem>

#include "base/file_bytes.hpp"
#include "base/nearest_name.hpp"
#include "rules/language/rule_reading.hpp"

namespace cluxel::rules {

namespace {

constexpr std::string_view kApiVersion = "cluxel.rules/v1";

std::string idOf(const YamlNode& rule) {
  const YamlNode* id = rule.find("id");
  return id != nullptr && id->isScalar() ? id->text : std::string();
}

class Gatherer {
 public:
  Gatherer(const FindSource& find_source, FaultList& faults) : find_source_(find_source), faults_(faults) {}

  void include(const std::string& name, const std::string& from_key, const SourceLocation& at) {
    FoundSource source = find_source_(name, from_key);
    if (!source.fault.empty() && at.file.empty()) return faults_.error({.file = source.shown}, source.fault);
    if (!source.fault.empty()) return faults_.error(at, source.shown + ": " + source.fault);
    const auto open = std::find(open_.begin(), open_.end(), source.key);
    if (open != open_.end()) return reportCycle(source, at);
    if (std::find(read_.begin(), read_.end(), source.key) != read_.end()) return;
    read_.push_back(source.key);
    open_.push_back(source.key);
    shown_.push_back(source.shown);
    faults_.addFile(source.shown, source.text);
    const YamlNode root = parseRuleYaml(source.shown, source.text, faults_);
    result_.sources.push_back({source.shown, std::move(source.text)});
    if (!root.isNull() && checkKeys(root, "file", faults_)) readFile(root, source.key);
    open_.pop_back();
    shown_.pop_back();
  }

  GatheredRules take() { return std::move(result_); }

 private:
  void reportCycle(const FoundSource& source, const SourceLocation& at) {
    std::string way;
    for (const std::string& name : shown_) way += name + " -> ";
    faults_.error(at, "the files include each other: " + way + source.shown);
  }

  void readFile(const YamlNode& root, const std::string& key) {
    if (const YamlNode* version = requireKey(root, "apiVersion", "file", faults_))
      if (version->text != kApiVersion)
        faults_.error(version->at, "rules of version '" + version->text + "' cannot be read",
                      "this program reads " + std::string(kApiVersion));
    if (const YamlNode* list = root.find("include")) {
      if (!list->isSequence() && !list->isNull()) faults_.error(list->at, "'include' takes a list of files");
      for (const YamlNode& item : list->items)
        if (const auto name = readText(item, "a file", faults_)) include(*name, key, item.at);
    }
    readHead(root);
    addEntries(root.find("prefixes"), "prefixes", result_.prefixes, true);
    addEntries(root.find("constants"), "constants", result_.constants, false);
    addEntries(root.find("define"), "define", result_.definitions, false);
    addEntries(root.find("nothing"), "nothing", result_.nothing, false);
    if (const YamlNode* order = root.find("order")) readOrder(*order, root.find("include") != nullptr);
    if (const YamlNode* rules = root.find("rules")) addRules(*rules);
    if (const YamlNode* overrides = root.find("override")) readOverride(*overrides);
  }

  void readHead(const YamlNode& root) {
    const YamlNode* head = root.find("ruleset");
    if (head == nullptr || !checkKeys(*head, "ruleset", faults_)) return;
    for (const auto& [key, field] :
         {std::pair{"name", &result_.name}, {"version", &result_.version}, {"description", &result_.description}})
      if (const YamlNode* value = head->find(key)) *field = readText(*value, key, faults_).value_or("");
  }

  void addEntries(const YamlNode* map, std::string_view what, std::vector<std::pair<YamlNode, YamlNode>>& entries,
                  bool may_repeat) {
    if (map == nullptr || map->isNull()) return;
    if (!map->isMap()) return faults_.error(map->at, "'" + std::string(what) + "' must be a mapping");
    for (std::size_t i = 0; i < map->items.size(); ++i) {
      const YamlNode& key = map->keys[i];
      const auto earlier =
          std::find_if(entries.begin(), entries.end(), [&](const auto& entry) { return entry.first.text == key.text; });
      if (earlier == entries.end()) {
        entries.emplace_back(key, map->items[i]);
      } else if (!may_repeat || earlier->second.text != map->items[i].text) {
        faults_.error(key.at, "'" + key.text + "' is already defined in " + toString(earlier->first.at),
                      "to change it, write it below 'override:'");
      }
    }
  }

  /// A list replaces the order; { insert: [...], before: class } extends that of the included files. An item that is
  /// itself a list is a stratum of several classes.
  void readOrder(const YamlNode& order, bool includes) {
    if (order.isSequence()) {
      const auto mapping = std::find_if(order.items.begin(), order.items.end(),
                                        [](const YamlNode& item) { return !item.isScalar() && !item.isSequence(); });
      if (mapping != order.items.end()) {
        result_.is_order_faulty = true;
        faults_.error(mapping->at,
                      "'order' is a list of classes, or one mapping that extends the order of the included files",
                      "write the mapping alone: order: { insert: [clx:Tree], before: clx:SmallObject }");
        return;
      }
      if (includes) result_.order.clear();
      for (const YamlNode& item : order.items) insertStratum(item, result_.order.size());
      return;
    }
    if (!checkKeys(order, "order", faults_)) return;
    const YamlNode* insert = requireKey(order, "insert", "order", faults_);
    const std::array<const YamlNode*, 3> anchors{order.find("before"), order.find("after"), order.find("beside")};
    if (std::count(anchors.begin(), anchors.end(), nullptr) != 2)
      faults_.error(order.at, "'order' needs one of 'before', 'after' and 'beside'");
    if (insert == nullptr) return;
    std::size_t at = result_.order.size();
    for (const YamlNode* anchor : anchors)
      if (anchor != nullptr) at = stratumOf(*anchor) + (anchor == anchors[1] ? 1 : 0);
    const std::vector<YamlNode> classes = insert->isSequence() ? insert->items : std::vector<YamlNode>{*insert};
    for (const YamlNode& item : classes)
      if (anchors[2] != nullptr && at < result_.order.size())
        addTo(result_.order[at], item);
      else
        insertStratum(item, at++);
  }

  std::size_t stratumOf(const YamlNode& anchor) {
    std::vector<std::string> known;
    for (std::size_t i = 0; i < result_.order.size(); ++i)
      for (const YamlNode& node : result_.order[i]) {
        if (node.text == anchor.text) return i;
        known.push_back(node.text);
      }
    faults_.error(anchor.at, "'" + anchor.text + "' does not stand in the order", suggestion(anchor.text, known));
    return result_.order.size();
  }

  void insertStratum(const YamlNode& node, std::size_t at) {
    std::vector<YamlNode> stratum;
    if (node.isSequence())
      for (const YamlNode& item : node.items) addTo(stratum, item);
    else
      addTo(stratum, node);
    if (node.isSequence() && node.items.empty()) faults_.error(node.at, "a stratum without classes");
    if (stratum.empty()) return;
    at = std::min(at, result_.order.size());
    result_.order.insert(result_.order.begin() + static_cast<std::ptrdiff_t>(at), std::move(stratum));
  }

  void addTo(std::vector<YamlNode>& stratum, const YamlNode& node) {
    const auto refuseTwin = [&](const std::vector<YamlNode>& others) {
      for (const YamlNode& earlier : others) {
        if (earlier.text != node.text || !node.isScalar()) continue;
        faults_.error(node.at, "'" + node.text + "' stands in the order twice", "first in " + toString(earlier.at));
        return true;
      }
      return false;
    };
    if (refuseTwin(stratum) || std::any_of(result_.order.begin(), result_.order.end(), refuseTwin)) return;
    stratum.push_back(node);
  }

  YamlNode* ruleById(const std::string& id) {
    for (YamlNode& rule : result_.rules)
      if (!id.empty() && idOf(rule) == id) return &rule;
    return nullptr;
  }

  void addRules(const YamlNode& rules) {
    if (!rules.isSequence() && !rules.isNull()) faults_.error(rules.at, "'rules' takes a list");
    for (const YamlNode& rule : rules.items) {
      if (const YamlNode* earlier = ruleById(idOf(rule)))
        faults_.error(rule.find("id")->at, "the rule id '" + idOf(rule) + "' is already used",
                      "first in " + toString(earlier->at) + "; to change that rule, write it below 'override:'");
      else
        result_.rules.push_back(rule);
    }
  }

  void readOverride(const YamlNode& overrides) {
    if (!checkKeys(overrides, "override", faults_)) return;
    if (const YamlNode* constants = overrides.find("constants"))
      overrideEntries(*constants, "constant", result_.constants);
    if (const YamlNode* define = overrides.find("define")) overrideEntries(*define, "definition", result_.definitions);
    for (const YamlNode& rule : listUnder(overrides, "rules", "rules", faults_)) overrideRule(rule);
    for (const YamlNode& id : listUnder(overrides, "remove", "ids of rules", faults_)) {
      YamlNode* rule = knownRule(id, id.text);
      if (rule != nullptr) result_.rules.erase(result_.rules.begin() + (rule - result_.rules.data()));
    }
  }

  void overrideEntries(const YamlNode& changes, const std::string& what,
                       std::vector<std::pair<YamlNode, YamlNode>>& entries) {
    if (!changes.isMap() && !changes.isNull()) return faults_.error(changes.at, "'" + what + "s' must be a mapping");
    for (std::size_t i = 0; i < changes.items.size(); ++i) {
      const YamlNode& key = changes.keys[i];
      const auto earlier =
          std::find_if(entries.begin(), entries.end(), [&](const auto& entry) { return entry.first.text == key.text; });
      std::vector<std::string> known;
      for (const auto& entry : entries) known.push_back(entry.first.text);
      if (earlier == entries.end())
        faults_.error(key.at, "there is no " + what + " '" + key.text + "' to override", suggestion(key.text, known));
      else
        *earlier = {key, changes.items[i]};
    }
  }

  YamlNode* knownRule(const YamlNode& at, const std::string& id) {
    if (YamlNode* rule = ruleById(id)) return rule;
    std::vector<std::string> known;
    for (const YamlNode& rule : result_.rules) known.push_back(idOf(rule));
    faults_.error(at.at, "there is no rule '" + id + "' to override", suggestion(id, known));
    return nullptr;
  }

  /// Replaces the given keys of the rule and keeps the others.
  void overrideRule(const YamlNode& change) {
    if (!checkKeys(change, "rule", faults_)) return;
    const YamlNode* id = requireKey(change, "id", "rule", faults_);
    YamlNode* rule = id == nullptr ? nullptr : knownRule(*id, id->text);
    if (rule == nullptr) return;
    for (std::size_t i = 0; i < change.items.size(); ++i) {
      const auto place = std::find_if(rule->keys.begin(), rule->keys.end(),
                                      [&](const YamlNode& key) { return key.text == change.keys[i].text; });
      if (place == rule->keys.end()) {
        rule->keys.push_back(change.keys[i]);
        rule->items.push_back(change.items[i]);
      } else {
        rule->items[static_cast<std::size_t>(place - rule->keys.begin())] = change.items[i];
        *place = change.keys[i];
      }
    }
  }

  const FindSource& find_source_;
  FaultList& faults_;
  GatheredRules result_;
  std::vector<std::string> open_, shown_, read_;
};

}  // namespace

FoundSource findFile(const std::string& name, const std::string& from_key) {
  FoundSource found;
  std::filesystem::path path = name;
  if (path.is_relative() && !from_key.empty()) path = std::filesystem::path(from_key).parent_path() / path;
  // Symbolic links are not resolved: includes are relative to the link, as they are in a map's stored texts.
  found.key = std::filesystem::absolute(path).lexically_normal().string();
  found.shown = path.lexically_normal().string();
  try {
    found.text = readFile(path);
  } catch (const InputError& fault) {
    found.fault = fault.diagnostics().front().message;
  }
  return found;
}

GatheredRules gatherRules(const std::vector<std::string>& roots, const FindSource& findSource, FaultList& faults) {
  Gatherer gatherer(findSource, faults);
  for (const std::string& root : roots) gatherer.include(root, "", {});
  return gatherer.take();
}

}  // namespace cluxel::rules
