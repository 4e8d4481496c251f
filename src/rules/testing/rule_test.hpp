// SPDX-License-Identifier: Apache-2.0
// Runs rule tests: fixtures as data, expected objects and reasons, and the coverage of leaves.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "rules/decide/reason.hpp"
#include "rules/language/rule_loader.hpp"

namespace cluxel::rules {

/// The scene of a test that is not made of boxes.
struct SceneRequest {
  enum class Kind { Cloud, Map } kind = Kind::Cloud;
  std::filesystem::path path;
};
/// Provides the scene of a cloud (by running the pipeline) or of a map. Throws Error.
using SceneProvider = std::function<perception::Scene(const SceneRequest&)>;

struct RuleTestOptions {
  SceneProvider scenes;  ///< absent: tests with `cloud` or `map` are skipped
  AskOracle* oracle = nullptr;
  RuleLoadOptions load;
  std::optional<std::string> only;  ///< run tests whose name contains this
};

enum class RuleTestOutcome { Passed, Failed, KnownFailure, UnexpectedPass, Skipped };

struct RuleTestResult {
  std::string name;
  SourceLocation at;
  RuleTestOutcome outcome = RuleTestOutcome::Passed;
  std::vector<std::string> failures;  ///< expected and actual result; for Skipped, the reason
};

/// One leaf of one rule, and how many seeds ended in it.
struct LeafCoverage {
  std::string rule_id;
  NodeIndex node = 0;
  SourceLocation at;
  std::string leaf;  ///< "accept" or the reason of a reject
  std::size_t hits = 0;
};

/// One way out of a node, and how many seeds took it.
struct BranchCoverage {
  std::string rule_id;
  NodeIndex node = 0;
  SourceLocation at;
  std::string way;  ///< "yes", "no", "found" or "missing"
  NodeIndex to = 0;
  std::size_t hits = 0;
};

/// Covers the rules of the files that the test file names, not of those that they include.
struct RuleTestReport {
  std::vector<RuleTestResult> results;
  std::vector<LeafCoverage> leaves;      ///< in the order of the rules
  std::vector<BranchCoverage> branches;  ///< in the order of the rules
  std::vector<Diagnostic> warnings;

  std::size_t count(RuleTestOutcome outcome) const;
  /// No failure, and no known failure that passes now.
  bool passed() const;
};

/// Runs a test file. Throws InputError with all faults when it, or a rule file it names, is faulty.
RuleTestReport runRuleTests(const std::filesystem::path& file, const ClassCatalogue& catalogue,
                            const RuleTestOptions& options = {});

/// Writes the objects that come out now into the golden files of the tests, and says which files it wrote. Throws as
/// runRuleTests() does.
std::vector<std::filesystem::path> updateGolden(const std::filesystem::path& file, const ClassCatalogue& catalogue,
                                                const RuleTestOptions& options = {});
/// The test file, its rule files and those that they include: what a change of the outcome can come from.
std::vector<std::filesystem::path> filesOfRuleTests(const std::filesystem::path& file, const ClassCatalogue& catalogue,
                                                    const RuleLoadOptions& options = {});

/// One line per test, then the leaves and branches that no test reached, then the counts.
std::string textOf(const RuleTestReport& report);
std::string jsonOf(const RuleTestReport& report);
/// One <testsuite> element.
std::string junitOf(const RuleTestReport& report, const std::string& suite);

/// The keys of the test language, for the schema.
const std::vector<RuleKeyTable>& ruleTestKeyTables();

}  // namespace cluxel::rules
