// SPDX-License-Identifier: Apache-2.0
// Reads `accept` leaves: parts, confidence, absorbing, splitting.
#include <algorithm>

#include "base/nearest_name.hpp"
#include "rules/language/condition_text.hpp"
#include "rules/language/rule_reading.hpp"

namespace cluxel::rules {

namespace {

class AcceptReader {
 public:
  AcceptReader(const YamlNode& node, const NameScope& scope, const Rule& rule, RuleReading& reading)
      : node_(node), scope_(scope), rule_(rule), reading_(reading), faults_(reading.faults) {}

  std::optional<AcceptLeaf> read() {
    if (!checkKeys(node_, "accept", faults_)) return std::nullopt;
    readParts();
    if (const YamlNode* confidence = requireKey(node_, "confidence", "accept", faults_)) readConfidence(*confidence);
    if (const YamlNode* evidence = node_.find("evidence")) leaf_.evidence = readEvidence(*evidence, scope_, reading_);
    if (const YamlNode* absorb = node_.find("absorb")) readAbsorbs(*absorb);
    if (const YamlNode* split = node_.find("split")) readSplit(*split);
    if (const YamlNode* merge = node_.find("merge_into")) readMerge(*merge);
    return leaf_;
  }

 private:
  void readMerge(const YamlNode& merge) {
    if (merge.text == "related")
      leaf_.merge_into = MergeInto::Related;
    else if (merge.text == "class")
      leaf_.merge_into = MergeInto::Class;
    else
      faults_.error(merge.at, "'merge_into' takes 'related' or 'class'");
  }

  void readParts() {
    const YamlNode* parts = node_.find("parts");
    const YamlNode* part = node_.find("part");
    if (parts != nullptr && part != nullptr) faults_.error(part->at, "'part' and 'parts' together", "keep one of them");
    if (part != nullptr) leaf_.parts.emplace_back(rule_.seed.name, readPartClass(*part).value_or(""));
    if (part == nullptr && parts == nullptr) leaf_.parts.emplace_back(rule_.seed.name, rule_.class_iri);
    if (parts == nullptr) return;
    if (!parts->isMap() || parts->items.empty())
      return faults_.error(parts->at, "'parts' maps bound names to classes", "parts: { trunk: clx:TreeTrunk }");
    for (std::size_t i = 0; i < parts->items.size(); ++i) {
      const auto name = readBoundName(parts->keys[i], scope_, faults_);
      const auto iri = readPartClass(parts->items[i]);
      if (name && iri) leaf_.parts.emplace_back(*name, *iri);
    }
  }

  std::optional<std::string> readPartClass(const YamlNode& node) {
    const auto iri = readClass(node, reading_);
    if (!iri || *iri == rule_.class_iri || rule_.class_iri.empty()) return iri;
    const auto known = reading_.catalogue.partsOf(rule_.class_iri);
    if (std::find(known.begin(), known.end(), *iri) != known.end()) return iri;
    std::vector<std::string> names;
    for (const std::string& part : known) names.push_back(shortened(part));
    faults_.error(node.at, "the ontology gives " + shortened(rule_.class_iri) + " no part '" + node.text + "'",
                  suggestion(node.text, names));
    return std::nullopt;
  }
  std::string shortened(const std::string& iri) const {
    for (const auto& [prefix, base] : reading_.prefixes)
      if (!base.empty() && iri.starts_with(base)) return prefix + ":" + iri.substr(base.size());
    return iri;
  }

  std::optional<double> readShare(const YamlNode& node) {
    const auto quantity = readQuantity(node, perception::Dimension::Ratio, reading_);
    if (!quantity) return std::nullopt;
    if (quantity->value >= 0 && quantity->value <= 1) return quantity->value;
    faults_.error(node.at, "must lie between 0 and 1");
    return std::nullopt;
  }

  void readConfidence(const YamlNode& node) {
    leaf_.confidence.low_at = leaf_.confidence.high_at = node.at;
    if (!node.isMap()) {
      leaf_.confidence.low = leaf_.confidence.high = readShare(node).value_or(1.0);
      return;
    }
    if (!checkKeys(node, "confidence", faults_)) return;
    if (const YamlNode* from = requireKey(node, "from", "confidence", faults_)) {
      leaf_.confidence.low = readShare(*from).value_or(0.0);
      leaf_.confidence.low_at = from->at;
    }
    if (const YamlNode* to = requireKey(node, "to", "confidence", faults_)) {
      leaf_.confidence.high = readShare(*to).value_or(1.0);
      leaf_.confidence.high_at = to->at;
    }
    if (leaf_.confidence.low > leaf_.confidence.high) faults_.error(node.at, "'from' is greater than 'to'");
    const YamlNode* over = requireKey(node, "over", "confidence", faults_);
    if (over == nullptr) return;
    if (over->isMap() || over->isScalar()) return readRamp(*over);
    if (!over->isSequence()) faults_.error(over->at, "'over' takes one ramp or a list of them");
    for (const YamlNode& item : over->items) readRamp(item);
  }

  /// "height of trunk between 1 m and 3 m" is short for the mapping.
  void readRampText(const YamlNode& text) {
    auto meant = conditionOfText(text, faults_);
    const YamlNode* op = meant ? meant->find("op") : nullptr;
    if (!meant) return;
    if (op == nullptr || op->text != "between")
      return faults_.error(text.at, "'over' needs a range", "write 'height of trunk between 1 m and 3 m'");
    meant->keys.erase(meant->keys.begin() + (op - meant->items.data()));
    meant->items.erase(meant->items.begin() + (op - meant->items.data()));
    readRamp(*meant);
  }

  void readRamp(const YamlNode& node) {
    if (node.isScalar()) return readRampText(node);
    if (!checkKeys(node, "ramp", faults_)) return;
    ConfidenceRamp ramp;
    ramp.of = rule_.seed.name;
    if (const YamlNode* of = node.find("of")) ramp.of = readBoundName(*of, scope_, faults_).value_or("");
    const YamlNode* name = requireKey(node, "attribute", "ramp", faults_);
    const auto attribute = name == nullptr ? std::nullopt : perception::attributeOf(name->text);
    if (name != nullptr && !attribute) unknownAttribute(*name);
    const YamlNode* low = requireKey(node, "min", "ramp", faults_);
    const YamlNode* high = requireKey(node, "max", "ramp", faults_);
    if (!attribute || low == nullptr || high == nullptr) return;
    ramp.attribute = *attribute;
    const perception::Dimension dimension =
        perception::attributeInfos()[static_cast<std::size_t>(*attribute)].dimension;
    const auto at_low = readQuantity(*low, dimension, reading_);
    const auto at_high = readQuantity(*high, dimension, reading_);
    if (!at_low || !at_high) return;
    if (at_low->value == at_high->value) faults_.error(high->at, "min and max are the same");
    ramp.at_low = at_low->value;
    ramp.at_high = at_high->value;
    leaf_.confidence.ramps.push_back(ramp);
  }

  void unknownAttribute(const YamlNode& name) {
    std::vector<std::string> known;
    for (const perception::AttributeInfo& info : perception::attributeInfos()) known.emplace_back(info.name);
    faults_.error(name.at, "unknown attribute '" + name.text + "'", suggestion(name.text, known));
  }

  void readAbsorbs(const YamlNode& node) {
    if (node.isMap()) return readAbsorb(node);
    if (!node.isSequence()) faults_.error(node.at, "'absorb' takes a mapping or a list of them");
    for (const YamlNode& item : node.items) readAbsorb(item);
  }

  void readAbsorb(const YamlNode& node) {
    if (!checkKeys(node, "absorb", faults_)) return;
    AbsorbSpec absorb;
    absorb.at = node.at;
    if (const YamlNode* from = requireKey(node, "from", "absorb", faults_))
      if (checkKeys(*from, "absorb_from", faults_)) absorb.labels = readLabels(*from, reading_);
    if (const YamlNode* when = requireKey(node, "when", "absorb", faults_)) {
      NameScope scope = scope_;
      scope.names.emplace_back("it");
      scope.subject = "it";
      const std::size_t faults_before = faults_.errorCount();
      absorb.when = readConditions(*when, scope, reading_);
      if (faults_.errorCount() == faults_before && !tiesToNeighbours(absorb.when, "it"))
        faults_.error(when->at, "'absorb' needs evidence that ties it to a bound name",
                      "{ adjacent_fraction_to: top, op: \">=\", value: 0.5 }");
    }
    if (const YamlNode* fraction = node.find("max_fraction_of_points"))
      absorb.max_fraction_of_points = readShare(*fraction).value_or(1.0);
    if (const YamlNode* late = node.find("late")) absorb.late = readFlag(*late, faults_).value_or(false);
    readInto(node, absorb);
    leaf_.absorb.push_back(std::move(absorb));
  }

  /// Absorbed primitives join the part they are tied to, unless `into` names another one.
  void readInto(const YamlNode& node, AbsorbSpec& absorb) {
    if (const YamlNode* into = node.find("into")) {
      absorb.into = readBoundName(*into, scope_, faults_).value_or("");
    } else {
      for (const Condition& condition : absorb.when)
        if (absorb.into.empty() && looksNearby(condition, "it")) absorb.into = condition.target->name;
    }
    if (absorb.into.empty() || isPart(absorb.into)) return;
    faults_.error(node.at, "'" + absorb.into + "' is no part of the object, so nothing can join it",
                  "name it in 'parts', or give 'into'");
  }
  bool isPart(const std::string& name) const {
    return std::any_of(leaf_.parts.begin(), leaf_.parts.end(), [&](const auto& part) { return part.first == name; });
  }

  void readSplit(const YamlNode& node) {
    if (!checkKeys(node, "split", faults_)) return;
    SplittingSpec splitting;
    splitting.at = node.at;
    for (const auto& [key, field] : {std::pair{"shared", &splitting.part}, std::pair{"from", &splitting.from}}) {
      const YamlNode* name = requireKey(node, key, "split", faults_);
      if (name == nullptr) continue;
      *field = readBoundName(*name, scope_, faults_).value_or("");
      if (!field->empty() && !isPart(*field))
        faults_.error(name->at, "'" + *field + "' is no part of the object", "name it in 'parts'");
    }
    if (!splitting.part.empty() && splitting.part == splitting.from)
      faults_.error(node.at, "'shared' and 'from' are the same thing");
    for (const auto& [key, field] :
         {std::pair{"reach", &splitting.reach_m}, std::pair{"jump", &splitting.jump_m},
          std::pair{"start", &splitting.start_m}, std::pair{"clearance", &splitting.clearance_m}})
      if (const YamlNode* value = node.find(key))
        if (const auto length = readQuantity(*value, perception::Dimension::Length, reading_)) *field = length->value;
    splitting.start_m = std::max(splitting.start_m, splitting.jump_m);
    if (const YamlNode* gather = node.find("gather")) splitting.gather = readGather(*gather);
    leaf_.splitting = std::move(splitting);
  }

  std::optional<GatherSpec> readGather(const YamlNode& node) {
    if (!checkKeys(node, "gather", faults_)) return std::nullopt;
    GatherSpec gather;
    if (const YamlNode* within = requireKey(node, "within", "gather", faults_)) {
      gather.within_m = readQuantity(*within, perception::Dimension::Length, reading_).value_or(Quantity{}).value;
      if (gather.within_m < 0) faults_.error(within->at, "must not be negative");
    }
    if (const YamlNode* above = requireKey(node, "above", "gather", faults_))
      gather.above_m = readQuantity(*above, perception::Dimension::Length, reading_).value_or(Quantity{}).value;
    return gather;
  }

  const YamlNode& node_;
  const NameScope& scope_;
  const Rule& rule_;
  RuleReading& reading_;
  FaultList& faults_;
  AcceptLeaf leaf_;
};

}  // namespace

std::optional<AcceptLeaf> readAccept(const YamlNode& node, const NameScope& scope, const Rule& rule,
                                     RuleReading& reading) {
  return AcceptReader(node, scope, rule, reading).read();
}

}  // namespace cluxel::rules
