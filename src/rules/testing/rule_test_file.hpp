// SPDX-License-Identifier: Apache-2.0
// A rule test file as plain values.
#pragma once

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "rules/testing/box_scene.hpp"
#include "rules/testing/rule_test.hpp"

namespace cluxel::rules {

struct ExpectedObject {
  SourceLocation at;
  std::string class_iri;
  std::map<std::string, std::vector<std::string>> parts;  ///< part class IRI (or "" for any) -> names of primitives
  std::optional<Comparison> confidence_is;
  double confidence = 0;
  std::string rule_id;
};

/// A primitive that rules of a class must reject with a certain reason.
struct ExpectedReason {
  SourceLocation at;
  std::string primitive, rule_id, reason;
};

struct GoldenObjects {
  std::filesystem::path file;
  double iou = 0.8, min_precision = 0, min_recall = 0;
};

struct Expectation {
  std::vector<ExpectedObject> objects;
  bool exactly = false;
  std::vector<std::string> absent;           ///< class IRIs
  std::map<std::string, std::size_t> count;  ///< class IRI -> number of objects
  std::vector<ExpectedReason> reasons;
  std::optional<GoldenObjects> golden;
};

struct RuleTest {
  std::string name;
  SourceLocation at;
  bool todo = false;
  BoxScene boxes;
  std::optional<SceneRequest> scene;
  Expectation expect;
};

struct RuleTestFile {
  RuleSet rules;
  std::vector<RuleTest> tests;
  std::vector<Diagnostic> warnings;
  std::vector<std::string> roots;  ///< the rule files that it names

  bool isAtHand(const Rule& rule) const { return std::find(roots.begin(), roots.end(), rule.at.file) != roots.end(); }
};

/// Throws InputError with all faults of the file and of the rule files it names.
RuleTestFile readRuleTestFile(const std::filesystem::path& file, const ClassCatalogue& catalogue,
                              const RuleLoadOptions& options);

/// The objects as a golden file holds them.
std::string goldenText(const RuleSet& rules, const perception::Scene& scene, const ReasoningResult& result);

/// The expectations that are not met, one line each.
std::vector<std::string> unmetExpectations(const Expectation& expect, const RuleSet& rules,
                                           const perception::Scene& scene, const std::vector<std::string>& names,
                                           const ReasoningResult& result);

}  // namespace cluxel::rules
