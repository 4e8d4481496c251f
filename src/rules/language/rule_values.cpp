// SPDX-License-Identifier: Apache-2.0
// Single values of rule files: quantities with units, labels, classes, bound names.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

#include "base/ascii.hpp"
#include "base/nearest_name.hpp"
#include "rdf/iri.hpp"
#include "rdf/ontology/class_labels.hpp"
#include "rules/language/rule_reading.hpp"

namespace cluxel::rules {

namespace {

struct Unit {
  std::string_view name;
  perception::Dimension dimension;
  double factor;
};

constexpr std::array<Unit, 12> kUnits{{{"m", perception::Dimension::Length, 1.0},
                                       {"cm", perception::Dimension::Length, 0.01},
                                       {"mm", perception::Dimension::Length, 0.001},
                                       {"km", perception::Dimension::Length, 1000.0},
                                       {"m2", perception::Dimension::Area, 1.0},
                                       {"cm2", perception::Dimension::Area, 1e-4},
                                       {"m3", perception::Dimension::Volume, 1.0},
                                       {"l", perception::Dimension::Volume, 0.001},
                                       {"deg", perception::Dimension::Angle, std::numbers::pi / 180.0},
                                       {"rad", perception::Dimension::Angle, 1.0},
                                       {"%", perception::Dimension::Ratio, 0.01},
                                       {"", perception::Dimension::Ratio, 1.0}}};

std::string_view nounOf(perception::Dimension dimension) {
  switch (dimension) {
    case perception::Dimension::Length:
      return "a length";
    case perception::Dimension::Area:
      return "an area";
    case perception::Dimension::Volume:
      return "a volume";
    case perception::Dimension::Angle:
      return "an angle";
    case perception::Dimension::Ratio:
      return "a plain number";
    case perception::Dimension::Count:
      return "a count";
  }
  return "";
}

bool isPlain(perception::Dimension dimension) {
  return dimension == perception::Dimension::Ratio || dimension == perception::Dimension::Count;
}

std::vector<std::string> labelNames() {
  return {scan::kPrimitiveLabelNames.begin(), scan::kPrimitiveLabelNames.end()};
}

void readLabel(const YamlNode& node, std::vector<scan::PrimitiveLabel>& labels, FaultList& faults) {
  const auto text = readText(node, "a label", faults);
  if (!text) return;
  if (const auto label = scan::primitiveLabelOf(*text))
    labels.push_back(*label);
  else
    faults.error(node.at, "unknown label '" + *text + "'", suggestion(*text, labelNames()));
}

bool isWord(const std::string& text) {
  return !text.empty() && text.size() <= 64 && isAsciiLetter(text[0]) &&
         std::all_of(text.begin(), text.end(), [](char c) { return isAsciiAlphanumeric(c) || c == '_'; });
}

RuleConstant* constantNamed(const YamlNode& node, RuleReading& reading) {
  const std::string name = node.text.substr(1);
  const auto constant = reading.constants.find(name);
  if (constant == reading.constants.end()) {
    std::vector<std::string> names;
    for (const auto& [known, unused] : reading.constants) names.push_back(known);
    reading.faults.error(node.at, "unknown constant '" + node.text + "'", suggestion(name, names));
    return nullptr;
  }
  constant->second.used = true;
  return &constant->second;
}

bool isShare(const Quantity& quantity) {
  return quantity.text.ends_with('%');
}

bool fits(const Quantity& quantity, perception::Dimension expected) {
  if (expected == perception::Dimension::Count && isShare(quantity)) return false;
  return quantity.dimension == expected || (isPlain(quantity.dimension) && isPlain(expected));
}

/// `where`: the place of a bare number that is not at the node; `hint`: of what has a unit.
void reportMisfit(const YamlNode& node, const Quantity& quantity, perception::Dimension expected,
                  const std::string& where, const std::string& hint, FaultList& faults) {
  const std::string name = "'" + node.text + "' is ", wanted = std::string(nounOf(expected)) + " is expected";
  if (expected == perception::Dimension::Count && isShare(quantity))
    return faults.error(node.at, name + "a share where a number of things is expected", hint);
  if (!isPlain(quantity.dimension))
    return faults.error(node.at, name + std::string(nounOf(quantity.dimension)) + " where " + wanted, hint);
  faults.error(
      node.at, (where.empty() ? "" : name) + "a bare number where " + wanted,
      "write '" + quantity.text + " " + std::string(unitOf(expected)) + "'" + (where.empty() ? "" : " " + where));
}

std::string shortName(const std::string& iri, const RuleReading& reading) {
  for (const auto& [prefix, base] : reading.prefixes)
    if (!base.empty() && iri.starts_with(base)) return prefix + ":" + iri.substr(base.size());
  return "<" + iri + ">";
}

/// The classes that words without a prefix may mean.
std::string hintForUnprefixed(const std::string& text, const RuleReading& reading) {
  std::vector<std::string> meant, known;
  for (const ClassEntry& entry : reading.catalogue.classes) {
    known.push_back(shortName(entry.iri, reading));
    if (rdf::plainWords(rdf::localName(entry.iri)) == rdf::plainWords(text)) meant.push_back(known.back());
  }
  std::string list;
  for (const std::string& name : meant) list += (list.empty() ? "'" : " or '") + name + "'";
  if (!meant.empty()) return "write a class with its prefix: " + list;
  const std::string near = suggestion("clx:" + text, known);
  return near.empty() ? "write a class with its prefix, such as 'clx:Tree'" : near;
}

}  // namespace

std::string_view unitOf(perception::Dimension dimension) {
  switch (dimension) {
    case perception::Dimension::Length:
      return "m";
    case perception::Dimension::Area:
      return "m2";
    case perception::Dimension::Volume:
      return "m3";
    case perception::Dimension::Angle:
      return "deg";
    default:
      return "";
  }
}

const std::vector<YamlNode>& listUnder(const YamlNode& map, std::string_view key, std::string_view of_what,
                                       FaultList& faults) {
  static const std::vector<YamlNode> none;
  const YamlNode* list = map.find(key);
  if (list == nullptr || list->isNull()) return none;
  if (list->isSequence()) return list->items;
  faults.error(list->at, "'" + std::string(key) + "' takes a list of " + std::string(of_what) + ", not " +
                             std::string(describeKind(*list)));
  return none;
}

std::optional<std::string> readText(const YamlNode& node, std::string_view what, FaultList& faults) {
  if (node.isScalar() && !node.text.empty()) return node.text;
  faults.error(node.at, std::string(what) + " is expected here, not " +
                            std::string(node.isScalar() ? "empty text" : describeKind(node)));
  return std::nullopt;
}

std::optional<bool> readFlag(const YamlNode& node, FaultList& faults) {
  if (node.isScalar() && node.text == "true") return true;
  if (node.isScalar() && node.text == "false") return false;
  faults.error(node.at, "true or false is expected here");
  return std::nullopt;
}

std::optional<Quantity> parseQuantity(const YamlNode& node, FaultList& faults) {
  const auto text = readText(node, "a quantity like '2.5 m'", faults);
  if (!text) return std::nullopt;
  double number = 0;
  const char* last = text->data() + text->size();
  const auto [end, code] = std::from_chars(text->data() + (text->front() == '+' ? 1 : 0), last, number);
  const std::string_view rest(end, static_cast<std::size_t>(last - end));
  const std::string unit(rest.substr(std::min(rest.find_first_not_of(' '), rest.size())));
  const bool is_number = code == std::errc() && std::isfinite(number);
  const auto known = std::find_if(kUnits.begin(), kUnits.end(), [&](const Unit& u) { return u.name == unit; });
  if (is_number && known != kUnits.end()) return Quantity{number * known->factor, known->dimension, *text};
  if (!is_number) {
    faults.error(node.at, "'" + *text + "' is not a quantity", "write a number, a space and a unit: '2.5 m'");
    return std::nullopt;
  }
  faults.error(node.at, "unknown unit '" + unit + "'", "known: m, cm, mm, km, m2, cm2, m3, l, deg, rad, %");
  return std::nullopt;
}

std::optional<Quantity> readQuantity(const YamlNode& node, perception::Dimension expected, RuleReading& reading) {
  if (node.isScalar() && node.text.starts_with('$')) {
    RuleConstant* constant = constantNamed(node, reading);
    if (constant == nullptr) return std::nullopt;
    if (!constant->faulty && !constant->misused_as.contains(expected)) {
      if (fits(constant->quantity, expected)) return constant->quantity;
      constant->misused_as.insert(expected);
      const std::string place = toString(constant->at);
      reportMisfit(node, constant->quantity, expected, "in " + place, "it is defined in " + place, reading.faults);
    }
    ++reading.unread;
    return std::nullopt;
  }
  const auto quantity = parseQuantity(node, reading.faults);
  if (!quantity || fits(*quantity, expected)) return quantity;
  reportMisfit(node, *quantity, expected, "", "", reading.faults);
  return std::nullopt;
}

std::vector<scan::PrimitiveLabel> readLabels(const YamlNode& map, RuleReading& reading) {
  std::vector<scan::PrimitiveLabel> labels;
  const YamlNode* one = map.find("label");
  const YamlNode* several = map.find("label_in");
  if (one != nullptr) readLabel(*one, labels, reading.faults);
  if (several != nullptr && (!several->isSequence() || several->items.empty()))
    reading.faults.error(several->at, "'label_in' takes a list of labels", "for a single one write 'label: column'");
  else if (several != nullptr)
    for (const YamlNode& item : several->items) readLabel(item, labels, reading.faults);
  if (one != nullptr && several != nullptr)
    reading.faults.error(several->at, "'label' and 'label_in' together", "keep one of them");
  std::sort(labels.begin(), labels.end());
  if (std::adjacent_find(labels.begin(), labels.end()) != labels.end() && several != nullptr)
    reading.faults.error(several->at, "a label stands here twice");
  return labels;
}

std::optional<std::string> expandName(const YamlNode& node, RuleReading& reading) {
  const auto text = readText(node, "a class like 'clx:Tree'", reading.faults);
  if (!text) return std::nullopt;
  if (text->front() == '<' && text->back() == '>') return text->substr(1, text->size() - 2);
  const std::size_t colon = text->find(':');
  if (colon == std::string::npos) {
    reading.faults.error(node.at, "'" + *text + "' is not a class name", hintForUnprefixed(*text, reading));
    return std::nullopt;
  }
  const auto prefix = reading.prefixes.find(text->substr(0, colon));
  if (prefix != reading.prefixes.end()) return prefix->second + text->substr(colon + 1);
  std::vector<std::string> known;
  for (const auto& [name, base] : reading.prefixes) known.push_back(name);
  reading.faults.error(node.at, "unknown prefix '" + text->substr(0, colon) + ":'",
                       suggestion(text->substr(0, colon), known));
  return std::nullopt;
}

std::optional<std::string> readClass(const YamlNode& node, RuleReading& reading) {
  auto iri = expandName(node, reading);
  if (!iri || reading.catalogue.find(*iri) != nullptr) return iri;
  std::vector<std::string> known;
  for (const ClassEntry& entry : reading.catalogue.classes) known.push_back(shortName(entry.iri, reading));
  reading.faults.error(node.at, "the ontology knows no class '" + node.text + "'", suggestion(node.text, known));
  return std::nullopt;
}

std::optional<std::string> readBoundName(const YamlNode& node, const NameScope& scope, FaultList& faults) {
  const auto name = readText(node, "a bound name", faults);
  if (!name) return std::nullopt;
  if (std::find(scope.names.begin(), scope.names.end(), *name) != scope.names.end()) return name;
  faults.error(node.at, "nothing is bound to '" + *name + "' here", suggestion(*name, scope.names));
  return std::nullopt;
}

std::optional<std::string> readNewName(const YamlNode& node, const NameScope& scope, FaultList& faults) {
  const auto name = readText(node, "a new name", faults);
  if (!name) return std::nullopt;
  if (!isWord(*name)) {
    faults.error(node.at, "'" + *name + "' cannot be a name", "use letters, digits and underscores, a letter first");
    return std::nullopt;
  }
  if (*name == kWholeCandidate) {
    faults.error(node.at, "'whole' means all parts of a candidate in evidence", "choose another name");
    return std::nullopt;
  }
  if (std::find(scope.names.begin(), scope.names.end(), *name) == scope.names.end()) return name;
  faults.error(node.at, "the name '" + *name + "' is already bound here", "choose another one");
  return std::nullopt;
}

}  // namespace cluxel::rules
