// SPDX-License-Identifier: Apache-2.0
// Runs mutants against the tests whose decisions passed the mutated place.
#include "rules/testing/rule_mutation.hpp"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "base/parallel.hpp"
#include "rules/explain/path_tree.hpp"
#include "rules/testing/rule_mutants.hpp"
#include "rules/testing/rule_test_file.hpp"

namespace cluxel::rules {

namespace {

/// A test that passes with the rules as they are, and the nodes that its decisions passed.
struct PassingTest {
  const RuleTest* test = nullptr;
  BuiltBoxScene built;
  std::map<std::string, std::set<NodeIndex>> nodes_of;  ///< by rule id
  std::set<scan::PrimitiveLabel> labels;
};

class MutationRun {
 public:
  MutationRun(RuleTestFile file, const RuleTestOptions& options) : file_(std::move(file)), options_(options) {
    for (const RuleTest& test : file_.tests)
      if (!test.todo && !test.scene && (!options.only || test.name.find(*options.only) != std::string::npos))
        prepare(test);
  }

  RuleMutationReport run(unsigned threads) {
    std::vector<PlacedMutant> all;
    std::map<std::pair<std::string, std::string>, std::size_t> number_of;
    RuleMutationReport report;
    for (std::size_t i = 0; i < file_.rules.rules.size(); ++i) {
      const Rule& rule = file_.rules.rules[i];
      if (!file_.isAtHand(rule)) continue;
      report.rules.push_back(rule.id);
      for (MutantOfRule& mutant : mutantsOf(rule)) {
        const std::string& what = mutant.mutant.what;
        const std::string error = what.substr(what.rfind(": ") == std::string::npos ? 0 : what.rfind(": "));
        const auto known = number_of.try_emplace({toString(mutant.mutant.at), error}, all.size());
        if (known.second) all.emplace_back();
        all[known.first->second].emplace_back(i, std::move(mutant));
      }
    }
    report.mutants.resize(all.size());
    parallelFor(all.size(), threads, [&](std::size_t i) {
      report.mutants[i] = all[i].front().second.mutant;
      report.mutants[i].killed_by = killerOf(all[i]);
    });
    return report;
  }

 private:
  /// The same error in all rules that use one definition, with the rules' numbers.
  using PlacedMutant = std::vector<std::pair<std::size_t, MutantOfRule>>;

  void prepare(const RuleTest& test) {
    PassingTest passing;
    passing.test = &test;
    passing.built = sceneOfBoxes(test.boxes);
    ReasoningContext context;
    context.oracle = options_.oracle;
    const ReasoningResult made = reason(passing.built.scene, file_.rules, context);
    if (!unmetExpectations(test.expect, file_.rules, passing.built.scene, passing.built.names, made).empty()) return;
    for (const Decision& decision : made.decisions) {
      auto& nodes = passing.nodes_of[decision.rule_id];
      nodes.insert(decision.leaf);
      for (const WalkedPath& walked : walkedPath(*file_.rules.find(decision.rule_id), decision))
        nodes.insert(walked.node);
    }
    for (const perception::Primitive& primitive : passing.built.scene.primitives)
      passing.labels.insert(primitive.label);
    tests_.push_back(std::move(passing));
  }

  bool concerns(const PassingTest& test, const Rule& rule, const MutantOfRule& mutant) const {
    const auto nodes = test.nodes_of.find(rule.id);
    if (mutant.node) return nodes != test.nodes_of.end() && nodes->second.contains(*mutant.node);
    return nodes != test.nodes_of.end() ||
           std::any_of(rule.seed.labels.begin(), rule.seed.labels.end(),
                       [&](scan::PrimitiveLabel label) { return test.labels.contains(label); });
  }

  std::string killerOf(const PlacedMutant& mutants) const {
    RuleSet rules = file_.rules;
    for (const auto& [number, mutant] : mutants) mutant.apply(rules.rules[number]);
    for (const PassingTest& test : tests_) {
      const bool concerned = std::any_of(mutants.begin(), mutants.end(), [&](const auto& placed) {
        return concerns(test, file_.rules.rules[placed.first], placed.second);
      });
      if (concerned && fails(test, rules)) return test.test->name;
    }
    return {};
  }

  bool fails(const PassingTest& test, const RuleSet& rules) const {
    ReasoningContext context;
    context.oracle = options_.oracle;
    try {
      const ReasoningResult made = reason(test.built.scene, rules, context);
      return !unmetExpectations(test.test->expect, rules, test.built.scene, test.built.names, made).empty();
    } catch (const Error&) {
      return true;
    }
  }

  RuleTestFile file_;
  const RuleTestOptions& options_;
  std::vector<PassingTest> tests_;
};

}  // namespace

std::size_t RuleMutationReport::killed() const {
  return static_cast<std::size_t>(std::count_if(mutants.begin(), mutants.end(),
                                                [](const RuleMutant& mutant) { return !mutant.killed_by.empty(); }));
}

double RuleMutationReport::score() const {
  return mutants.empty() ? 1 : static_cast<double>(killed()) / static_cast<double>(mutants.size());
}

std::vector<std::string> RuleMutationReport::untouchedRules() const {
  std::vector<std::string> untouched;
  for (const std::string& id : rules)
    if (std::none_of(mutants.begin(), mutants.end(),
                     [&](const RuleMutant& mutant) { return mutant.rule_id == id && !mutant.killed_by.empty(); }))
      untouched.push_back(id);
  return untouched;
}

RuleMutationReport mutateRules(const std::filesystem::path& file, const ClassCatalogue& catalogue,
                               const RuleTestOptions& options, unsigned threads) {
  return MutationRun(readRuleTestFile(file, catalogue, options.load), options).run(threads);
}

std::string textOf(const RuleMutationReport& report) {
  std::string text;
  for (const RuleMutant& mutant : report.mutants)
    if (mutant.killed_by.empty())
      text += "no test notices " + toString(mutant.at) + ": " + mutant.rule_id + ", " + mutant.what + "\n";
  for (const std::string& id : report.untouchedRules()) text += "no mutant of rule " + id + " is noticed\n";
  char score[32];
  std::snprintf(score, sizeof score, "%.3f", report.score());
  return text + std::to_string(report.killed()) + " of " + std::to_string(report.mutants.size()) +
         " mutants noticed, score " + score + "\n";
}

std::string jsonOf(const RuleMutationReport& report) {
  nlohmann::ordered_json json{{"mutants", report.mutants.size()},
                              {"killed", report.killed()},
                              {"score", report.score()},
                              {"untouched_rules", report.untouchedRules()}};
  for (const RuleMutant& mutant : report.mutants)
    json["list"].push_back({{"rule", mutant.rule_id},
                            {"file", mutant.at.file},
                            {"line", mutant.at.line},
                            {"what", mutant.what},
                            {"killed_by", mutant.killed_by}});
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace cluxel::rules
