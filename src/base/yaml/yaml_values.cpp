// SPDX-License-Identifier: Apache-2.0
// Look-ups, key checks and plain values in YAML trees.
#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/nearest_name.hpp"
#include "base/yaml/yaml_tree.hpp"

namespace cluxel {

namespace {

/// False when a number in it is faulty.
bool appendNumbers(const YamlNode& node, std::string_view what, FaultList& faults, std::vector<double>& numbers) {
  bool good = true;
  for (const YamlNode& item : node.items) {
    if (item.isSequence()) {
      good = appendNumbers(item, what, faults, numbers) && good;
    } else if (const auto number = numberOf(item, what, faults)) {
      numbers.push_back(*number);
    } else {
      good = false;
    }
  }
  return good;
}

}  // namespace

const YamlNode* YamlNode::find(std::string_view key) const {
  for (std::size_t i = 0; i < keys.size() && i < items.size(); ++i)
    if (keys[i].text == key) return &items[i];
  return nullptr;
}

const YamlNode* YamlNode::keyNode(std::string_view key) const {
  for (const YamlNode& node : keys)
    if (node.text == key) return &node;
  return nullptr;
}

std::string_view describeKind(const YamlNode& node) {
  switch (node.kind) {
    case YamlNode::Kind::Map:
      return "a mapping";
    case YamlNode::Kind::Sequence:
      return "a list";
    case YamlNode::Kind::Scalar:
      return "a single value";
    case YamlNode::Kind::Null:
      break;
  }
  return "nothing";
}

void refuseUnknownKeys(const YamlNode& map, std::span<const std::string> known, std::string_view where,
                       FaultList& faults) {
  for (const YamlNode& key : map.keys)
    if (std::find(known.begin(), known.end(), key.text) == known.end())
      faults.error(key.at, "unknown key '" + key.text + "'" + std::string(where), suggestion(key.text, known));
}

bool checkMapping(const YamlNode& node, std::span<const std::string> known, FaultList& faults) {
  if (!node.isMap()) {
    faults.error(node.at, "a mapping (key: value) was expected", suggestion("", known));
    return false;
  }
  refuseUnknownKeys(node, known, "", faults);
  return true;
}

std::optional<double> parseNumber(std::string_view text) {
  double value = 0;
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (fault != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<double> numberOf(const YamlNode& node, std::string_view what, FaultList& faults) {
  if (node.isScalar())
    if (const auto number = parseNumber(node.text)) return number;
  faults.error(node.at, std::string(what) + " must be a finite number");
  return std::nullopt;
}

std::optional<std::vector<double>> numbersOf(const YamlNode& node, std::size_t count, std::string_view what,
                                             FaultList& faults) {
  std::vector<double> numbers;
  if (node.isSequence() && !appendNumbers(node, what, faults, numbers)) return std::nullopt;
  if (numbers.size() == count) return numbers;
  faults.error(node.at, std::string(what) + " must be a list of " + std::to_string(count) + " numbers");
  return std::nullopt;
}

std::optional<std::string> textOf(const YamlNode& node, std::string_view what, FaultList& faults) {
  if (node.isScalar() && !node.text.empty()) return node.text;
  faults.error(node.at, std::string(what) + " must be a text");
  return std::nullopt;
}

}  // namespace cluxel
