// SPDX-License-Identifier: Apache-2.0
// One mistake is told once: what is wrong only because something else is, is no fault.
#include <gmock/gmock.h>

#include <regex>

#include "base/file_bytes.hpp"
#include "rules/reasoning_fixture.hpp"
#include "test_paths.hpp"

namespace cluxel::testing {

using namespace rules;
namespace {

using ::testing::HasSubstr;

std::string shippedText() {
  return readFile(test::sourceFolder() / "rules/outdoor.rules.yaml");
}

/// The quantities with a unit that are not in comments, one in `every`.
std::vector<std::smatch> quantitiesIn(const std::string& text, std::size_t every) {
  const std::regex quantity("[0-9]( (?:m|cm|m2|m3|deg))(?![\\w.])");
  std::vector<std::smatch> found;
  std::size_t number = 0;
  for (std::sregex_iterator at(text.begin(), text.end(), quantity), end; at != end; ++at) {
    const std::size_t begin = text.rfind('\n', static_cast<std::size_t>(at->position())) + 1;
    const bool is_comment = text.find('#', begin) < static_cast<std::size_t>(at->position());
    if (!is_comment && number++ % every == 0) found.push_back(*at);
  }
  return found;
}

TEST(FollowUpFaults, OfOneWrongUnitAnywhereInTheShippedRulesAreNotReported) {
  const std::string text = shippedText();
  const std::vector<std::smatch> quantities = quantitiesIn(text, 13);
  EXPECT_GT(quantities.size(), 15U);
  for (const std::smatch& quantity : quantities)
    for (const std::string& unit : {std::string(" kg"), std::string(quantity[1] == " deg" ? " m" : " deg"), {}}) {
      std::string faulty = text;
      faulty.replace(static_cast<std::size_t>(quantity.position(1)), quantity[1].length(), unit);
      const LoadedRules loaded = loadText(faulty);
      EXPECT_EQ(loaded.diagnostics.size(), 1U) << quantity.str() << " as '" << unit << "'\n"
                                               << format(loaded.diagnostics);
    }
}

TEST(FollowUpFaults, OfAConstantThatDoesNotFitNameItsDefinition) {
  std::string text = shippedText();
  const std::string constant = "bush_top: 1.7 m";
  text.replace(text.find(constant), constant.size(), "bush_top: 1.7");
  const LoadedRules loaded = loadText(text);
  ASSERT_EQ(loaded.diagnostics.size(), 1U) << format(loaded.diagnostics);
  EXPECT_EQ(loaded.diagnostics.front().message, "'$bush_top' is a bare number where a length is expected");
  EXPECT_THAT(loaded.diagnostics.front().hint, HasSubstr("write '1.7 m' in rules.yaml:20:3"));
}

}  // namespace
}  // namespace cluxel::testing
