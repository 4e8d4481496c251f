// SPDX-License-Identifier: Apache-2.0
// Claims that are kept from round to round against claims that are found anew in each.
#include <gtest/gtest.h>

#include <random>

#include "rules/box_world.hpp"

namespace cluxel::testing {

using namespace scan;
using namespace perception;
using namespace rules;
namespace {

/// Cores that absorb what is beside them and meets `also`.
RuleSet absorbingRules(const std::string& also) {
  return rulesOf("[clx:SmallObject]", R"(
  - id: small_object/core
    class: clx:SmallObject
    seed: { label: small_structure, as: core }
    tree:
      test: { attribute: height, op: ">=", value: 0.1 m }
      yes:
        accept:
          confidence: 0.9
          absorb:
            from: { label: scatter }
            when: [ { gap_to: core, op: "<=", value: 0.4 m })" +
                                          also + R"( ]
            max_fraction_of_points: 1
      no: { reject: too low }
)");
}

TEST(Absorbing, KeepsTheClaimsThatItWouldFindAgain) {
  const RuleSet keeping = absorbingRules("");
  // Says nothing, but looks at other objects: the claims of each round are found anew.
  const std::string touches = "{ relation: touches, with: { object: clx:SmallObject } }";
  const RuleSet anew = absorbingRules(", { any: [ " + touches + ", { not: " + touches + " } ] }");
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-6, 6), size(0.2, 0.7);
  std::size_t absorbed = 0, chained = 0;
  for (int round = 0; round < 6; ++round) {
    BoxScene scene;
    for (int i = 0; i < 90; ++i) {
      const bool is_core = i < 12;
      const Eigen::Vector3d centre(place(random), place(random), 0.5);
      scene.boxes.push_back(box((is_core ? "core" : "bit") + std::to_string(i), is_core ? kSmall : kScatter, centre,
                                Eigen::Vector3d::Constant(is_core ? 1.2 : size(random))));
    }
    const BuiltBoxScene built = sceneOfBoxes(scene);
    const ReasoningResult kept = reason(built.scene, keeping, {.threads = 2});
    EXPECT_EQ(inWords(built, kept), inWords(built, reason(built.scene, anew)));
    for (const SemanticObject& object : kept.objects) {
      absorbed += object.parts.front().primitives.size() - 1;
      chained += object.parts.front().primitives.size() > 5 ? 1 : 0;
    }
  }
  EXPECT_GT(absorbed, 80U);
  EXPECT_GT(chained, 3U);
}

}  // namespace
}  // namespace cluxel::testing
