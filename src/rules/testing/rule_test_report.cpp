// SPDX-License-Identifier: Apache-2.0
// The report of a rule test run as text, JSON and JUnit XML.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "sparql/results/term_text.hpp"

#include "rules/testing/rule_test.hpp"

namespace cluxel::rules {

namespace {

std::string_view nameOf(RuleTestOutcome outcome) {
  switch (outcome) {
    case RuleTestOutcome::Passed:
      return "passed";
    case RuleTestOutcome::Failed:
      return "failed";
    case RuleTestOutcome::KnownFailure:
      return "known failure";
    case RuleTestOutcome::UnexpectedPass:
      return "passes, though marked todo";
    case RuleTestOutcome::Skipped:
      break;
  }
  return "skipped";
}

std::string xmlEscaped(std::string_view text) {
  std::string escaped;
  sparql::appendXmlText(escaped, text);
  return escaped;
}

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += (text.empty() ? "" : "\n") + line;
  return text;
}

template <typename Covered>
std::size_t reached(const std::vector<Covered>& all) {
  std::size_t count = 0;
  for (const Covered& one : all) count += one.hits > 0 ? 1 : 0;
  return count;
}

/// A branch to a leaf is reported as that leaf.
bool leadsToLeaf(const BranchCoverage& branch, const RuleTestReport& report) {
  return std::any_of(report.leaves.begin(), report.leaves.end(), [&](const LeafCoverage& leaf) {
    return leaf.rule_id == branch.rule_id && leaf.node == branch.to;
  });
}

}  // namespace

std::string textOf(const RuleTestReport& report) {
  std::string text;
  for (const RuleTestResult& result : report.results) {
    text += std::string(nameOf(result.outcome)) + ": " + result.name + "\n";
    if (result.outcome == RuleTestOutcome::Passed) continue;
    for (const std::string& failure : result.failures) text += "    " + failure + "\n";
  }
  for (const LeafCoverage& leaf : report.leaves)
    if (leaf.hits == 0) text += "no test reaches " + toString(leaf.at) + ": " + leaf.rule_id + ", " + leaf.leaf + "\n";
  for (const BranchCoverage& branch : report.branches)
    if (branch.hits == 0 && !leadsToLeaf(branch, report))
      text += "no test takes '" + branch.way + "' of " + toString(branch.at) + ": " + branch.rule_id + "\n";
  text += std::to_string(report.count(RuleTestOutcome::Passed)) + " passed, " +
          std::to_string(report.count(RuleTestOutcome::Failed) + report.count(RuleTestOutcome::UnexpectedPass)) +
          " failed, " + std::to_string(report.count(RuleTestOutcome::KnownFailure)) + " known failures, " +
          std::to_string(report.count(RuleTestOutcome::Skipped)) + " skipped; " +
          std::to_string(reached(report.leaves)) + " of " + std::to_string(report.leaves.size()) + " leaves and " +
          std::to_string(reached(report.branches)) + " of " + std::to_string(report.branches.size()) +
          " branches reached\n";
  return text;
}

std::string jsonOf(const RuleTestReport& report) {
  nlohmann::ordered_json json;
  json["passed"] = report.passed();
  for (const RuleTestResult& result : report.results)
    json["tests"].push_back({{"name", result.name},
                             {"line", result.at.line},
                             {"outcome", std::string(nameOf(result.outcome))},
                             {"failures", result.failures}});
  for (const LeafCoverage& leaf : report.leaves)
    json["leaves"].push_back({{"rule", leaf.rule_id},
                              {"leaf", leaf.leaf},
                              {"file", leaf.at.file},
                              {"line", leaf.at.line},
                              {"hits", leaf.hits}});
  for (const BranchCoverage& branch : report.branches)
    json["branches"].push_back({{"rule", branch.rule_id},
                                {"way", branch.way},
                                {"file", branch.at.file},
                                {"line", branch.at.line},
                                {"hits", branch.hits}});
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

std::string junitOf(const RuleTestReport& report, const std::string& suite) {
  const std::size_t failed = report.count(RuleTestOutcome::Failed) + report.count(RuleTestOutcome::UnexpectedPass);
  const std::size_t skipped = report.count(RuleTestOutcome::Skipped) + report.count(RuleTestOutcome::KnownFailure);
  std::string xml = "<testsuite name=\"" + xmlEscaped(suite) + "\" tests=\"" + std::to_string(report.results.size()) +
                    "\" failures=\"" + std::to_string(failed) + "\" skipped=\"" + std::to_string(skipped) + "\">\n";
  for (const RuleTestResult& result : report.results) {
    xml += "  <testcase classname=\"" + xmlEscaped(suite) + "\" name=\"" + xmlEscaped(result.name) + "\">";
    const std::string words = xmlEscaped(joined(result.failures));
    if (result.outcome == RuleTestOutcome::Failed || result.outcome == RuleTestOutcome::UnexpectedPass)
      xml += "<failure message=\"" + std::string(nameOf(result.outcome)) + "\">" + words + "</failure>";
    if (result.outcome == RuleTestOutcome::Skipped || result.outcome == RuleTestOutcome::KnownFailure)
      xml += "<skipped message=\"" + std::string(nameOf(result.outcome)) + "\"/>";
    xml += "</testcase>\n";
  }
  return xml + "</testsuite>\n";
}

}  // namespace cluxel::rules
