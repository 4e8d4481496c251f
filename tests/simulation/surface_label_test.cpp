// SPDX-License-Identifier: Apache-2.0
// The table of surfaces agrees with labels/campus.yaml.
#include "simulation/laser/surface_label.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "scan/truth/truth.hpp"
#include "test_paths.hpp"

namespace cluxel::simulation {

using namespace scan;
namespace {

TEST(SurfaceLabel, TheLabelMapSaysTheSameAsTheTable) {
  const LabelMap map = LabelMap::load(test::sourceFolder() / "labels/campus.yaml");
  EXPECT_EQ(map.entries().size(), surfaceInfos().size());
  for (const SurfaceInfo& info : surfaceInfos()) {
    const LabelMeaning* meaning = map.find(static_cast<std::uint32_t>(info.label));
    ASSERT_NE(meaning, nullptr) << info.name;
    EXPECT_EQ(meaning->name, info.name);
    EXPECT_EQ(meaning->primitive, info.primitive) << info.name;
    EXPECT_EQ(meaning->object_class.value_or(""), info.object_class) << info.name;
    EXPECT_EQ(meaning->part.value_or(""), info.part) << info.name;
    EXPECT_FALSE(meaning->near) << info.name;
  }
}

TEST(SurfaceLabel, IdsAscendAndClassesHaveTheirNumberInTruthFiles) {
  const auto surfaces = surfaceInfos();
  EXPECT_TRUE(
      std::is_sorted(surfaces.begin(), surfaces.end(), [](const auto& a, const auto& b) { return a.label < b.label; }));
  for (const SurfaceInfo& info : surfaces) {
    if (info.object_class.empty())
      EXPECT_EQ(info.object_number, -1);
    else
      EXPECT_EQ(truthClassNames().at(static_cast<std::size_t>(info.object_number)), info.object_class);
  }
}

}  // namespace
}  // namespace cluxel::simulation
