// SPDX-License-Identifier: Apache-2.0
// "Did you mean" helps with slips and keeps quiet otherwise.
#include "base/nearest_name.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace cluxel {
namespace {

const std::vector<std::string> kNames{"horizontal_plane", "vertical_plane", "column", "scatter"};

TEST(EditDistance, CountsSlips) {
  EXPECT_EQ(editDistance("", ""), 0U);
  EXPECT_EQ(editDistance("abc", ""), 3U);
  EXPECT_EQ(editDistance("column", "colum"), 1U);
  EXPECT_EQ(editDistance("column", "colunm"), 1U);
  EXPECT_EQ(editDistance("kitten", "sitting"), 3U);
}

TEST(EditDistance, IsSymmetricAndBoundedByTheLongerWord) {
  std::mt19937 random(3);
  for (int i = 0; i < 500; ++i) {
    const auto word = [&] {
      std::string text(random() % 8, 'a');
      for (char& c : text) c = static_cast<char>('a' + random() % 3);
      return text;
    };
    const std::string a = word(), b = word();
    const std::size_t distance = editDistance(a, b);
    EXPECT_EQ(distance, editDistance(b, a)) << a << ' ' << b;
    EXPECT_LE(distance, std::max(a.size(), b.size()));
    EXPECT_EQ(distance == 0, a == b);
  }
}

TEST(NearestName, FindsSlipsWhateverTheCase) {
  EXPECT_EQ(nearestName("Colunm", kNames), "column");
  EXPECT_EQ(nearestName("vertical_plan", kNames), "vertical_plane");
  EXPECT_EQ(nearestName("tree", kNames), std::nullopt);
  EXPECT_EQ(nearestName("tree", {}), std::nullopt);
}

TEST(NearestName, GivesTiesToTheFirst) {
  const std::vector<std::string> names{"bat", "cat"};
  EXPECT_EQ(nearestName("rat", names), "bat");
}

TEST(Suggestion, ListsWhatIsKnownWhenNothingIsNear) {
  EXPECT_EQ(suggestion("scater", kNames), "did you mean 'scatter'?");
  EXPECT_EQ(suggestion("tree", kNames), "known: horizontal_plane, vertical_plane, column, scatter");
  EXPECT_EQ(suggestion("tree", std::vector<std::string>(17, "something")), "");
}

}  // namespace
}  // namespace cluxel
