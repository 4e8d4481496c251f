// SPDX-License-Identifier: Apache-2.0
// YAML trees: places, faults of form, unknown keys, and plain values.
#include "base/yaml/yaml_tree.hpp"

#include <gmock/gmock.h>

#include <ctime>

namespace cluxel::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// The faults of `text` as file f.yaml, one formatted text.
std::string faultsOf(const std::string& text) {
  FaultList faults("f.yaml", text);
  (void)parseYaml("f.yaml", text, faults);
  return format(faults.sorted());
}

TEST(YamlTree, KnowsThePlaceOfEveryNode) {
  const std::string text = "a: 1\nb:\n  - x\n  - { c: 'y z' }\n";
  FaultList faults("f.yaml", text);
  const auto root = parseYaml("f.yaml", text, faults);
  ASSERT_TRUE(root && root->isMap());
  EXPECT_EQ(faults.errorCount(), 0U);
  const YamlNode* list = root->find("b");
  ASSERT_TRUE(list != nullptr && list->isSequence() && list->items.size() == 2);
  EXPECT_EQ(toString(root->keyNode("b")->at), "f.yaml:2:1");
  EXPECT_EQ(toString(list->items[0].at), "f.yaml:3:5");
  EXPECT_EQ(list->items[1].find("c")->text, "y z");
  EXPECT_EQ(root->find("d"), nullptr);
}

TEST(YamlTree, RefusesRepeatedKeysWithBothPlaces) {
  EXPECT_THAT(faultsOf("a: 1\nb: 2\na: 3\n"),
              ::testing::AllOf(HasSubstr("f.yaml:3:1: error: the key 'a' stands here twice"), HasSubstr("line 1")));
}

TEST(YamlTree, RefusesAnchorsAliasesFurtherDocumentsAndDeepNesting) {
  EXPECT_THAT(faultsOf("a: &x 1\nb: *x\n"), HasSubstr("anchors and aliases are not supported"));
  EXPECT_THAT(faultsOf("a: 1\n---\nb: 2\n"), HasSubstr("more than one YAML document"));
  EXPECT_THAT(faultsOf(std::string(200, '[') + std::string(200, ']')), HasSubstr("nested too deeply"));
}

TEST(YamlTree, IsAbsentForWhatIsNoYamlAndNullForAnEmptyText) {
  FaultList faults("f.yaml", "");
  EXPECT_FALSE(parseYaml("f.yaml", "[1, 2", faults));
  EXPECT_EQ(faults.errorCount(), 1U);
  const auto empty = parseYaml("f.yaml", "", faults);
  ASSERT_TRUE(empty);
  EXPECT_TRUE(empty->isNull());
}

TEST(YamlTree, SuggestsTheKnownKeyForAMistypedOne) {
  const std::string text = "hieght: 2\n";
  FaultList faults("f.yaml", text);
  const std::vector<std::string> known{"height", "width"};
  EXPECT_TRUE(checkMapping(*parseYaml("f.yaml", text, faults), known, faults));
  EXPECT_THAT(format(faults.sorted()),
              ::testing::AllOf(HasSubstr("f.yaml:1:1: error: unknown key 'hieght'"), HasSubstr("'height'")));
}

TEST(YamlTree, ReadsFiniteNumbersAndJoinsRows) {
  const std::string text = "[[1, +2], [-3.5, 4e1]]";
  FaultList faults("f.yaml", text);
  const auto numbers = numbersOf(*parseYaml("f.yaml", text, faults), 4, "matrix", faults);
  ASSERT_TRUE(numbers);
  EXPECT_THAT(*numbers, ElementsAre(1, 2, -3.5, 40));
  for (const char* bad : {"", "1 m", "nan", "inf", "0x10", "1e999"}) EXPECT_FALSE(parseNumber(bad)) << bad;
}

TEST(FaultList, SortsByPlaceAndReportsEqualFaultsOnce) {
  FaultList faults("f.yaml", "one\ntwo\n");
  faults.error({.file = "f.yaml", .line = 2, .column = 1}, "second");
  faults.error({.file = "f.yaml", .line = 1, .column = 1}, "first");
  faults.error({.file = "f.yaml", .line = 2, .column = 1}, "second");
  const auto sorted = faults.sorted();
  ASSERT_EQ(sorted.size(), 2U);
  EXPECT_EQ(sorted[0].message, "first");
  EXPECT_EQ(sorted[1].source_line, "two");
  EXPECT_THROW(faults.throwIfErrors(), InputError);
}

/// The CPU time to read a mapping of so many keys.
double secondsFor(int keys) {
  std::string text;
  for (int i = 0; i < keys; ++i) text += "key" + std::to_string(i) + ": 1\n";
  FaultList faults("f.yaml", text);
  const std::clock_t start = std::clock();
  EXPECT_TRUE(parseYaml("f.yaml", text, faults));
  EXPECT_EQ(faults.errorCount(), 0U);
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

TEST(YamlTree, CostsOfAMappingAreLinearInItsKeys) {
  const double few = secondsFor(10'000);
  EXPECT_LT(secondsFor(80'000), 24 * few + 0.1);
}

TEST(YamlTree, RefusesATextOfMoreThanEightMebibytes) {
  const std::string text = "a: " + std::string(std::size_t{8} << 20U, 'x');
  EXPECT_THAT(faultsOf(text), HasSubstr("f.yaml: error: is larger than 8 MiB"));
}

TEST(YamlTree, RefusesATextThatIsNotUtf8WithItsPlace) {
  const std::string fault = faultsOf(
      "a: 1\nb: Stra\xDF"
      "e\n");
  EXPECT_THAT(fault, HasSubstr("f.yaml:2:8: error: is not UTF-8"));
  EXPECT_THAT(fault, HasSubstr("save the file in UTF-8"));
  EXPECT_EQ(faultsOf("b: Stra\xC3\x9F"
                     "e\n"),
            "");
}

}  // namespace
}  // namespace cluxel::testing
