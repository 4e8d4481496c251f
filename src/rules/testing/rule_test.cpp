// SPDX-License-Identifier: Apache-2.0
// Runs rule tests and counts the leaves they reach.
#include "rules/testing/rule_test.hpp"

#include <algorithm>

#include "rules/testing/rule_test_file.hpp"

namespace cluxel::rules {

namespace {

std::vector<LeafCoverage> leavesOf(const RuleSet& rules) {
  std::vector<LeafCoverage> leaves;
  for (const Rule& rule : rules.rules)
    for (const TreeNode& node : rule.nodes) {
      if (const auto* reject = std::get_if<RejectLeaf>(&node.what))
        leaves.push_back({rule.id, node.at, reject->reason});
      if (std::holds_alternative<AcceptLeaf>(node.what)) leaves.push_back({rule.id, node.at, "accept"});
    }
  return leaves;
}

class TestRun {
 public:
  TestRun(const RuleTestFile& file, const RuleTestOptions& options) : file_(file), options_(options) {
    report_.leaves = leavesOf(file.rules);
    report_.warnings = file.warnings;
  }

  RuleTestReport run() {
    for (const RuleTest& test : file_.tests)
      if (!options_.only || test.name.find(*options_.only) != std::string::npos)
        report_.results.push_back(runOne(test));
    return std::move(report_);
  }

 private:
  RuleTestResult runOne(const RuleTest& test) {
    RuleTestResult result;
    result.name = test.name;
    result.at = test.at;
    if (test.scene && !options_.scenes) {
      result.outcome = RuleTestOutcome::Skipped;
      result.failures = {"needs the pipeline or a map, which are not at hand here"};
      return result;
    }
    try {
      result.failures = failuresOf(test);
    } catch (const Error& fault) {
      result.failures = {fault.what()};
    }
    if (result.failures.empty())
      result.outcome = test.todo ? RuleTestOutcome::UnexpectedPass : RuleTestOutcome::Passed;
    else
      result.outcome = test.todo ? RuleTestOutcome::KnownFailure : RuleTestOutcome::Failed;
    return result;
  }

  std::vector<std::string> failuresOf(const RuleTest& test) {
    BuiltBoxScene built;
    if (test.scene)
      built.scene = options_.scenes(*test.scene);
    else
      built = sceneOfBoxes(test.boxes);
    ReasoningContext context;
    context.oracle = options_.oracle;
    const ReasoningResult made = reason(built.scene, file_.rules, context);
    for (const Decision& decision : made.decisions) countLeaf(decision);
    return unmetExpectations(test.expect, file_.rules, built.scene, built.names, made);
  }

  void countLeaf(const Decision& decision) {
    const Rule* rule = file_.rules.find(decision.rule_id);
    const SourceLocation& at = rule->nodes[decision.leaf].at;
    for (LeafCoverage& leaf : report_.leaves)
      if (leaf.rule_id == decision.rule_id && leaf.at.file == at.file && leaf.at.line == at.line &&
          leaf.at.column == at.column)
        ++leaf.hits;
  }

  const RuleTestFile& file_;
  const RuleTestOptions& options_;
  RuleTestReport report_;
};

}  // namespace

std::size_t RuleTestReport::count(RuleTestOutcome outcome) const {
  return static_cast<std::size_t>(std::count_if(
      results.begin(), results.end(), [&](const RuleTestResult& result) { return result.outcome == outcome; }));
}

bool RuleTestReport::passed() const {
  return count(RuleTestOutcome::Failed) == 0 && count(RuleTestOutcome::UnexpectedPass) == 0;
}

RuleTestReport runRuleTests(const std::filesystem::path& file, const ClassCatalogue& catalogue,
                            const RuleTestOptions& options) {
  const RuleTestFile tests = readRuleTestFile(file, catalogue, options.load);
  return TestRun(tests, options).run();
}

}  // namespace cluxel::rules
