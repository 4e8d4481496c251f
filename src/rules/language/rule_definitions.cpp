// SPDX-License-Identifier: Apache-2.0
// Copies definitions depth first. The stack of open definitions finds cycles; a budget stops copies of copies.
#include "rules/language/rule_definitions.hpp"

#include <algorithm>
#include <map>

#include "base/nearest_name.hpp"
#include "rules/language/rule_reading.hpp"

namespace cluxel::rules {

namespace {

constexpr std::string_view kUse = "use";
constexpr std::size_t kMaxCopiedNodes = 200'000;  ///< some hundred times what readable rules need

class DefinitionExpander {
 public:
  DefinitionExpander(const GatheredRules& gathered, FaultList& faults) : faults_(faults) {
    for (const auto& [key, value] : gathered.definitions) definitions_[key.text] = {&key, &value, false};
  }

  void expand(YamlNode& node) {
    if (node.isMap() && node.find(kUse) != nullptr) {
      node = replacementOf(node);
      return;
    }
    std::vector<YamlNode> items;
    for (YamlNode& item : node.items) {
      const bool is_use = node.isSequence() && isOnlyUse(item);
      expand(item);
      if (is_use && item.isSequence())
        std::move(item.items.begin(), item.items.end(), std::back_inserter(items));
      else
        items.push_back(std::move(item));
    }
    node.items = std::move(items);
  }

  /// What a definition says counts also when no rule uses it: its uses of others may be misspelt, or go in a circle.
  void expandUnused() {
    std::vector<std::string> unused;
    for (const auto& [name, definition] : definitions_)
      if (!definition.is_used) unused.push_back(name);
    const std::map<std::string, Definition> before = definitions_;
    for (const std::string& name : unused) {
      copied_ = 0;
      open_ = {name};
      YamlNode copy = *definitions_[name].value;
      expand(copy);
    }
    open_.clear();
    definitions_ = before;  // what only an unused definition uses is unused, too
  }

  void warnOfUnused() {
    if (faults_.errorCount() > 0) return;  // errors hide uses
    for (const auto& [name, definition] : definitions_)
      if (!definition.is_used) faults_.warning(definition.key->at, "the definition '" + name + "' is not used");
  }

 private:
  struct Definition {
    const YamlNode* key = nullptr;
    const YamlNode* value = nullptr;
    bool is_used = false;
  };

  static bool isOnlyUse(const YamlNode& node) {
    return node.isMap() && node.keys.size() == 1 && node.keys.front().text == kUse;
  }

  YamlNode nothingAt(const YamlNode& node) {
    YamlNode nothing;
    nothing.at = node.at;
    return nothing;
  }

  /// The definition; keys beside `use` replace or extend its own.
  YamlNode replacementOf(const YamlNode& node) {
    const YamlNode& name = *node.find(kUse);
    auto copy = copyOf(name);
    if (!copy) return nothingAt(node);
    if (node.keys.size() == 1) return std::move(*copy);
    if (!copy->isMap()) {
      faults_.error(
          name.at, "'" + name.text + "' is " + std::string(describeKind(*copy)) + ", so nothing can stand beside 'use'",
          "only a mapping can be extended");
      return nothingAt(node);
    }
    for (std::size_t i = 0; i < node.items.size(); ++i)
      if (node.keys[i].text != kUse) setKey(*copy, node.keys[i], node.items[i]);
    copy->at = node.at;
    return std::move(*copy);
  }

  void setKey(YamlNode& map, const YamlNode& key, YamlNode value) {
    expand(value);
    const auto place =
        std::find_if(map.keys.begin(), map.keys.end(), [&](const YamlNode& known) { return known.text == key.text; });
    if (place == map.keys.end()) {
      map.keys.push_back(key);
      map.items.push_back(std::move(value));
    } else {
      map.items[static_cast<std::size_t>(place - map.keys.begin())] = std::move(value);
      *place = key;
    }
  }

  std::optional<YamlNode> copyOf(const YamlNode& name) {
    const auto text = readText(name, "the name of a definition", faults_);
    if (!text) return std::nullopt;
    const auto known = definitions_.find(*text);
    if (known == definitions_.end()) return reportUnknown(name);
    known->second.is_used = true;
    if (std::find(open_.begin(), open_.end(), *text) != open_.end()) return reportCycle(name);
    copied_ += sizeOf(*known->second.value);
    if (copied_ > kMaxCopiedNodes) return reportGrowth(name);
    open_.push_back(*text);
    YamlNode copy = *known->second.value;
    expand(copy);
    open_.pop_back();
    return copy;
  }

  std::optional<YamlNode> reportUnknown(const YamlNode& name) {
    std::vector<std::string> names;
    for (const auto& [known, unused] : definitions_) names.push_back(known);
    faults_.error(name.at, "nothing is defined as '" + name.text + "'", suggestion(name.text, names));
    return std::nullopt;
  }

  std::optional<YamlNode> reportCycle(const YamlNode& name) {
    std::string way;
    for (const std::string& open : open_) way += open + " -> ";
    faults_.error(name.at, "the definitions use each other: " + way + name.text, "write one of them out");
    return std::nullopt;
  }

  std::optional<YamlNode> reportGrowth(const YamlNode& name) {
    if (!reported_growth_)
      faults_.error(name.at,
                    "the definitions make the rules longer than " + std::to_string(kMaxCopiedNodes) + " values",
                    "definitions that use others many times multiply");
    reported_growth_ = true;
    return std::nullopt;
  }

  static std::size_t sizeOf(const YamlNode& node) {
    std::size_t size = 1;
    for (const YamlNode& item : node.items) size += sizeOf(item);
    return size;
  }

  FaultList& faults_;
  std::map<std::string, Definition> definitions_;
  std::vector<std::string> open_;
  std::size_t copied_ = 0;
  bool reported_growth_ = false;
};

}  // namespace

void expandDefinitions(GatheredRules& gathered, FaultList& faults) {
  DefinitionExpander expander(gathered, faults);
  for (YamlNode& rule : gathered.rules) expander.expand(rule);
  expander.expandUnused();
  expander.warnOfUnused();
}

}  // namespace cluxel::rules
