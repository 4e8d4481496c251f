// SPDX-License-Identifier: Apache-2.0
// Height slices: against a plain count over cluxels, in explanations, and when the slice is empty.
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstdio>
#include <random>

#include "rules/box_world.hpp"
#include "rules/explain/explain.hpp"

namespace cluxel::testing {

using namespace scan;
using namespace perception;
using namespace rules;
namespace {

/// One rule that makes every column an object when `test` holds.
RuleSet rulesWith(const std::string& test, const std::string& group = "") {
  return rulesOf("[clx:UtilityPole]",
                 "  - id: pole/tested\n    class: clx:UtilityPole\n    seed: { label: column, as: pole }\n" + group +
                     "    tree:\n      test: " + test +
                     "\n      yes: { accept: { part: clx:PoleMast, confidence: 0.8 } }\n"
                     "      no: { reject: no }\n");
}

std::string metres(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.4f m", value);
  return text.data();
}

std::vector<std::uint32_t> cluxelsBetween(const Scene& scene, PrimitiveIndex primitive, double from_m, double to_m) {
  std::vector<std::uint32_t> found;
  for (const std::uint32_t cluxel : scene.primitives[primitive].cluxels) {
    const auto height = static_cast<double>(scene.cluxels.height_above_ground[cluxel]);
    if (from_m <= height && height <= to_m) found.push_back(cluxel);
  }
  return found;
}

struct ByHand {
  double bottom = 1e9, top = -1e9, points = 0, area = 1e9;  ///< the area of the smallest upright box [m2]
};

ByHand measuredByHand(const SceneCluxels& all, const std::vector<std::uint32_t>& cluxels) {
  ByHand hand;
  std::vector<Eigen::Vector2d> corners;
  for (const std::uint32_t cluxel : cluxels) {
    const Eigen::Vector3d half = all.extent[cluxel].cast<double>() / 2;
    const auto height = static_cast<double>(all.height_above_ground[cluxel]);
    hand.bottom = std::min(hand.bottom, height - half.z());
    hand.top = std::max(hand.top, height + half.z());
    hand.points += std::max<double>(1, all.point_count[cluxel]);
    for (const double x : {-1.0, 1.0})
      for (const double y : {-1.0, 1.0})
        corners.emplace_back(all.center[cluxel].x() + x * half.x(), all.center[cluxel].y() + y * half.y());
  }
  // The smallest box has a side along an edge of the hull, and every edge joins two corners.
  for (const Eigen::Vector2d& a : corners)
    for (const Eigen::Vector2d& b : corners) {
      if ((b - a).norm() < 1e-6) continue;
      const Eigen::Vector2d u = (b - a).normalized(), v(-u.y(), u.x());
      Eigen::AlignedBox<double, 2> around;
      for (const Eigen::Vector2d& p : corners) around.extend(Eigen::Vector2d(p.dot(u), p.dot(v)));
      hand.area = std::min(hand.area, around.volume());
    }
  return hand;
}

const DecisionStep& firstStep(const ReasoningResult& result) {
  return result.decisions.at(0).path.at(0);
}

TEST(SliceTests, MeasureWhatAPlainCountOverTheCluxelsDoes) {
  std::mt19937 random(20261121);
  auto between = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random() % 10000) / 9999;
  };
  int empty = 0, whole = 0, part = 0;
  for (int round = 0; round < 60; ++round) {
    BoxScene world;
    const double height = between(0.4, 5), bottom = between(0, 1.5);
    world.boxes = {box("p", kColumn, {between(-3, 3), between(-3, 3), bottom + height / 2},
                       {between(0.1, 0.9), between(0.1, 0.5), height})};
    world.boxes[0].yaw_rad = between(0, 3);
    const BuiltBoxScene built = sceneOfBoxes(world);
    const double from = between(0, 4), to = from + between(0.05, 5);
    const std::string slice = "{ slice: { from: " + metres(from) + ", to: " + metres(to) + " }, attribute: ";
    const auto inside = cluxelsBetween(built.scene, 0, std::stod(metres(from)), std::stod(metres(to)));
    auto measured = [&](const std::string& attribute, const std::string& minimum) {
      const ReasoningResult result =
          reason(built.scene, rulesWith(slice + attribute + ", op: \">=\", value: " + minimum + " }"));
      const DecisionStep step = firstStep(result);
      EXPECT_EQ(step.passed, step.measured && *step.measured >= *step.threshold);
      EXPECT_EQ(result.objects.size(), step.passed ? 1U : 0U);
      return step.measured;
    };
    if (inside.empty()) {
      ++empty;
      EXPECT_FALSE(measured("height", "0 m").has_value()) << "not even what is always true of what is there";
      continue;
    }
    const Primitive& primitive = built.scene.primitives[0];
    if (inside.size() == primitive.cluxels.size()) {  // taken from perception, which measures points and not cluxels
      ++whole;
      EXPECT_EQ(measured("volume", "0.2 m3"), primitive[Attribute::Volume]);
      EXPECT_EQ(measured("roughness", "0.1 m"), primitive[Attribute::Roughness]);
      continue;
    }
    ++part;
    const ByHand hand = measuredByHand(built.scene.cluxels, inside);
    EXPECT_NEAR(measured("bottom", "0.7 m").value(), hand.bottom, 1e-5);
    EXPECT_NEAR(measured("top", "2 m").value(), hand.top, 1e-5);
    EXPECT_NEAR(measured("point_count", "30").value(), hand.points, 1e-9);
    EXPECT_NEAR(measured("volume", "0.2 m3").value(), hand.area * (hand.top - hand.bottom), 1e-4);
    EXPECT_EQ(measured("cluxel_count", "4").value(), static_cast<double>(inside.size()));
  }
  EXPECT_GT(empty, 3);
  EXPECT_GT(whole, 3);
  EXPECT_GT(part, 20);
}

/// A plate on a pole that were labelled as one primitive, made of two boxes.
BuiltBoxScene sign(double plate_width_m) {
  BoxScene world;
  world.boxes = {box("pole", kColumn, {0, 0, 0.7}, {0.1, 0.1, 1.4}),
                 box("plate", kColumn, {0, 0, 1.9}, {plate_width_m, 0.1, 1.0})};
  return sceneOfBoxes(world);
}

constexpr const char* kWiderAbove =
    "{ slice: { from: 1.5 m, to: 3 m }, attribute: horizontal_extent, op: \">=\", ratio: 2, to: { slice: { from: 0 m, "
    "to: 1.2 m }, "
    "attribute: horizontal_extent } }";

TEST(SliceTests, CompareTheUpperPartOfAGroupWithItsFoot) {
  const RuleSet rules = rulesWith(kWiderAbove, "    group: { near: 0.3 m }\n");
  const Explanation wide = explain(sign(0.6).scene, rules, {}, 0);
  EXPECT_TRUE(wide.object.has_value());
  const DecisionStep& step = wide.decisions.at(0).decision.path.at(0);
  EXPECT_EQ(step.test,
            "horizontal_extent of pole from 1.5 m to 3 m >= 2 x horizontal_extent of pole from 0 m to 1.2 m");
  EXPECT_NEAR(step.measured.value(), 0.6, 1e-6);
  EXPECT_NEAR(step.threshold.value(), 0.2, 1e-6);
  const Explanation narrow = explain(sign(0.15).scene, rules, {}, 0);
  EXPECT_FALSE(narrow.object.has_value());
  ASSERT_TRUE(narrow.decisions.at(0).counterfactual.has_value());
  EXPECT_NEAR(narrow.decisions[0].counterfactual->changes.at(0).margin, 0.05, 1e-6);
}

TEST(SliceTests, OfNothingNoTestHoldsAndItsDenialDoes) {
  const BuiltBoxScene built = sign(0.6);
  for (const char* op : {"<=", ">", "!="}) {
    const std::string test =
        std::string("{ slice: { from: 5 m, to: 6 m }, attribute: height, op: \"") + op + "\", value: 1 m }";
    EXPECT_TRUE(reason(built.scene, rulesWith(test)).objects.empty()) << op;
    EXPECT_EQ(reason(built.scene, rulesWith("{ not: " + test + " }")).objects.size(), 2U) << op;
  }
  const std::string ratio =
      "{ attribute: height, op: \">\", ratio: 0, to: { slice: { from: 5 m, to: 6 m }, attribute: height } }";
  EXPECT_TRUE(reason(built.scene, rulesWith(ratio)).objects.empty());
}

TEST(SliceTests, TellNothingAboutOtherSlicesNorByFailingAtFirst) {
  const auto nested = [](const std::string& inner_slice, const std::string& first_branch, const std::string& op) {
    const std::string tree =
        "    tree:\n      test: { slice: { from: 0 m, to: 1 m }, attribute: width, op: \">=\", value: 1 m }\n      " +
        first_branch + ":\n        test: { " + inner_slice + "attribute: width, op: \"" + op +
        "\", value: 0.5 m }\n        yes: { reject: a }\n"
        "        no: { reject: b }\n      " +
        (first_branch == "yes" ? "no" : "yes") + ": { accept: { part: clx:PoleMast, confidence: 0.8 } }\n";
    return loadText(
        "apiVersion: cluxel.rules/v1\nprefixes: { clx: \"https://w3id.org/cluxel/ontology#\" }\norder: "
        "[clx:UtilityPole]\nrules:\n"
        "  - id: pole/tested\n    class: clx:UtilityPole\n    seed: { label: column, as: pole }\n" +
        tree);
  };
  const std::string same = "slice: { from: 0 m, to: 1 m }, ", other = "slice: { from: 0 m, to: 2 m }, ";
  EXPECT_FALSE(nested(same, "yes", "<").rules.has_value()) << "wider than 1 m, then narrower than 0.5 m";
  EXPECT_TRUE(nested(other, "yes", "<").rules.has_value()) << "another slice";
  EXPECT_TRUE(nested("", "yes", "<").rules.has_value()) << "the whole";
  EXPECT_TRUE(nested(same, "no", "<").rules.has_value());
  EXPECT_FALSE(nested(same, "yes", ">").rules.has_value()) << "something is there: it cannot fail";
}

}  // namespace
}  // namespace cluxel::testing
