// SPDX-License-Identifier: Apache-2.0
// Runs rule tests and counts the leaves they reach.
#include "rules/testing/rule_test.hpp"

#include <algorithm>

#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "rules/explain/path_tree.hpp"
#include "rules/testing/rule_test_file.hpp"

namespace cluxel::rules {

namespace {

std::vector<LeafCoverage> leavesOf(const RuleTestFile& file) {
  std::vector<LeafCoverage> leaves;
  for (const Rule& rule : file.rules.rules)
    for (NodeIndex i = 0; i < rule.nodes.size() && file.isAtHand(rule); ++i) {
      const TreeNode& node = rule.nodes[i];
      if (const auto* reject = std::get_if<RejectLeaf>(&node.what))
        leaves.push_back({rule.id, i, node.at, reject->reason});
      if (std::holds_alternative<AcceptLeaf>(node.what)) leaves.push_back({rule.id, i, node.at, "accept"});
    }
  return leaves;
}

std::vector<BranchCoverage> branchesOf(const RuleTestFile& file) {
  std::vector<BranchCoverage> branches;
  for (const Rule& rule : file.rules.rules)
    for (NodeIndex i = 0; i < rule.nodes.size() && file.isAtHand(rule); ++i) {
      const TreeNode& node = rule.nodes[i];
      const auto add = [&](const char* way, NodeIndex to) { branches.push_back({rule.id, i, node.at, way, to, 0}); };
      if (const auto* branch = std::get_if<BranchNode>(&node.what)) {
        if (branch->condition.kind == Condition::Kind::Unseen)
          add("unseen", branch->yes);
        else
          add("yes", branch->yes), add("no", branch->no);
      }
      if (const auto* find = std::get_if<FindNode>(&node.what))
        add("found", find->found), add("missing", find->missing);
    }
  return branches;
}

perception::Scene sceneOf(const SceneRequest& request, const RuleTestOptions& options) {
  return options.scenes(request);
}

std::string_view wayOf(const Rule& rule, const WalkedPath& walked) {
  if (walked.tests.kind == PathNode::Kind::Find) return walked.tests.passed ? "found" : "missing";
  if (!walked.tests.passed) return "no";
  const auto* branch = std::get_if<BranchNode>(&rule.nodes[walked.node].what);
  return branch != nullptr && branch->condition.kind == Condition::Kind::Unseen ? "unseen" : "yes";
}

class TestRun {
 public:
  TestRun(const RuleTestFile& file, const RuleTestOptions& options) : file_(file), options_(options) {
    report_.leaves = leavesOf(file);
    report_.branches = branchesOf(file);
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
      // What cannot be read was never tested, so that it is no known failure.
      result.failures = {fault.what()};
      result.outcome = RuleTestOutcome::Failed;
      return result;
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
      built.scene = sceneOf(*test.scene, options_);
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
    for (LeafCoverage& leaf : report_.leaves)
      if (leaf.rule_id == decision.rule_id && leaf.node == decision.leaf) ++leaf.hits;
    for (const WalkedPath& walked : walkedPath(*rule, decision)) {
      const std::string_view way = wayOf(*rule, walked);
      for (BranchCoverage& branch : report_.branches)
        if (branch.rule_id == decision.rule_id && branch.node == walked.node && branch.way == way) ++branch.hits;
    }
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

namespace {

/// A golden file is JSON. Anything else there has another purpose, such as a map.
void refuseOtherFile(const std::filesystem::path& golden) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(golden, ignored)) return;
  if (const std::string begin = readBeginning(golden, 1); !begin.empty() && begin != "{")
    throw Error(ErrorKind::StoreUnavailable,
                golden.string() + ": is no golden file, and would be replaced; name another");
}

}  // namespace

std::vector<std::filesystem::path> updateGolden(const std::filesystem::path& file, const ClassCatalogue& catalogue,
                                                const RuleTestOptions& options) {
  const RuleTestFile tests = readRuleTestFile(file, catalogue, options.load);
  std::vector<std::filesystem::path> written;
  for (const RuleTest& test : tests.tests) {
    const bool chosen = !options.only || test.name.find(*options.only) != std::string::npos;
    if (!test.expect.golden || !chosen || (test.scene && !options.scenes)) continue;
    const perception::Scene scene = test.scene ? sceneOf(*test.scene, options) : sceneOfBoxes(test.boxes).scene;
    ReasoningContext context;
    context.oracle = options.oracle;
    refuseOtherFile(test.expect.golden->file);
    writeFile(test.expect.golden->file, goldenText(tests.rules, scene, reason(scene, tests.rules, context)));
    written.push_back(test.expect.golden->file);
  }
  return written;
}

std::vector<std::filesystem::path> filesOfRuleTests(const std::filesystem::path& file, const ClassCatalogue& catalogue,
                                                    const RuleLoadOptions& options) {
  std::vector<std::filesystem::path> files{file};
  for (const RuleSource& source : readRuleTestFile(file, catalogue, options).rules.sources)
    files.emplace_back(source.name);
  return files;
}

}  // namespace cluxel::rules
