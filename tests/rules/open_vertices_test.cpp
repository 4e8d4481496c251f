// SPDX-License-Identifier: Apache-2.0
// The queue of open vertices against a search through all of them.
#include "rules/objects/open_vertices.hpp"

#include <gtest/gtest.h>

#include <random>

namespace cluxel::testing {

using namespace rules;
namespace {

TEST(OpenVertices, AreTakenByLengthThenBySourceAndOnlyWithTheirShortestPath) {
  std::mt19937 random(2);
  std::uniform_int_distribution<std::uint32_t> vertex(0, 199), source(0, 2);
  for (const double scale_m : {0.01, 0.3, 400.0}) {
    std::vector<Way> best(200, kNoWay);
    std::vector<bool> is_settled(200, false);
    OpenVertices open;
    Way last{0, 0};
    std::size_t settled = 0;
    const auto offerSome = [&] {  // lengths are multiples, so that many are equal; none is shorter than the last
      for (int i = 0; i < 6; ++i) {
        const std::uint32_t at = vertex(random);
        const Way way{last.length + scale_m * static_cast<double>(random() % 4 + 1), source(random)};
        if (way < best[at]) open.push({best[at] = way, at});
      }
    };
    for (offerSome(); const OpenVertex* next = open.top(best); offerSome()) {
      const std::uint32_t at = next->at;
      EXPECT_EQ(next->way, best[at]);
      for (std::size_t i = 0; i < best.size(); ++i)
        EXPECT_TRUE(is_settled[i] || !(best[i] < next->way)) << "vertex " << i << " is nearer";
      EXPECT_FALSE(next->way < last);
      last = next->way;
      is_settled[at] = true;
      ++settled;
      open.pop();
    }
    for (std::size_t i = 0; i < best.size(); ++i) EXPECT_EQ(is_settled[i], best[i] != kNoWay);
    EXPECT_GT(settled, 150U);
  }
}

}  // namespace
}  // namespace cluxel::testing
