// SPDX-License-Identifier: Apache-2.0
// The JSON schemas for editors and the loader know the same keys, attributes and relations.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "base/file_bytes.hpp"
#include "rules/reasoning_fixture.hpp"
#include "rules/testing/rule_test.hpp"
#include "test_paths.hpp"

namespace cluxel::testing {

using namespace scan;
using namespace perception;
using namespace rules;
namespace {

nlohmann::json schemaOf(const std::string& name) {
  return nlohmann::json::parse(readFile(test::sourceFolder() / "rules" / name));
}

std::set<std::string> keysOf(const nlohmann::json& table) {
  std::set<std::string> keys;
  for (const auto& [key, unused] : table.at("properties").items()) keys.insert(key);
  return keys;
}

void expectSameKeys(const nlohmann::json& schema, const std::vector<RuleKeyTable>& tables, const std::string& root) {
  for (const RuleKeyTable& table : tables) {
    const std::string context(table.context);
    if (context != root) {
      ASSERT_TRUE(schema.at("definitions").contains(context)) << context;
    }
    const auto& described = context == root ? schema : schema.at("definitions").at(context);
    EXPECT_EQ(keysOf(described), std::set<std::string>(table.keys.begin(), table.keys.end())) << context;
    EXPECT_EQ(described.at("additionalProperties"), false) << context;
  }
}

TEST(RuleSchema, HasTheKeysOfTheLoader) {
  expectSameKeys(schemaOf("rules.schema.json"), ruleKeyTables(), "file");
}

TEST(RuleSchema, OfTestsHasTheKeysOfTheTestReader) {
  expectSameKeys(schemaOf("rules-test.schema.json"), ruleTestKeyTables(), "test file");
}

TEST(RuleSchema, KnowsAllAttributesAndRelations) {
  const auto condition = schemaOf("rules.schema.json").at("definitions").at("condition").at("properties");
  std::set<std::string> attributes, relations;
  for (const AttributeInfo& info : attributeInfos()) attributes.emplace(info.name);
  for (const RelationInfo& info : relationInfos()) relations.emplace(info.name);
  EXPECT_EQ(condition.at("attribute").at("enum").get<std::set<std::string>>(), attributes);
  EXPECT_EQ(condition.at("relation").at("enum").get<std::set<std::string>>(), relations);
}

}  // namespace
}  // namespace cluxel::testing
