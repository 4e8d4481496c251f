// SPDX-License-Identifier: Apache-2.0
// Reads conditions: tests of attributes, measures, relations, labels, classes and queries, combined by all, any and
// not.
#include <algorithm>

#include "base/nearest_name.hpp"
#include "rules/language/condition_text.hpp"
#include "rules/language/condition_words.hpp"
#include "rules/language/rule_reading.hpp"
#include "rules/propose/pair_measures.hpp"

namespace cluxel::rules {

namespace {

/// Reads one condition.
class ConditionReader {
 public:
  ConditionReader(const YamlNode& node, const NameScope& scope, RuleReading& reading)
      : node_(node), scope_(scope), reading_(reading), faults_(reading.faults) {}

  std::optional<Condition> read() {
    if (!checkKeys(node_, "condition", faults_)) return std::nullopt;
    const std::size_t faults_before = faults_.errorCount();
    readSubject();
    readKind();
    return faults_.errorCount() == faults_before ? std::optional(condition_) : std::nullopt;
  }

  /// What is measured, without a comparison.
  std::optional<Condition> readMeasureOnly() {
    const std::size_t faults_before = faults_.errorCount();
    readSubject();
    for (const MeasureWord& measure : kMeasureWords)
      if (const YamlNode* target = node_.find(measure.key)) {
        condition_.kind = Condition::Kind::Pair;
        condition_.measure = measure.measure;
        condition_.target = readTarget(*target);
      }
    if (const YamlNode* attribute = node_.find("attribute")) readMeasuredAttribute(*attribute);
    return faults_.errorCount() == faults_before ? std::optional(condition_) : std::nullopt;
  }

 private:
  void readSubject() {
    condition_.at = node_.at;
    condition_.of = scope_.subject;
    if (const YamlNode* of = node_.find("of"))
      if (const auto name = readBoundName(*of, scope_, faults_)) condition_.of = *name;
  }

  void readMeasuredAttribute(const YamlNode& value) {
    condition_.kind = Condition::Kind::Attribute;
    const auto attribute = readAttributeName(value);
    if (!attribute) return;
    condition_.attribute = *attribute;
    condition_.slice = readSliceOf(node_, value, *attribute);
    if (const YamlNode* to = node_.find("relative_to"))
      readOtherAttribute(*to, perception::attributeInfos()[static_cast<std::size_t>(*attribute)].dimension);
  }

  void readKind() {
    std::vector<std::string> kinds;
    for (const YamlNode& key : node_.keys)
      if (isKind(key.text)) kinds.push_back(key.text);
    if (kinds.empty())
      return faults_.error(node_.at, "a condition that tests nothing",
                           "give it one of: attribute, relation, label, class, gap_to, ask, all, any, not");
    if (kinds.size() > 1)
      return faults_.error(node_.keyNode(kinds[1])->at, "'" + kinds[0] + "' and '" + kinds[1] + "' in one condition",
                           "join two conditions with 'all' or 'any'");
    readAs(kinds.front(), *node_.find(kinds.front()));
  }

  static bool isKind(const std::string& key) {
    constexpr std::array<std::string_view, 9> kinds{"attribute", "relation", "label", "label_in", "class",
                                                    "ask",       "all",      "any",   "not"};
    return std::find(kinds.begin(), kinds.end(), key) != kinds.end() || perception::relationKindOf(key) ||
           measureOf(key) != nullptr;
  }

  void readAs(const std::string& kind, const YamlNode& value) {
    if (kind == "all" || kind == "any") return readOperands(kind == "all", value);
    if (kind == "not") return readNot(value);
    if (kind == "attribute") return readAttribute(value);
    if (kind == "relation") return readRelation(value);
    if (kind == "ask") return readAsk(value);
    if (kind == "class") return readClassTest(value);
    if (kind == "label" || kind == "label_in") return readLabelTest();
    if (const MeasureWord* measure = measureOf(kind)) return readPair(*measure, value);
    readShortRelation(*perception::relationKindOf(kind), value);
  }

  void onlyWith(std::initializer_list<std::string_view> allowed) {
    for (const YamlNode& key : node_.keys)
      if (isDetail(key.text) && std::find(allowed.begin(), allowed.end(), key.text) == allowed.end())
        faults_.error(key.at, "'" + key.text + "' has no meaning in this condition");
  }

  static bool isDetail(const std::string& key) {
    constexpr std::array<std::string_view, 9> details{"op", "value", "min",    "max",  "ratio",
                                                      "to", "with",  "within", "slice"};
    return std::find(details.begin(), details.end(), key) != details.end();
  }

  void readOperands(bool all, const YamlNode& value) {
    onlyWith({});
    condition_.kind = all ? Condition::Kind::All : Condition::Kind::Any;
    condition_.operands = readConditions(value, scopeHere(), reading_);
  }
  void readNot(const YamlNode& value) {
    onlyWith({});
    condition_.kind = Condition::Kind::Not;
    if (auto operand = readCondition(value, scopeHere(), reading_)) condition_.operands.push_back(std::move(*operand));
  }
  /// The operands of `all`, `any` and `not` inherit the subject.
  NameScope scopeHere() const { return {scope_.names, condition_.of}; }

  std::optional<perception::Attribute> readAttributeName(const YamlNode& value) {
    const auto text = readText(value, "an attribute", faults_);
    if (!text) return std::nullopt;
    if (const auto attribute = perception::attributeOf(*text)) return attribute;
    std::vector<std::string> known;
    for (const perception::AttributeInfo& info : perception::attributeInfos()) known.emplace_back(info.name);
    faults_.error(value.at, "unknown attribute '" + *text + "'", suggestion(*text, known));
    return std::nullopt;
  }

  void readAttribute(const YamlNode& value) {
    onlyWith({"op", "value", "min", "max", "ratio", "to", "slice"});
    condition_.kind = Condition::Kind::Attribute;
    const auto attribute = readAttributeName(value);
    if (!attribute) return;
    condition_.attribute = *attribute;
    condition_.slice = readSliceOf(node_, value, *attribute);
    const perception::Dimension dimension =
        perception::attributeInfos()[static_cast<std::size_t>(*attribute)].dimension;
    if (const YamlNode* to = node_.find("to"))
      readRatio(*to, dimension);
    else
      readComparison(dimension);
  }

  /// The `slice` beside an attribute's name.
  std::optional<SliceSpec> readSliceOf(const YamlNode& map, const YamlNode& name, perception::Attribute attribute) {
    const YamlNode* slice = map.find("slice");
    if (slice == nullptr) return std::nullopt;
    if (attribute == perception::Attribute::GroundContact || attribute == perception::Attribute::ViewCount ||
        attribute == perception::Attribute::MeanIntensity)
      faults_.error(name.at, "'" + name.text + "' is known of whole primitives only", "leave 'slice' out");
    return readSlice(*slice, reading_);
  }

  void readRatio(const YamlNode& to, perception::Dimension dimension) {
    readOperator();
    for (std::string_view key : {"value", "min", "max"})
      if (const YamlNode* stray = node_.keyNode(key))
        faults_.error(stray->at, "'" + std::string(key) + "' and 'to' together", "compare with one of them");
    if (condition_.comparison == Comparison::Between || condition_.comparison == Comparison::Outside)
      faults_.error(to.at, "'between' and 'outside' need min and max, not 'to'");
    if (const YamlNode* ratio = node_.find("ratio"))
      if (const auto factor = readQuantity(*ratio, perception::Dimension::Ratio, reading_))
        condition_.ratio = factor->value;
    readOtherAttribute(to, dimension);
  }

  /// The attribute that another one is compared with or divided by.
  void readOtherAttribute(const YamlNode& to, perception::Dimension dimension) {
    if (!checkKeys(to, "ratio_to", faults_)) return;
    condition_.ratio_of = condition_.of;
    if (const YamlNode* of = to.find("of")) condition_.ratio_of = readBoundName(*of, scope_, faults_).value_or("");
    const YamlNode* name = requireKey(to, "attribute", "ratio_to", faults_);
    if (name == nullptr) return;
    condition_.ratio_attribute = readAttributeName(*name);
    if (condition_.ratio_attribute) condition_.ratio_slice = readSliceOf(to, *name, *condition_.ratio_attribute);
    if (condition_.ratio_attribute &&
        perception::attributeInfos()[static_cast<std::size_t>(*condition_.ratio_attribute)].dimension != dimension)
      faults_.error(name->at, "the two attributes have different dimensions");
  }

  void readPair(const MeasureWord& measure, const YamlNode& value) {
    onlyWith({"op", "value", "min", "max"});
    condition_.kind = Condition::Kind::Pair;
    condition_.measure = measure.measure;
    condition_.target = readTarget(value);
    readComparison(measure.dimension);
    checkReach();
  }

  void readOperator() {
    const YamlNode* op = requireKey(node_, "op", "condition", faults_);
    if (op == nullptr) return;
    if (const auto comparison = comparisonOf(op->text); op->isScalar() && comparison) {
      condition_.comparison = *comparison;
      return;
    }
    faults_.error(op->at, "unknown operator '" + op->text + "'", "known: <, <=, >, >=, =, !=, between, outside");
  }

  void readComparison(perception::Dimension dimension) {
    readOperator();
    const bool interval = condition_.comparison == Comparison::Between || condition_.comparison == Comparison::Outside;
    for (std::string_view stray :
         interval ? std::vector<std::string_view>{"value"} : std::vector<std::string_view>{"min", "max"})
      if (const YamlNode* key = node_.keyNode(stray))
        faults_.error(key->at, "'" + std::string(stray) + "' does not go with this operator",
                      interval ? "give min and max" : "give value");
    if (const YamlNode* ratio = node_.keyNode("ratio"))
      faults_.error(ratio->at, "'ratio' needs 'to'", "to: { of: name, attribute: height }");
    const YamlNode* low = requireKey(node_, interval ? "min" : "value", "condition", faults_);
    if (low != nullptr) condition_.value = readQuantity(*low, dimension, reading_);
    if (!interval) return;
    const YamlNode* high = requireKey(node_, "max", "condition", faults_);
    if (high != nullptr) condition_.upper = readQuantity(*high, dimension, reading_);
    if (condition_.value && condition_.upper && condition_.value->value >= condition_.upper->value)
      faults_.error(high->at, "max is not greater than min");
  }

  /// Reasoning is local: gaps are measured up to a fixed distance.
  void checkReach() {
    if (condition_.measure == PairMeasure::AdjacentFraction) return;
    static_assert(kMaxMeasure_m - kMeasureMargin_m == 49.5, "the message below says so");
    for (const auto& [key, bound] :
         {std::pair{node_.find("value"), &condition_.value}, std::pair{node_.find("min"), &condition_.value},
          std::pair{node_.find("max"), &condition_.upper}})
      if (key != nullptr && *bound && (*bound)->value > kMaxMeasure_m - kMeasureMargin_m)
        faults_.error(key->at, "nothing farther than 49.5 m is measured",
                      "a rule sees the neighbours of what it binds; SPARQL rules see the whole map");
  }

  std::optional<Target> readTarget(const YamlNode& value) {
    Target target;
    if (value.isScalar()) {
      target.name = readBoundName(value, scope_, faults_).value_or("");
      if (target.name == condition_.of && !target.name.empty())
        faults_.error(value.at, "'" + target.name + "' is compared with itself");
      return target;
    }
    if (!checkKeys(value, "target", faults_)) return std::nullopt;
    if (const YamlNode* object = value.find("object")) {
      target.kind = Target::Kind::Object;
      target.object_class = readClass(*object, reading_).value_or("");
    } else {
      target.kind = Target::Kind::Labels;
    }
    target.labels = readLabels(value, reading_);
    if (value.items.empty())
      faults_.error(value.at, "names no target", "a bound name, { label: ... } or { object: ... }");
    return target;
  }

  void readRelation(const YamlNode& value) {
    onlyWith({"with", "within"});
    const auto name = readText(value, "a relation", faults_);
    if (!name) return;
    const auto kind = perception::relationKindOf(*name);
    if (!kind) {
      std::vector<std::string> known;
      for (const perception::RelationInfo& info : perception::relationInfos()) known.emplace_back(info.name);
      return faults_.error(value.at, "unknown relation '" + *name + "'", suggestion(*name, known));
    }
    if (*kind == perception::RelationKind::TouchesGround) return readTouchesGround(node_.keyNode("with"));
    const YamlNode* with = requireKey(node_, "with", "condition", faults_);
    if (with != nullptr) readRelationTo(*kind, *with);
  }

  void readShortRelation(perception::RelationKind kind, const YamlNode& value) {
    onlyWith({"within"});
    if (kind != perception::RelationKind::TouchesGround) return readRelationTo(kind, value);
    const auto flag = readFlag(value, faults_);
    if (flag && !*flag) faults_.error(value.at, "write 'not: { touches_ground: true }'");
    readTouchesGround(nullptr);
  }

  void readTouchesGround(const YamlNode* with) {
    if (with != nullptr) faults_.error(with->at, "touches_ground takes no 'with': it means the ground below");
    condition_.kind = Condition::Kind::Relation;
    condition_.relation = perception::RelationKind::TouchesGround;
    readWithin();
  }

  void readRelationTo(perception::RelationKind kind, const YamlNode& with) {
    condition_.kind = Condition::Kind::Relation;
    condition_.relation = kind;
    condition_.target = readTarget(with);
    readWithin();
  }

  void readWithin() {
    const YamlNode* within = node_.find("within");
    if (within == nullptr) return;
    condition_.value = readQuantity(*within, perception::Dimension::Length, reading_);
    if (condition_.relation == perception::RelationKind::Inside ||
        condition_.relation == perception::RelationKind::ParallelTo)
      faults_.error(within->at, "this relation takes no tolerance");
  }

  void readLabelTest() {
    onlyWith({"op", "value", "min", "max"});
    condition_.kind = Condition::Kind::Label;
    condition_.labels = readLabels(node_, reading_);
    const auto has = [this](const char* key) { return node_.find(key) != nullptr; };
    if (has("op") || has("value") || has("min") || has("max")) readComparison(perception::Dimension::Ratio);
  }
  void readClassTest(const YamlNode& value) {
    onlyWith({});
    condition_.kind = Condition::Kind::Class;
    condition_.class_iri = readClass(value, reading_).value_or("");
  }
  void readAsk(const YamlNode& value) {
    onlyWith({});
    condition_.kind = Condition::Kind::Ask;
    readQuery(value, scope_, reading_, condition_);
  }

  const YamlNode& node_;
  const NameScope& scope_;
  RuleReading& reading_;
  FaultList& faults_;
  Condition condition_;
};

}  // namespace

std::optional<Condition> readCondition(const YamlNode& node, const NameScope& scope, RuleReading& reading) {
  const auto meant = node.isScalar() ? conditionOfText(node, reading.faults) : std::optional(node);
  return meant ? ConditionReader(*meant, scope, reading).read() : std::nullopt;
}

std::optional<Condition> readMeasure(const YamlNode& node, const NameScope& scope, RuleReading& reading) {
  return ConditionReader(node, scope, reading).readMeasureOnly();
}

std::vector<Condition> readConditions(const YamlNode& node, const NameScope& scope, RuleReading& reading) {
  std::vector<Condition> conditions;
  if (!node.isSequence() || node.items.empty()) {
    reading.faults.error(node.at, "a list of conditions is expected here, not " + std::string(describeKind(node)));
    return conditions;
  }
  for (const YamlNode& item : node.items)
    if (auto condition = readCondition(item, scope, reading)) conditions.push_back(std::move(*condition));
  return conditions;
}

bool tiesToNeighbours(const std::vector<Condition>& conditions, const std::string& subject) {
  return std::any_of(conditions.begin(), conditions.end(),
                     [&](const Condition& condition) { return looksNearby(condition, subject); });
}

}  // namespace cluxel::rules
