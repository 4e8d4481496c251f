// SPDX-License-Identifier: Apache-2.0
// Counts the decisions near each threshold, and measures noise on halves of primitives.
#include "rules/testing/threshold_noise.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>
#include <tuple>

#include "base/quantile.hpp"
#include "rules/propose/candidate.hpp"
#include "rules/propose/fragment_table.hpp"

namespace cluxel::rules {

namespace {

constexpr std::size_t kMinCluxels = 8, kMaxCluxels = 5000, kMaxSamples = 200, kMinSamples = 5;

/// A test by rule, line and words.
using TestName = std::tuple<std::string, std::size_t, std::string>;

struct KnownTest {
  const Rule* rule = nullptr;
  const Condition* condition = nullptr;  ///< of an attribute
  std::vector<double> measured;
};

class NoiseSearch {
 public:
  NoiseSearch(const perception::Scene& scene, const RuleSet& rules) : scene_(scene) {
    for (const Rule& rule : rules.rules)
      for (const TreeNode& node : rule.nodes)
        if (const auto* branch = std::get_if<BranchNode>(&node.what)) add(rule, branch->condition, branch->condition);
  }

  void count(const std::vector<Decision>& decisions) {
    for (const Decision& decision : decisions)
      for (const DecisionStep& step : decision.path)
        if (const auto test = tests_.find({step.rule_id, step.line, step.test});
            test != tests_.end() && step.measured && std::isfinite(*step.measured))
          test->second.measured.push_back(*step.measured);
  }

  std::vector<NoisyThreshold> find(const NoiseParams& params) const {
    std::vector<NoisyThreshold> found;
    for (const auto& [name, test] : tests_) {
      if (test.measured.size() < params.min_tests) continue;
      std::optional<NoisyThreshold> worst;
      for (const auto* bound : {&test.condition->value, &test.condition->upper})
        if (*bound)
          if (const auto near = nearOf(name, test, (*bound)->value); near && (!worst || near->near > worst->near))
            worst = near;
      if (worst && static_cast<double>(worst->near) >= params.min_share * static_cast<double>(worst->tested))
        found.push_back(*worst);
    }
    std::stable_sort(found.begin(), found.end(), [](const NoisyThreshold& a, const NoisyThreshold& b) {
      return a.near * b.tested > b.near * a.tested;
    });
    return found;
  }

 private:
  /// `step` is what a decision writes down: the test itself, or its `not`.
  void add(const Rule& rule, const Condition& condition, const Condition& step) {
    if (condition.kind == Condition::Kind::Unseen) return;
    if (condition.kind == Condition::Kind::Attribute) {
      if (condition.value && !condition.ratio_attribute && isMeasuredOnHalves(condition.attribute))
        tests_[{rule.id, step.at.line, describe(step)}] = {&rule, &condition, {}};
      return;
    }
    const bool negates = condition.kind == Condition::Kind::Not && condition.operands.front().operands.empty();
    for (const Condition& operand : condition.operands) add(rule, operand, negates ? condition : operand);
  }

  std::optional<NoisyThreshold> nearOf(const TestName& name, const KnownTest& test, double threshold) const {
    const auto noise = noiseNear(*test.rule, *test.condition, threshold);
    if (!noise) return std::nullopt;
    const auto near = std::count_if(test.measured.begin(), test.measured.end(),
                                    [&](double value) { return std::abs(value - threshold) <= *noise; });
    return NoisyThreshold{test.condition->at,
                          test.rule->id,
                          std::get<2>(name),
                          test.condition->attribute,
                          *noise,
                          test.measured.size(),
                          static_cast<std::size_t>(near)};
  }

  std::optional<double> noiseNear(const Rule& rule, const Condition& condition, double threshold) const {
    std::vector<double> differences;
    for (const perception::Primitive& primitive : scene_.primitives) {
      if (differences.size() == kMaxSamples) break;
      const auto& labels = rule.seed.labels;
      if (condition.of == rule.seed.name && std::find(labels.begin(), labels.end(), primitive.label) == labels.end())
        continue;
      if (!condition.slice && !isNear(primitive[condition.attribute], threshold)) continue;
      if (const auto difference = differenceOfHalves(primitive, condition, threshold))
        differences.push_back(*difference / 2);
    }
    if (differences.size() < kMinSamples) return std::nullopt;
    std::sort(differences.begin(), differences.end());
    return quantileOf(differences, 0.5);
  }

  static bool isMeasuredOnHalves(perception::Attribute attribute) {
    using perception::Attribute;
    return attribute != Attribute::PointCount && attribute != Attribute::CluxelCount &&
           attribute != Attribute::GroundContact && attribute != Attribute::ViewCount &&
           attribute != Attribute::MeanIntensity;
  }

  static bool isNear(double value, double threshold) {
    return std::abs(value) >= std::abs(threshold) / 2 && std::abs(value) <= std::abs(threshold) * 2;
  }

  std::optional<double> differenceOfHalves(const perception::Primitive& primitive, const Condition& condition,
                                           double threshold) const {
    std::array<std::vector<std::uint32_t>, 2> halves;
    std::size_t count = 0;
    for (const std::uint32_t cluxel : primitive.cluxels)
      if (!condition.slice || isWithin(scene_.cluxels, cluxel, *condition.slice)) halves[count++ % 2].push_back(cluxel);
    if (count < kMinCluxels || count > kMaxCluxels) return std::nullopt;
    std::array<double, 2> values{};
    for (std::size_t i = 0; i < 2; ++i) values[i] = shapeOfCluxels(scene_, halves[i], {}, {})[condition.attribute];
    if (condition.slice && !isNear((values[0] + values[1]) / 2, threshold)) return std::nullopt;
    return std::abs(values[0] - values[1]);
  }

  const perception::Scene& scene_;
  std::map<TestName, KnownTest> tests_;
};

/// Two digits and the unit in which rules write the attribute.
std::string shown(const NoisyThreshold& threshold) {
  const auto dimension = perception::attributeInfos()[static_cast<std::size_t>(threshold.attribute)].dimension;
  const double scale = dimension == perception::Dimension::Angle ? 180 / std::numbers::pi : 1;
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.2g", threshold.noise * scale);
  const std::string_view unit = unitOf(dimension);
  return text.data() + (unit.empty() ? "" : " " + std::string(unit));
}

}  // namespace

std::vector<NoisyThreshold> thresholdsWithinNoise(const perception::Scene& scene, const RuleSet& rules,
                                                  const ReasoningContext& context, const NoiseParams& params) {
  NoiseSearch search(scene, rules);
  search.count(reason(scene, rules, context).decisions);
  return search.find(params);
}

std::vector<Diagnostic> warningsOf(const std::vector<NoisyThreshold>& thresholds) {
  std::vector<Diagnostic> warnings;
  for (const NoisyThreshold& threshold : thresholds) {
    Diagnostic warning;
    warning.severity = Severity::Warning;
    warning.location = threshold.at;
    warning.message = threshold.rule_id + ": '" + threshold.test + "': " + std::to_string(threshold.near) + " of " +
                      std::to_string(threshold.tested) + " things that it tests lie within the noise of " +
                      shown(threshold);
    warning.hint = "let a curve of evidence judge the attribute, or test another one";
    warnings.push_back(std::move(warning));
  }
  return warnings;
}

}  // namespace cluxel::rules
