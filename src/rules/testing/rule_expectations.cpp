// SPDX-License-Identifier: Apache-2.0
// Compares the result of reasoning with the expectations of a test.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "base/file_bytes.hpp"
#include "base/json/json_fault.hpp"
#include "rules/propose/condition_eval.hpp"
#include "rules/testing/rule_test_file.hpp"

namespace cluxel::rules {

namespace {

struct Bounds {
  Eigen::Vector3d min, max;
};

Bounds boundsOf(const SemanticObject& object, const perception::Scene& scene) {
  Bounds bounds{Eigen::Vector3d::Constant(1e300), Eigen::Vector3d::Constant(-1e300)};
  for (const ObjectPart& part : object.parts)
    for (std::uint32_t cluxel : part.cluxels) {
      const Eigen::Vector3d half = scene.cluxels.extent[cluxel].cast<double>() / 2;
      bounds.min = bounds.min.cwiseMin(scene.cluxels.center[cluxel] - half);
      bounds.max = bounds.max.cwiseMax(scene.cluxels.center[cluxel] + half);
    }
  return bounds;
}

class Checking {
 public:
  Checking(const RuleSet& rules, const perception::Scene& scene, const std::vector<std::string>& names,
           const ReasoningResult& result)
      : rules_(rules), scene_(scene), names_(names), result_(result) {}

  std::vector<std::string> check(const Expectation& expect) {
    matchObjects(expect.objects);
    for (std::size_t i = 0; i < expect.objects.size(); ++i) checkObject(expect.objects[i], i);
    if (expect.exactly) checkNoOther(expect.objects.size());
    for (const std::string& iri : expect.absent)
      if (countOf(iri) > 0) fail(rules_.shorten(iri) + " must not come out, but did: " + describeObjects(iri));
    for (const auto& [iri, count] : expect.count)
      if (countOf(iri) != count)
        fail("expected " + std::to_string(count) + " " + rules_.shorten(iri) + ", but " + std::to_string(countOf(iri)) +
             " came out");
    for (const ExpectedReason& reason : expect.reasons) checkReason(reason);
    if (expect.golden) checkGolden(*expect.golden);
    return std::move(failures_);
  }

 private:
  void fail(std::string text) { failures_.push_back(std::move(text)); }

  std::size_t countOf(const std::string& iri) const {
    return static_cast<std::size_t>(
        std::count_if(result_.objects.begin(), result_.objects.end(),
                      [&](const SemanticObject& object) { return rules_.catalogue.isA(object.class_iri, iri); }));
  }

  std::set<std::string> namesOf(const SemanticObject& object, const std::string& part_class) const {
    std::set<std::string> found;
    for (const ObjectPart& part : object.parts)
      if (part_class.empty() || part.part_class == part_class)
        for (perception::PrimitiveIndex primitive : part.primitives) found.insert(nameOfPrimitive(primitive));
    return found;
  }
  std::string nameOfPrimitive(perception::PrimitiveIndex primitive) const {
    return primitive < names_.size() ? names_[primitive] : scene_.primitives[primitive].id.hex();
  }

  std::string describeObject(const SemanticObject& object) const {
    std::string text = rules_.shorten(object.class_iri) + " {";
    for (const ObjectPart& part : object.parts) {
      text += " " + rules_.shorten(part.part_class) + ":";
      for (const std::string& name : namesOf(object, part.part_class)) text += " " + name;
    }
    return text + " } by " + object.rule_id;
  }
  std::string describeObjects(const std::string& iri) const {
    std::string text;
    for (const SemanticObject& object : result_.objects)
      if (iri.empty() || rules_.catalogue.isA(object.class_iri, iri))
        text += (text.empty() ? "" : "; ") + describeObject(object);
    return text.empty() ? "nothing" : text;
  }

  bool fits(const SemanticObject& object, const ExpectedObject& expected) const {
    if (object.class_iri != expected.class_iri) return false;
    for (const auto& [part, names] : expected.parts)
      if (namesOf(object, part) != std::set<std::string>(names.begin(), names.end())) return false;
    // A part that the test does not name is unexpected.
    if (!expected.parts.empty() && expected.parts.count("") == 0)
      for (const ObjectPart& part : object.parts)
        if (expected.parts.count(part.part_class) == 0) return false;
    return true;
  }

  /// Maximum bipartite matching of expected and actual objects, by augmenting paths.
  void matchObjects(const std::vector<ExpectedObject>& expected) {
    expected_of_.assign(result_.objects.size(), kNone);
    object_of_.assign(expected.size(), kNone);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      std::vector<bool> tried(result_.objects.size(), false);
      findObject(expected, i, tried);
    }
  }
  bool findObject(const std::vector<ExpectedObject>& expected, std::size_t number, std::vector<bool>& tried) {
    for (std::size_t object = 0; object < tried.size(); ++object) {
      if (tried[object] || !fits(result_.objects[object], expected[number])) continue;
      tried[object] = true;
      if (expected_of_[object] != kNone && !findObject(expected, expected_of_[object], tried)) continue;
      expected_of_[object] = number;
      object_of_[number] = object;
      return true;
    }
    return false;
  }

  void checkObject(const ExpectedObject& expected, std::size_t number) {
    const std::string place = "line " + std::to_string(expected.at.line) + ": ";
    if (object_of_[number] == kNone)
      return fail(place + "expected " + describeExpected(expected) + "; there is " + describeObjects("") +
                  whyNot(expected));
    const SemanticObject* object = &result_.objects[object_of_[number]];
    Condition bound;
    if (expected.confidence_is) {
      bound.comparison = *expected.confidence_is;
      if (!compare(bound, object->confidence, expected.confidence))
        fail(place + "confidence " + std::to_string(object->confidence) + " is not " +
             std::string(symbolOf(bound.comparison)) + " " + std::to_string(expected.confidence));
    }
    if (!expected.rule_id.empty() && object->rule_id != expected.rule_id)
      fail(place + "made by rule " + object->rule_id + " instead of " + expected.rule_id);
  }

  std::string describeExpected(const ExpectedObject& expected) const {
    std::string text = rules_.shorten(expected.class_iri) + " {";
    for (const auto& [part, names] : expected.parts) {
      text += " " + (part.empty() ? std::string("of") : rules_.shorten(part)) + ":";
      for (const std::string& name : names) text += " " + name;
    }
    return text + " }";
  }

  /// The reasons for which rules of the expected class rejected the named primitives.
  std::string whyNot(const ExpectedObject& expected) const {
    std::string text;
    for (const Decision& decision : result_.decisions) {
      const Rule* rule = rules_.find(decision.rule_id);
      if (decision.accepted || rule == nullptr || rule->class_iri != expected.class_iri) continue;
      for (const auto& [part, names] : expected.parts)
        if (std::find(names.begin(), names.end(), nameOfPrimitive(decision.seed)) != names.end())
          text += "; " + decision.rule_id + " rejected " + nameOfPrimitive(decision.seed) + ": " + decision.reason;
    }
    return text;
  }

  void checkNoOther(std::size_t expected) {
    if (result_.objects.size() != expected)
      fail("expected exactly " + std::to_string(expected) + " objects; there is " + describeObjects(""));
  }

  void checkReason(const ExpectedReason& expected) {
    std::string seen;
    for (const Decision& decision : result_.decisions) {
      if (decision.rule_id != expected.rule_id) continue;
      const bool about =
          std::any_of(decision.seeds.begin(), decision.seeds.end(),
                      [&](perception::PrimitiveIndex seed) { return nameOfPrimitive(seed) == expected.primitive; });
      if (!about) continue;
      if (decision.reason == expected.reason && !decision.accepted) return;
      seen += (seen.empty() ? "" : "; ") + std::string(decision.accepted ? "accepted as " : "") + decision.reason;
    }
    fail("line " + std::to_string(expected.at.line) + ": expected " + expected.rule_id + " to reject " +
         expected.primitive + " with '" + expected.reason +
         "', but it said: " + (seen.empty() ? "nothing, it was not asked" : seen));
  }

  /// Boxes padded by 0.1 m, because thin signs have no volume.
  static double overlap(Bounds a, Bounds b) {
    const Eigen::Vector3d pad = Eigen::Vector3d::Constant(0.1);
    const Eigen::Vector3d both = (a.max.cwiseMin(b.max) - a.min.cwiseMax(b.min) + 2 * pad).cwiseMax(0);
    const double shared = both.prod();
    return shared / ((a.max - a.min + 2 * pad).prod() + (b.max - b.min + 2 * pad).prod() - shared);
  }

  void checkGolden(const GoldenObjects& golden) {
    const nlohmann::json expected = goldenObjects(golden.file);
    // A golden file holds all objects of the scene, so that each one that comes out beside them is false.
    std::vector<bool> used(result_.objects.size(), false);
    std::size_t matched = 0;
    for (const auto& object : expected) matched += matchGolden(object, golden.iou, used) ? 1 : 0;
    const auto shareOf = [&](std::size_t all) {
      return all == 0 ? 1.0 : static_cast<double>(matched) / static_cast<double>(all);
    };
    const double precision = shareOf(result_.objects.size()), recall = shareOf(expected.size());
    if (precision < golden.min_precision)
      fail("precision " + std::to_string(precision) + " is below " + std::to_string(golden.min_precision) +
           "; these are no golden objects: " + countsOfUnused(used));
    if (recall < golden.min_recall)
      fail("recall " + std::to_string(recall) + " is below " + std::to_string(golden.min_recall));
  }

  static nlohmann::json goldenObjects(const std::filesystem::path& file) {
    const std::string text = readFile(file);
    const auto refuse = [&](SourceLocation at, const std::string& what) {
      at.file = file.string();
      throw InputError(at, "not a file of golden objects: " + what,
                       "{\"objects\": [{\"class\": \"clx:Tree\", \"min\": [x, y, z], \"max\": [x, y, z]}]}");
    };
    nlohmann::json objects;
    std::size_t number = 0;
    try {
      objects = nlohmann::json::parse(text).at("objects");
      if (!objects.is_array()) refuse({}, "'objects' is not a list");
      for (const auto& object : objects) {
        ++number;
        (void)object.at("class").get<std::string>();
        readBounds(object);
      }
    } catch (const nlohmann::json::parse_error& fault) {
      refuse(locate(file.string(), text, fault.byte == 0 ? 0 : fault.byte - 1), "it is no JSON");
    } catch (const nlohmann::json::exception& fault) {
      refuse({}, (number > 0 ? "object " + std::to_string(number) + ": " : "") + plainFault(fault));
    }
    return objects;
  }

  /// "931 clx:Bench, 2 clx:Tree".
  std::string countsOfUnused(const std::vector<bool>& used) const {
    std::map<std::string, std::size_t> counts;
    for (std::size_t i = 0; i < used.size(); ++i)
      if (!used[i]) ++counts[rules_.shorten(result_.objects[i].class_iri)];
    std::string text;
    for (const auto& [name, count] : counts) text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + name;
    return text;
  }

  static Bounds readBounds(const nlohmann::json& object) {
    Bounds bounds{};
    for (std::size_t i = 0; i < 3; ++i) {
      bounds.min[static_cast<Eigen::Index>(i)] = object.at("min").at(i).get<double>();
      bounds.max[static_cast<Eigen::Index>(i)] = object.at("max").at(i).get<double>();
    }
    return bounds;
  }

  bool matchGolden(const nlohmann::json& object, double iou, std::vector<bool>& used) const {
    std::size_t best = used.size();
    double best_overlap = iou;
    for (std::size_t i = 0; i < used.size(); ++i) {
      if (used[i] || rules_.shorten(result_.objects[i].class_iri) != object.at("class").get<std::string>()) continue;
      const double mine = overlap(boundsOf(result_.objects[i], scene_), readBounds(object));
      if (mine < best_overlap) continue;
      best_overlap = mine;
      best = i;
    }
    if (best == used.size()) return false;
    used[best] = true;
    return true;
  }

  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

  const RuleSet& rules_;
  const perception::Scene& scene_;
  const std::vector<std::string>& names_;
  const ReasoningResult& result_;
  std::vector<std::size_t> expected_of_, object_of_;  ///< number of the partner, or kNone
  std::vector<std::string> failures_;
};

}  // namespace

std::vector<std::string> unmetExpectations(const Expectation& expect, const RuleSet& rules,
                                           const perception::Scene& scene, const std::vector<std::string>& names,
                                           const ReasoningResult& result) {
  return Checking(rules, scene, names, result).check(expect);
}

std::string goldenText(const RuleSet& rules, const perception::Scene& scene, const ReasoningResult& result) {
  nlohmann::ordered_json json{{"objects", nlohmann::ordered_json::array()}};
  const auto corner = [](const Eigen::Vector3d& p) {
    nlohmann::ordered_json numbers = nlohmann::ordered_json::array();
    for (const double value : {p.x(), p.y(), p.z()}) numbers.push_back(std::round(value * 1000) / 1000);
    return numbers;
  };
  for (const SemanticObject& object : result.objects) {
    const Bounds bounds = boundsOf(object, scene);
    json["objects"].push_back(
        {{"class", rules.shorten(object.class_iri)}, {"min", corner(bounds.min)}, {"max", corner(bounds.max)}});
  }
  return json.dump(1) + "\n";
}

}  // namespace cluxel::rules
