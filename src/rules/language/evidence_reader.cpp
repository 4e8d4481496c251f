// SPDX-License-Identifier: Apache-2.0
// Reads `evidence:` lists: curves, bells and tests that add log-odds to a candidate.
#include <algorithm>

#include "rules/language/condition_text.hpp"
#include "rules/language/rule_reading.hpp"

namespace cluxel::rules {

namespace {

class EvidenceReader {
 public:
  EvidenceReader(const YamlNode& node, const NameScope& scope, RuleReading& reading)
      : node_(node), scope_(scope), reading_(reading), faults_(reading.faults) {}

  std::optional<EvidenceLine> read() {
    if (!checkKeys(node_, "evidence", faults_)) return std::nullopt;
    const std::size_t faults_before = faults_.errorCount();
    line_.at = node_.at;
    readKind();
    if (const YamlNode* missing = node_.find("missing")) line_.missing = readNumber(*missing);
    if (faults_.errorCount() != faults_before) return std::nullopt;
    return line_;
  }

 private:
  void readKind() {
    const YamlNode *curve = node_.find("curve"), *about = node_.find("about"), *when = node_.find("when");
    const int kinds = (curve != nullptr) + (about != nullptr) + (when != nullptr);
    if (kinds != 1) return faults_.error(node_.at, "a line of evidence has one of 'curve', 'about' and 'when'");
    if (when != nullptr) return readTest(*when);
    countMeasures();
    auto measure = readMeasure(node_, scope_, reading_);
    if (!measure) return;  // the dimension of the other values is not known
    line_.measure = std::move(*measure);
    curve != nullptr ? readCurve(*curve) : readBell(*about);
  }

  void countMeasures() {
    int count = 0;
    for (const std::string_view key :
         {"attribute", "gap_to", "horizontal_gap_to", "vertical_gap_to", "axis_distance_to", "adjacent_fraction_to"})
      count += node_.find(key) != nullptr ? 1 : 0;
    if (count != 1)
      faults_.error(node_.at, "a line of evidence measures one thing",
                    "give it one of: measure, attribute, gap_to, axis_distance_to, adjacent_fraction_to");
  }

  void readTest(const YamlNode& when) {
    line_.kind = EvidenceLine::Kind::Test;
    for (const std::string_view key : {"attribute", "slice", "relative_to", "gap_to", "spread", "of"})
      if (const YamlNode* stray = node_.keyNode(key))
        faults_.error(stray->at, "'" + std::string(key) + "' has no meaning beside 'when'", "write it inside 'when'");
    if (auto condition = readCondition(when, scope_, reading_)) line_.measure = std::move(*condition);
    readWeight();
  }

  void readBell(const YamlNode& about) {
    line_.kind = EvidenceLine::Kind::Bell;
    if (const auto centre = readQuantity(about, dimension(), reading_)) line_.about = centre->value;
    if (const YamlNode* spread = requireKey(node_, "spread", "evidence", faults_))
      if (const auto width = readQuantity(*spread, dimension(), reading_)) {
        line_.spread = width->value;
        if (width->value <= 0) faults_.error(spread->at, "'spread' must be greater than 0");
      }
    readWeight();
  }

  void readCurve(const YamlNode& curve) {
    line_.kind = EvidenceLine::Kind::Curve;
    if (const YamlNode* stray = node_.keyNode("weight"))
      faults_.error(stray->at, "'weight' beside 'curve'", "a curve gives the log-odds at each of its values");
    if (!curve.isMap() || curve.items.size() < 2)
      return faults_.error(curve.at, "a curve needs two values or more", "curve: { 2 cm: -1, 8 cm: 1.5 }");
    for (std::size_t i = 0; i < curve.items.size(); ++i) {
      const auto at = readQuantity(curve.keys[i], dimension(), reading_);
      if (!at) continue;
      if (!line_.knots.empty() && line_.knots.back().at >= at->value)
        faults_.error(curve.keys[i].at, "the values of a curve must grow");
      line_.knots.push_back({at->value, readNumber(curve.items[i]), curve.items[i].at});
    }
  }

  void readWeight() {
    const YamlNode* weight = requireKey(node_, "weight", "evidence", faults_);
    if (weight == nullptr) return;
    line_.weight = readNumber(*weight);
    line_.weight_at = weight->at;
  }

  double readNumber(const YamlNode& node) {
    const auto number = readQuantity(node, perception::Dimension::Ratio, reading_);
    return number ? number->value : 0;
  }

  perception::Dimension dimension() const {
    const Condition& measure = line_.measure;
    if (measure.kind == Condition::Kind::Pair)
      return measure.measure == PairMeasure::AdjacentFraction ? perception::Dimension::Ratio
                                                              : perception::Dimension::Length;
    if (measure.ratio_attribute) return perception::Dimension::Ratio;
    return perception::attributeInfos()[static_cast<std::size_t>(measure.attribute)].dimension;
  }

  const YamlNode& node_;
  const NameScope& scope_;
  RuleReading& reading_;
  FaultList& faults_;
  EvidenceLine line_;
};

/// `measure: roughness of whole from 1 m to 2 m` as the keys that it is short for.
YamlNode withMeasureWrittenOut(const YamlNode& line, FaultList& faults) {
  const YamlNode* text = line.find("measure");
  if (text == nullptr || !text->isScalar()) return line;
  const auto meant = measureOfText(*text, faults);
  YamlNode written = line;
  const auto place =
      std::find_if(written.keys.begin(), written.keys.end(), [](const YamlNode& key) { return key.text == "measure"; });
  written.items.erase(written.items.begin() + (place - written.keys.begin()));
  written.keys.erase(place);
  if (!meant) return written;
  written.keys.insert(written.keys.end(), meant->keys.begin(), meant->keys.end());
  written.items.insert(written.items.end(), meant->items.begin(), meant->items.end());
  return written;
}

}  // namespace

std::vector<EvidenceLine> readEvidence(const YamlNode& node, const NameScope& scope, RuleReading& reading) {
  std::vector<EvidenceLine> lines;
  if (!node.isSequence()) {
    reading.faults.error(node.at, "'evidence' takes a list", "- { attribute: height, curve: { 1 m: -1, 2 m: 1 } }");
    return lines;
  }
  NameScope with_whole = scope;
  with_whole.names.emplace_back(kWholeCandidate);
  for (const YamlNode& written : node.items) {
    const YamlNode item = withMeasureWrittenOut(written, reading.faults);
    if (auto line = EvidenceReader(item, with_whole, reading).read()) lines.push_back(std::move(*line));
  }
  return lines;
}

}  // namespace cluxel::rules
