// SPDX-License-Identifier: Apache-2.0
// Writes the decisions about each primitive as bytes and hashes them.
#include "rules/explain/decision_digests.hpp"

#include <bit>
#include <string>

#include "base/content_hash.hpp"

namespace cluxel::rules {

namespace {

class Bytes {
 public:
  void add(std::uint64_t value) { text_.append(reinterpret_cast<const char*>(&value), sizeof value); }
  void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }
  void add(const std::optional<double>& value) {
    add(std::uint64_t{value.has_value()});
    if (value) add(*value);
  }
  void add(const std::string& text) {
    add(std::uint64_t{text.size()});
    text_ += text;
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

std::string bytesOf(const Decision& decision) {
  Bytes bytes;
  bytes.add(decision.rule_id);
  bytes.add(std::uint64_t{decision.accepted} * 2 + std::uint64_t{decision.is_gathered});
  bytes.add(std::uint64_t{decision.leaf});
  bytes.add(decision.reason);
  for (const DecisionStep& step : decision.path) {
    bytes.add(std::uint64_t{step.passed});
    bytes.add(step.measured);
    bytes.add(step.threshold);
  }
  bytes.add(decision.log_odds);
  bytes.add(decision.probability);
  for (const EvidenceStep& step : decision.evidence) {
    bytes.add(step.measured);
    bytes.add(step.log_odds);
  }
  for (const RivalNote& rival : decision.rivals) {
    bytes.add(rival.rule_id);
    bytes.add(rival.log_odds);
    bytes.add(std::uint64_t{rival.won});
  }
  return bytes.text();
}

std::string bytesOf(const SemanticObject& object) {
  Bytes bytes;
  bytes.add(object.id.hex());
  bytes.add(object.rule_id);
  bytes.add(object.confidence);
  return bytes.text();
}

}  // namespace

std::vector<std::uint64_t> decisionDigests(const perception::Scene& scene, const ReasoningResult& result) {
  std::vector<std::string> said(scene.primitives.size());
  for (const Decision& decision : result.decisions) {
    const std::string bytes = bytesOf(decision);
    for (const perception::PrimitiveIndex seed : decision.seeds) said[seed] += bytes;
  }
  for (const SemanticObject& object : result.objects) {  // sorted by id
    const std::string bytes = bytesOf(object);
    for (const ObjectPart& part : object.parts)
      for (const perception::PrimitiveIndex primitive : part.primitives) said[primitive] += bytes;
  }
  std::vector<std::uint64_t> digests;
  digests.reserve(said.size());
  for (const std::string& bytes : said)
    digests.push_back(std::hash<ContentHash>()(ContentHasher().addText(bytes).finish()));
  return digests;
}

}  // namespace cluxel::rules
