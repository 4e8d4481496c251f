// SPDX-License-Identifier: Apache-2.0
// Objects that are near each other, against all pairs of cluxels.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "mapping/facts/object_geometry.hpp"

namespace cluxel::mapping {
namespace {

TEST(NearObjects, AreThoseOfAllPairs) {
  std::mt19937 random(8);
  std::uniform_real_distribution<double> place(-9, 9), spread(-1.5, 1.5);
  std::uniform_real_distribution<float> size(0.02F, 0.6F);
  constexpr std::uint32_t kObjects = 50;
  std::size_t found = 0;
  for (const double largest_m : {0.3, 1.0, 2.5}) {
    std::vector<Eigen::Vector3d> middle;
    for (std::uint32_t i = 0; i < kObjects; ++i) middle.emplace_back(place(random), place(random), place(random) / 3);
    perception::SceneCluxels cluxels;
    std::vector<std::uint32_t> object_of;
    for (std::uint32_t c = 0; c < 1200; ++c) {
      const std::uint32_t object = c % (kObjects + 1);
      object_of.push_back(object == kObjects ? kNoObject : object);
      cluxels.extent.emplace_back(size(random), size(random), size(random));
      const Eigen::Vector3d apart(spread(random), spread(random), spread(random));
      cluxels.center.push_back((object == kObjects ? Eigen::Vector3d::Zero().eval() : middle[object]) + apart);
      cluxels.low_corner.push_back(cluxels.center.back() - cluxels.extent.back().cast<double>() / 2);
      cluxels.name.emplace_back();
    }
    std::vector<bool> is_ground(kObjects, false);
    is_ground[7] = true;
    std::set<std::pair<std::uint32_t, std::uint32_t>> expected;
    for (std::uint32_t c = 0; c < object_of.size(); ++c)
      for (std::uint32_t d = 0; d < object_of.size(); ++d) {
        const std::uint32_t a = object_of[c], b = object_of[d];
        if (a >= b || b == kNoObject || is_ground[a] || is_ground[b]) continue;
        const Eigen::Vector3d c_high = cluxels.low_corner[c] + cluxels.extent[c].cast<double>(),
                              d_high = cluxels.low_corner[d] + cluxels.extent[d].cast<double>();
        const Eigen::Vector3d gap =
            (cluxels.low_corner[c] - d_high).cwiseMax(cluxels.low_corner[d] - c_high).cwiseMax(0.0);
        if (gap.norm() <= largest_m) expected.emplace(a, b);
      }
    const auto near = nearObjects(cluxels, object_of, is_ground, largest_m);
    EXPECT_EQ(near, std::vector(expected.begin(), expected.end())) << largest_m;
    found += near.size();
  }
  EXPECT_GT(found, 100U);
  EXPECT_LT(found, 3U * kObjects * (kObjects - 1) / 2);
}

}  // namespace
}  // namespace cluxel::mapping
