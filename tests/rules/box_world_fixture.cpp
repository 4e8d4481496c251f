// SPDX-License-Identifier: Apache-2.0
// The street scene of the reasoning tests.
#include "rules/box_world.hpp"

#include <algorithm>

#include "test_paths.hpp"

namespace cluxel::testing {

using namespace scan;
using namespace perception;
using namespace rules;

BoxScene streetOfBoxes() {
  BoxScene street;
  street.boxes = {
      box("ground", kGroundLabel, {0, 0, 0}, {60, 40, 0.1}),
      box("facade_left", kWall, {-10, 15, 3}, {8, 0.3, 6}),
      box("facade_right", kWall, {-0.5, 15, 3}, {9, 0.3, 6}),
      // Two trees whose crowns touch: one scatter primitive.
      box("trunk_a", kColumn, {-12, 0, 1.2}, {0.35, 0.35, 2.4}),
      box("trunk_b", kColumn, {-6, 0, 1.2}, {0.35, 0.35, 2.4}),
      box("crowns", kScatter, {-9, 0, 4.0}, {9, 4, 3.2}),
      box("misfit", kWall, {-13.0, 2.05, 4.0}, {0.6, 0.1, 0.6}),
      box("lamp_pole", kColumn, {2, 0, 2.2}, {0.15, 0.15, 4.4}),
      box("lamp_head", kSmall, {2.3, 0, 4.6}, {0.8, 0.3, 0.3}),
      box("sign_pole", kColumn, {6, 0, 1.0}, {0.1, 0.1, 2.0}),
      box("sign_plate", kWall, {6, 0, 2.35}, {0.6, 0.05, 0.6}),
      box("mast", kColumn, {10, 0, 4.5}, {0.3, 0.3, 9}),
      box("car_front", kSmall, {14, 0, 0.7}, {1.8, 1.7, 1.3}),
      box("car_back", kSmall, {16.2, 0, 0.7}, {2.0, 1.7, 1.3}),
      box("bush", kScatter, {20, 0, 0.6}, {1.5, 1.5, 1.1}),
      box("bin", kSmall, {24, 0, 0.5}, {0.5, 0.5, 0.9}),
  };
  return street;
}

std::vector<std::string> inWords(const BuiltBoxScene& built, const ReasoningResult& result) {
  std::vector<std::string> words;
  for (const SemanticObject& object : result.objects) {
    std::string text = object.class_iri.substr(object.class_iri.find('#') + 1) + "{";
    for (const ObjectPart& part : object.parts) {
      std::set<std::string> names;
      for (PrimitiveIndex primitive : part.primitives) names.insert(built.names[primitive]);
      text +=
          (&part == &object.parts.front() ? "" : "; ") + part.part_class.substr(part.part_class.find('#') + 1) + ":";
      for (const std::string& name : names) text += " " + name;
    }
    words.push_back(text + "}");
  }
  std::sort(words.begin(), words.end());
  return words;
}

RuleSet outdoorRules() {
  const std::vector<std::filesystem::path> paths{test::sourceFolder() / "rules/outdoor.rules.yaml"};
  LoadedRules loaded = loadRules(paths, outdoorCatalogue());
  EXPECT_TRUE(loaded.diagnostics.empty()) << format(loaded.diagnostics);
  return loaded.rules.value_or(RuleSet{});
}

}  // namespace cluxel::testing
