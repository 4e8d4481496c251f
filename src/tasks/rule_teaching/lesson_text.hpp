// SPDX-License-Identifier: Apache-2.0
// A lesson as YAML: the rule file with the exception, and the test with the case.
#pragma once

#include <string>
#include <vector>

#include "mapping/map_reader.hpp"
#include "rules/language/rule_set.hpp"
#include "tasks/rule_teaching/separating_cuts.hpp"

namespace cluxel::tasks {

struct LessonCase {
  std::size_t object = 0;  ///< in MapReader::objects()
  std::string class_iri;
  std::string rule_file;
  std::vector<perception::PrimitiveIndex> seeds;
  std::vector<AttributeCut> cuts;
  std::vector<std::string> guarded;  ///< ids of rules that must leave the case alone
  std::string rule_id;  ///< of the new rule: "taught/tree-1a2b3c4d": distinctName() and digits of the seed's hash
};

/// A rule file that includes the root files of the map; `body` follows.
std::string includingText(const mapping::MapReader& map, const std::string& body);
/// The rule file of the lesson. Throws Error when a rule to be guarded cannot be found in the map's rule files.
std::string ruleText(const mapping::MapReader& map, const rules::RuleSet& rules, LessonCase& lesson);
/// The test file: the seeds as boxes with all their attributes.
std::string testText(const mapping::MapReader& map, const rules::RuleSet& rules, const LessonCase& lesson);

}  // namespace cluxel::tasks
