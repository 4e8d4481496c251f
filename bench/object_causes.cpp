// SPDX-License-Identifier: Apache-2.0
// At which stage true objects are lost: the labels of their points, the primitives made of them, or the rules. Reasons
// anew over the scenes of finished maps, so that any rules can be tried, and counts causes by class, rule and test.
// Usage: object_causes RULES TRUTH MAP...
#include <algorithm>
#include <cstdio>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "cluxel/error.hpp"
#include "mapping/facts/object_geometry.hpp"
#include "mapping/map_inputs.hpp"
#include "mapping/map_reader.hpp"
#include "rules/decide/reason.hpp"
#include "rules/language/rule_loader.hpp"
#include "tasks/evaluation/truth_class.hpp"
#include "tasks/evaluation/truth_source.hpp"

namespace {

using namespace cluxel;
namespace fs = std::filesystem;
using Counts = std::map<std::uint32_t, std::uint64_t>;

/// Labels of which a class's objects can be made, as digits of PrimitiveLabel: the rest is a fault of the labels.
std::string suitableLabels(const std::string& class_name) {
  static const std::map<std::string, std::string> known{{"Ground", "0"}, {"Building", "012"}, {"Tree", "24"},
                                                        {"Bush", "4"},   {"Vehicle", "3"},    {"StreetSign", "123"}};
  const auto found = known.find(class_name);
  return found == known.end() ? "23" : found->second;
}

bool isSuitable(const std::string& class_name, std::uint8_t label) {
  return suitableLabels(class_name).find(static_cast<char>('0' + label)) != std::string::npos;
}

/// A true object.
struct Thing {
  std::size_t class_number = 0;
  std::string kind;
  std::uint64_t points = 0, suitable = 0;
  std::map<std::uint8_t, std::uint64_t> labels;
  Counts objects, primitives;  ///< that share points with it
};

/// A test that rejected true objects, with what it measured.
struct Rejection {
  int count = 0;
  std::vector<double> measured;
  std::string unit;
};

/// One map under the rules: what has how many points with truth.
struct Reasoned {
  const rules::RuleSet* rules = nullptr;
  rules::ReasoningResult result;
  std::vector<std::size_t> class_of;  ///< of the objects
  std::map<std::int32_t, Thing> things;
  Counts points_of_object, points_of_primitive;
  std::map<std::uint32_t, std::map<std::string, std::uint64_t>> kinds_of_object;
  std::map<std::uint32_t, std::map<std::int32_t, std::uint64_t>> things_of_object;
};

class Causes {
 public:
  Causes(const fs::path& rules, const fs::path& truth)
      : rules_file_(rules), truth_(tasks::TruthSource::open(truth, DataHome::find())), classes_(truth_.classes()) {}

  void look(const fs::path& file) {
    const mapping::MapReader map(file);
    const rules::ClassCatalogue catalogue = classCatalogueOf(map.inputs().ontology);
    const rules::RuleSet rules = loadRules(std::vector{rules_file_}, catalogue).require();
    Reasoned reasoned;
    reasoned.rules = &rules;
    reasoned.result = reason(map.scene(), rules);
    reasoned.class_of = truthClassesOf(reasoned.result.objects, classes_, catalogue);
    visitPoints(map, reasoned);
    for (const auto& [instance, thing] : reasoned.things)
      if (!std::binary_search(truth_.ambiguous().begin(), truth_.ambiguous().end(), instance))
        sortThing(thing, reasoned, catalogue);
    for (std::uint32_t object = 0; object < reasoned.result.objects.size(); ++object) sortObject(object, reasoned);
  }

  void print() const {
    std::printf("true objects: all, found, and the causes of the others\n");
    for (const auto& [kind, causes] : causes_) {
      std::string line;
      int sum = 0;
      for (const auto& [cause, count] : causes) sum += count;
      for (const auto& [cause, count] : causes) line += "  " + cause + " " + std::to_string(count);
      std::printf("%-16s %4d%s\n", kind.c_str(), sum, line.c_str());
    }
    printSorted("\nmissed objects in detail", details_, 1);
    std::printf("\ntests of the own class that rejected missed objects (median of what was measured)\n");
    std::vector<std::pair<std::string, Rejection>> sorted(rejections_.begin(), rejections_.end());
    std::stable_sort(sorted.begin(), sorted.end(),
                     [](const auto& a, const auto& b) { return b.second.count < a.second.count; });
    for (auto& [what, rejection] : sorted)
      std::printf("%5d  %s%s\n", rejection.count, what.c_str(), medianOf(rejection).c_str());
    printSorted("\nfound objects without a partner", false_, 1);
    printSorted("\npoints of a wrong class: truth, label, taken by", points_, 200);
  }

 private:
  template <typename Number>
  static void printSorted(const char* title, const std::map<std::string, Number>& counts, int least) {
    std::printf("%s\n", title);
    std::vector<std::pair<std::string, Number>> sorted(counts.begin(), counts.end());
    std::stable_sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return b.second < a.second; });
    for (const auto& [what, count] : sorted)
      if (count >= static_cast<Number>(least)) std::printf("%7lld  %s\n", static_cast<long long>(count), what.c_str());
  }

  static std::string medianOf(Rejection& rejection) {
    if (rejection.measured.empty()) return "";
    const auto middle = rejection.measured.begin() + static_cast<std::ptrdiff_t>(rejection.measured.size() / 2);
    std::nth_element(rejection.measured.begin(), middle, rejection.measured.end());
    char text[64];
    std::snprintf(text, sizeof text, "  (%.3g %s)", *middle, rejection.unit.c_str());
    return text;
  }

  void visitPoints(const mapping::MapReader& map, Reasoned& reasoned) {
    const perception::SceneCluxels& cluxels = map.scene().cluxels;
    const auto object_of = mapping::objectOfCluxel(reasoned.result, cluxels.size());
    std::int32_t first = 0, next = 0;
    for (const mapping::Cloud& cloud : map.clouds()) {
      scan::Scan scan;
      scan.points = map.pointsOf(cloud.id);
      scan.T_map_sensor = cloud.T_map_sensor, scan.has_pose = cloud.has_pose;
      scan.source = cloud.source, scan.id = cloud.id;
      const scan::PointTruth truth = truth_.truthOf(scan);
      const mapping::PointAnswers answers = map.answersFor(cloud);
      if (truth_.countsInstancesByScan()) first = next;
      for (std::size_t i = 0; i < scan.points.size(); ++i) {
        if (truth.object_class[i] < 0) continue;
        const auto class_number = static_cast<std::size_t>(truth.object_class[i]);
        const bool is_ground = classes_.names[class_number] == "Ground";
        const std::int32_t instance = truth.instance[i] < 0 || is_ground ? -1 : first + truth.instance[i];
        if (truth_.countsInstancesByScan()) next = std::max(next, instance + 1);
        std::string kind = scan.points.label.empty() ? "" : truth_.nameOfLabel(scan.points.label[i]);
        if (kind.empty()) kind = classes_.names[class_number];
        const std::uint32_t cluxel = answers.cluxel[i];
        enter(reasoned, {class_number, instance, answers.label[i], object_of[cluxel], cluxels.primitive[cluxel]}, kind);
      }
    }
  }

  struct Point {
    std::size_t class_number;
    std::int32_t instance;
    std::uint8_t label;
    std::uint32_t object, primitive;
  };

  void enter(Reasoned& reasoned, const Point& point, const std::string& kind) {
    const bool is_free = point.object == mapping::kNoObjectOfPoint;
    ++reasoned.points_of_primitive[point.primitive];
    if (!is_free) {
      ++reasoned.points_of_object[point.object];
      ++reasoned.kinds_of_object[point.object][kind];
      ++reasoned.things_of_object[point.object][point.instance];
    }
    if (is_free || reasoned.class_of[point.object] != point.class_number)
      ++points_[kind + ", " + std::string(scan::kPrimitiveLabelNames[point.label]) + ", " +
                (is_free ? "nobody" : reasoned.result.objects[point.object].rule_id)];
    if (point.instance < 0) return;
    Thing& thing = reasoned.things[point.instance];
    thing.class_number = point.class_number;
    if (thing.kind.empty()) thing.kind = kind;
    ++thing.points;
    thing.suitable += isSuitable(classes_.names[point.class_number], point.label) ? 1 : 0;
    ++thing.labels[point.label];
    ++thing.primitives[point.primitive];
    if (!is_free) ++thing.objects[point.object];
  }

  static double iouOf(std::uint64_t shared, std::uint64_t a, std::uint64_t b) {
    return static_cast<double>(shared) / static_cast<double>(a + b - shared);
  }

  /// The primitives that have most of their points in the thing.
  static std::vector<std::uint32_t> ownPrimitives(const Thing& thing, const Reasoned& reasoned) {
    std::vector<std::uint32_t> own;
    for (const auto& [primitive, shared] : thing.primitives)
      if (2 * shared > reasoned.points_of_primitive.at(primitive)) own.push_back(primitive);
    return own;
  }

  void sortThing(const Thing& thing, const Reasoned& reasoned, const rules::ClassCatalogue& catalogue) {
    std::optional<std::uint32_t> partner, largest;
    for (const auto& [object, shared] : thing.objects) {
      if (iouOf(shared, thing.points, reasoned.points_of_object.at(object)) >= 0.5) partner = object;
      if (!largest || shared > thing.objects.at(*largest)) largest = object;
    }
    std::map<std::string, int>& causes = causes_[thing.kind];
    if (partner && reasoned.class_of[*partner] == thing.class_number) {
      ++causes["found"];
      return;
    }
    const std::vector<std::uint32_t> own = ownPrimitives(thing, reasoned);
    std::uint64_t inside = 0, all = 0;
    for (const std::uint32_t primitive : own) {
      inside += thing.primitives.at(primitive);
      all += reasoned.points_of_primitive.at(primitive);
    }
    const bool is_groupable = !own.empty() && iouOf(inside, thing.points, all) >= 0.5;
    const bool is_labelled = 2 * thing.suitable >= thing.points;
    const char* stage = !is_labelled ? "labels" : is_groupable ? "rule" : "primitives";
    ++causes[stage];
    std::string detail = thing.kind + ": " + stage + ", " + takerText(partner, largest, thing, reasoned);
    if (!is_labelled) detail += ", mostly " + mostLabel(thing);
    ++details_[detail];
    if (is_labelled && is_groupable) noteRejections(thing, own, reasoned, catalogue);
  }

  static std::string mostLabel(const Thing& thing) {
    const auto most = std::max_element(thing.labels.begin(), thing.labels.end(),
                                       [](const auto& a, const auto& b) { return a.second < b.second; });
    return std::string(scan::kPrimitiveLabelNames[most->first]);
  }

  static std::string takerText(std::optional<std::uint32_t> partner, std::optional<std::uint32_t> largest,
                               const Thing& thing, const Reasoned& reasoned) {
    if (partner) return "is " + reasoned.result.objects[*partner].rule_id;
    if (!largest || 2 * thing.objects.at(*largest) < thing.points) {
      if (!largest) return "in no object";
      return reasoned.class_of[*largest] == thing.class_number ? "in pieces of its class" : "in pieces or free";
    }
    const std::string& rule = reasoned.result.objects[*largest].rule_id;
    return (reasoned.class_of[*largest] == thing.class_number ? "in a larger one of its class, " : "within ") + rule;
  }

  /// Per rule of the thing's class, the test at which it gave up on the thing's own primitives.
  void noteRejections(const Thing& thing, const std::vector<std::uint32_t>& own, const Reasoned& reasoned,
                      const rules::ClassCatalogue& catalogue) {
    std::map<std::string, const rules::Decision*> last;
    for (const rules::Decision& decision : reasoned.result.decisions)
      if (!decision.accepted && std::find(own.begin(), own.end(), decision.seed) != own.end()) {
        const rules::Rule* rule = reasoned.rules->find(decision.rule_id);
        if (rule == nullptr || classNumber(rule->class_iri, catalogue) != thing.class_number) continue;
        const rules::Decision*& kept = last[decision.rule_id];
        if (kept == nullptr || thing.primitives.at(decision.seed) > thing.primitives.at(kept->seed)) kept = &decision;
      }
    if (last.empty()) ++rejections_[thing.kind + ": no rule of its class looked at it"].count;
    for (const auto& [rule, decision] : last) {
      std::string what = thing.kind + ": " + rule + ": " + decision->reason;
      const rules::DecisionStep* step = lastFailed(*decision);
      if (step) what += " [" + step->test + "]";
      Rejection& rejection = rejections_[what];
      ++rejection.count;
      if (!step || !step->measured) continue;
      rejection.measured.push_back(*step->measured);
      rejection.unit = step->unit;
    }
  }

  static const rules::DecisionStep* lastFailed(const rules::Decision& decision) {
    const auto failed = std::find_if(decision.path.rbegin(), decision.path.rend(),
                                     [](const rules::DecisionStep& step) { return !step.passed; });
    return failed == decision.path.rend() ? nullptr : &*failed;
  }

  std::size_t classNumber(const std::string& iri, const rules::ClassCatalogue& catalogue) const {
    rules::SemanticObject object;
    object.class_iri = iri;
    return truthClassesOf({object}, classes_, catalogue).front();
  }

  void sortObject(std::uint32_t object, const Reasoned& reasoned) {
    const auto points = reasoned.points_of_object.find(object);
    const std::size_t own = reasoned.class_of[object];
    if (points == reasoned.points_of_object.end() || reasoned.things.empty()) return;
    if (own < classes_.names.size() && classes_.names[own] == "Ground") return;
    const auto& things = reasoned.things_of_object.at(object);
    const auto most = std::max_element(things.begin(), things.end(),
                                       [](const auto& a, const auto& b) { return a.second < b.second; });
    if (most->first < 0) return;
    const Thing& thing = reasoned.things.at(most->first);
    const bool is_ambiguous = std::binary_search(truth_.ambiguous().begin(), truth_.ambiguous().end(), most->first);
    const bool is_partner = iouOf(most->second, thing.points, points->second) >= 0.5;
    if (is_ambiguous || (is_partner && thing.class_number == own)) return;
    ++false_[reasoned.result.objects[object].rule_id + ": " + (is_partner ? "is a " : "a piece of, or more than, a ") +
             thing.kind];
  }

  fs::path rules_file_;
  tasks::TruthSource truth_;
  tasks::TruthClasses classes_;
  std::map<std::string, std::map<std::string, int>> causes_;
  std::map<std::string, int> details_, false_;
  std::map<std::string, Rejection> rejections_;
  std::map<std::string, std::uint64_t> points_;
};

}  // namespace

int main(int count, char** words) {
  try {
    if (count < 4) throw Error(ErrorKind::InvalidArgument, "usage: object_causes RULES TRUTH MAP...");
    Causes causes(words[1], words[2]);
    for (int i = 3; i < count; ++i) causes.look(words[i]);
    causes.print();
    return 0;
  } catch (const Error& fault) {
    std::fprintf(stderr, "object_causes: %s\n", fault.what());
    return static_cast<int>(fault.kind());
  }
}
