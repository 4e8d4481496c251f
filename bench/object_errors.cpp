// SPDX-License-Identifier: Apache-2.0
// Why objects are missed or wrong: reasons anew over the scenes of finished maps, with any rules, and sorts every true
// object that has no partner, and every found one that has none, by cause. Used to improve rules.
// Usage: object_errors [-v] [--ontology FOLDER] RULES TRUTH MAP... [TRUTH=MAP]...
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "mapping/facts/object_geometry.hpp"
#include "mapping/map_inputs.hpp"
#include "mapping/map_reader.hpp"
#include "rules/decide/reason.hpp"
#include "rules/language/rule_loader.hpp"
#include "scan/truth/truth.hpp"
#include "tasks/evaluation/object_matching.hpp"
#include "tasks/evaluation/truth_class.hpp"
#include "tasks/evaluation/truth_source.hpp"

namespace {

using namespace cluxel;
namespace fs = std::filesystem;

struct Options {
  bool each = false;
  fs::path ontology, rules, truth;
  std::vector<fs::path> maps;
};

Options optionsOf(int count, char** words) {
  Options options;
  std::vector<std::string> rest;
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    if (word == "-v")
      options.each = true;
    else if (word == "--ontology" && i + 1 < count)
      options.ontology = words[++i];
    else
      rest.push_back(word);
  }
  if (rest.size() < 3)
    throw Error(ErrorKind::InvalidArgument, "usage: object_errors [-v] [--ontology FOLDER] RULES TRUTH MAP...");
  options.rules = rest[0], options.truth = rest[1];
  options.maps.assign(rest.begin() + 2, rest.end());
  return options;
}

/// True or found objects as sets of points, and how many points each pair shares.
struct Overlap {
  struct Truth {
    std::size_t class_number = 0;
    std::uint64_t points = 0, rightly_labelled = 0;
    bool counts = true;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    Eigen::AlignedBox3d box;
  };
  struct Found {
    std::uint64_t points = 0;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    Eigen::AlignedBox3d box;
    std::map<std::size_t, std::uint64_t> of_class;  ///< true classes of its points
  };
  std::map<std::int32_t, Truth> truths;
  std::vector<Found> found;
  std::map<std::int32_t, std::map<std::uint32_t, std::uint64_t>> shared;  ///< instance → object → points
  std::map<std::uint32_t, std::map<std::int32_t, std::uint64_t>> back;
};

class Errors {
 public:
  explicit Errors(const Options& options) : options_(options) {
    open(options.truth);
    names_ = truth_->classNames();
  }

  void look(const fs::path& given) {
    const std::string text = given.string();
    const std::size_t cut = text.find('=');
    if (cut != std::string::npos) open(text.substr(0, cut));
    const mapping::MapReader map(cut == std::string::npos ? text : text.substr(cut + 1));
    std::vector<mapping::NamedText> ontology = map.inputs().ontology;
    if (!options_.ontology.empty()) {
      ontology.clear();
      for (const char* name : {"core.ttl", "outdoor.ttl"})
        ontology.push_back({name, readFile(options_.ontology / name)});
    }
    const rules::ClassCatalogue catalogue = classCatalogueOf(ontology);
    const rules::RuleSet rules = loadRules(std::vector{options_.rules}, catalogue).require();
    const auto begin = std::chrono::steady_clock::now();
    const rules::ReasoningResult result = reason(map.scene(), rules);
    seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    class_of_ = truthClassesOf(result.objects, truth_->classes(), catalogue);
    tasks::ObjectMatching matching(names_, class_of_, truth_->ambiguous());
    const Overlap overlap = overlapOf(map, result, matching);
    add(matching.scoreByPoints({}), by_points_);
    add(matching.scoreByBox({}), by_box_);
    sortTruths(overlap, result);
    sortFound(overlap, result);
  }

  void print() const {
    std::printf("%-14s %6s %6s | %5s %5s %5s | boxes %5s %5s %5s\n", "class", "truth", "found", "P", "R", "F1", "P",
                "R", "F1");
    tasks::ObjectScore all{"all", 0, 0, 0, 0}, all_box = all;
    for (std::size_t i = 0; i < by_points_.size(); ++i) {
      if (by_points_[i].truth + by_points_[i].answers == 0) continue;
      printRow(by_points_[i], by_box_[i]);
      add({by_points_[i]}, all);
      add({by_box_[i]}, all_box);
    }
    printRow(all, all_box);
    double right = 0, total = 0;
    for (const auto& [pair, count] : by_class_) total += count, right += pair.first == pair.second ? count : 0;
    std::printf("objects by point: overall %.4f; reasoning %.2f s\n", right / total, seconds_);
    std::printf("\ntrue objects without a partner\n");
    for (const auto& [what, count] : missed_) std::printf("%5d  %s\n", count, what.c_str());
    std::printf("\nsides of partners' boxes\n");
    for (const auto& [what, count] : sides_) std::printf("%5d  %s\n", count, what.c_str());
    std::printf("\nfound objects without a partner\n");
    for (const auto& [what, count] : wrong_) std::printf("%5d  %s\n", count, what.c_str());
  }

 private:
  void open(const fs::path& truth) { truth_.emplace(tasks::TruthSource::open(truth, DataHome::find())); }

  static void add(const std::vector<tasks::ObjectScore>& scores, std::vector<tasks::ObjectScore>& sums) {
    sums.resize(scores.size());
    for (std::size_t i = 0; i < scores.size(); ++i) sums[i].name = scores[i].name, add({scores[i]}, sums[i]);
  }
  static void add(const tasks::ObjectScore& score, tasks::ObjectScore& sum) {
    sum.truth += score.truth, sum.answers += score.answers;
    sum.matched_truth += score.matched_truth, sum.matched_answers += score.matched_answers;
  }
  static void printRow(const tasks::ObjectScore& points, const tasks::ObjectScore& box) {
    std::printf("%-14s %6llu %6llu | %.3f %.3f %.3f |       %.3f %.3f %.3f\n", points.name.c_str(),
                static_cast<unsigned long long>(points.truth), static_cast<unsigned long long>(points.answers),
                points.precision(), points.recall(), points.f1(), box.precision(), box.recall(), box.f1());
  }

  Overlap overlapOf(const mapping::MapReader& map, const rules::ReasoningResult& result,
                    tasks::ObjectMatching& matching) {
    Overlap overlap;
    overlap.found.resize(result.objects.size());
    const perception::Scene& scene = map.scene();
    const auto object_of = mapping::objectOfCluxel(result, scene.cluxels.size());
    const std::size_t ground = classNumber("Ground");
    for (const mapping::Cloud& cloud : map.clouds()) {
      scan::Scan scan;
      scan.points = map.pointsOf(cloud.id);
      scan.T_map_sensor = cloud.T_map_sensor, scan.has_pose = cloud.has_pose;
      scan.source = cloud.source, scan.id = cloud.id;
      const scan::PointTruth truth = truth_->truthOf(scan);
      const mapping::PointAnswers answers = map.answersFor(cloud);
      for (std::size_t i = 0; i < scan.points.size(); ++i) {
        if (truth.object_class[i] < 0) continue;
        const auto of_class = static_cast<std::size_t>(truth.object_class[i]);
        const std::int32_t instance = truth.instance.empty() || of_class == ground ? -1 : truth.instance[i];
        const std::uint32_t object = object_of[answers.cluxel[i]];
        const Eigen::Vector3d p =
            scan::toMap(scan.T_map_sensor, Eigen::Vector3f(scan.points.x[i], scan.points.y[i], scan.points.z[i]));
        matching.add(p, of_class, instance, object);
        const bool right = truth.primitive[i] == static_cast<int>(answers.label[i]);
        note(overlap, p, of_class, instance, object, right);
        ++by_class_[{of_class, object == mapping::kNoObjectOfPoint ? names_.size() : class_of_[object]}];
      }
    }
    return overlap;
  }

  void note(Overlap& overlap, const Eigen::Vector3d& p, std::size_t of_class, std::int32_t instance,
            std::uint32_t object, bool right) const {
    if (instance >= 0) {
      Overlap::Truth& truth = overlap.truths[instance];
      truth.class_number = of_class;
      truth.counts = !std::binary_search(truth_->ambiguous().begin(), truth_->ambiguous().end(), instance);
      ++truth.points;
      truth.rightly_labelled += right ? 1 : 0;
      truth.sum += p;
      truth.box.extend(p);
      ++overlap.shared[instance][object];
    }
    if (object == mapping::kNoObjectOfPoint) return;
    Overlap::Found& found = overlap.found[object];
    ++found.points;
    found.sum += p;
    found.box.extend(p);
    ++found.of_class[of_class];
    ++overlap.back[object][instance];
  }

  std::size_t classNumber(const std::string& name) const {
    return static_cast<std::size_t>(std::find(names_.begin(), names_.end(), name) - names_.begin());
  }

  void sortTruths(const Overlap& overlap, const rules::ReasoningResult& result) {
    for (const auto& [instance, truth] : overlap.truths) {
      if (!truth.counts) continue;
      std::uint32_t best = mapping::kNoObjectOfPoint;
      std::uint64_t most = 0, of_own_class = 0;
      std::size_t pieces = 0;
      const auto& takers = overlap.shared.at(instance);
      for (const auto& [object, count] : takers) {
        if (count > most) most = count, best = object;
        if (object != mapping::kNoObjectOfPoint && class_of_[object] == truth.class_number)
          of_own_class += count, ++pieces;
      }
      const std::string name = names_[truth.class_number];
      std::string cause;
      if (best == mapping::kNoObjectOfPoint) {
        cause = "nobody took it";
      } else if (class_of_[best] != truth.class_number) {
        cause = "taken by " + result.objects[best].rule_id;
        if (2 * of_own_class >= truth.points) cause = "in pieces, most by " + result.objects[best].rule_id;
      } else {
        const std::uint64_t whole = overlap.found[best].points;
        if (2 * most >= truth.points + whole - most) {
          const std::string sides = sortSides(name, truth.box, overlap.found[best].box);
          if (options_.each && !sides.empty())
            printTakers(("B " + name + sides).c_str(), truth, takers, overlap, result);
          continue;
        }
        if (2 * of_own_class < truth.points)
          cause = "mostly others'";
        else if (2 * most < truth.points)
          cause = "split";
        else
          cause = "in a larger " + name;
      }
      if (2 * truth.rightly_labelled < truth.points) cause += " [labels wrong]";
      ++missed_[name + ": " + cause];
      if (options_.each) printTakers(("T " + name + ": " + cause).c_str(), truth, takers, overlap, result);
    }
  }

  static void printTakers(const char* what, const Overlap::Truth& truth,
                          const std::map<std::uint32_t, std::uint64_t>& takers, const Overlap& overlap,
                          const rules::ReasoningResult& result) {
    const Eigen::Vector3d at = truth.sum / static_cast<double>(truth.points);
    std::printf("%s n=%llu right=%.2f at %.1f %.1f %.1f:", what, static_cast<unsigned long long>(truth.points),
                static_cast<double>(truth.rightly_labelled) / static_cast<double>(truth.points), at.x(), at.y(),
                at.z());
    for (const auto& [object, count] : takers) {
      const bool is_free = object == mapping::kNoObjectOfPoint;
      const std::string name =
          is_free ? "-" : result.objects[object].rule_id + "#" + result.objects[object].id.hex().substr(0, 6);
      std::printf(" %s %llu/%llu", name.c_str(), static_cast<unsigned long long>(count),
                  static_cast<unsigned long long>(is_free ? 0 : overlap.found[object].points));
    }
    std::printf("\n");
  }

  /// Which sides of a partner's box are wrong by more than a tenth of the truth's extent and by more than 0.15 m.
  std::string sortSides(const std::string& name, const Eigen::AlignedBox3d& truth, const Eigen::AlignedBox3d& found) {
    const Eigen::Vector3d low = truth.min() - found.min(), high = found.max() - truth.max();
    const Eigen::Vector3d size = truth.sizes();
    const auto isOff = [](double by, double extent) { return std::abs(by) > std::max(0.15, 0.1 * extent); };
    std::string what;
    if (isOff(high.z(), size.z())) what += high.z() > 0 ? " top too high" : " top cut off";
    if (isOff(low.z(), size.z())) what += low.z() > 0 ? " bottom too low" : " bottom cut off";
    bool wide = false, narrow = false;
    for (int axis = 0; axis < 2; ++axis)
      for (const double by : {low[axis], high[axis]})
        if (isOff(by, size[axis])) (by > 0 ? wide : narrow) = true;
    if (wide) what += " too wide";
    if (narrow) what += " too narrow";
    if (!what.empty()) ++sides_[name + ":" + what];
    return what;
  }

  void sortFound(const Overlap& overlap, const rules::ReasoningResult& result) {
    for (std::uint32_t i = 0; i < overlap.found.size(); ++i) {
      const Overlap::Found& found = overlap.found[i];
      const std::size_t own = class_of_[i];
      if (found.points == 0 || names_[own] == "Ground") continue;
      std::size_t most_class = 0;
      std::uint64_t most = 0;
      for (const auto& [of_class, count] : found.of_class)
        if (count > most) most = count, most_class = of_class;
      std::int32_t best = -1;
      std::uint64_t best_points = 0;
      for (const auto& [instance, count] : overlap.back.at(i))
        if (count > best_points) best_points = count, best = instance;
      std::string cause = "is " + names_[most_class];
      if (most_class == own) {
        if (best < 0 || !overlap.truths.at(best).counts) continue;
        const std::uint64_t truth = overlap.truths.at(best).points;
        if (2 * best_points >= truth + found.points - best_points) continue;
        cause = 2 * best_points < truth ? "a fragment of one" : "one and more";
      } else if (best >= 0 && !overlap.truths.at(best).counts) {
        continue;
      }
      ++wrong_[names_[own] + " (" + result.objects[i].rule_id + "): " + cause];
      if (options_.each) {
        const Eigen::Vector3d at = found.sum / static_cast<double>(found.points);
        std::printf("F %s#%s %s n=%llu at %.1f %.1f %.1f:", result.objects[i].rule_id.c_str(),
                    result.objects[i].id.hex().substr(0, 6).c_str(), cause.c_str(),
                    static_cast<unsigned long long>(found.points), at.x(), at.y(), at.z());
        for (const auto& [of_class, count] : found.of_class)
          std::printf(" %s %llu", names_[of_class].c_str(), static_cast<unsigned long long>(count));
        std::printf("\n");
      }
    }
  }

  const Options& options_;
  std::optional<tasks::TruthSource> truth_;
  std::vector<std::string> names_;
  std::vector<std::size_t> class_of_;  ///< of the objects of the current map
  std::vector<tasks::ObjectScore> by_points_, by_box_;
  std::map<std::pair<std::size_t, std::size_t>, double> by_class_;
  std::map<std::string, int> missed_, wrong_, sides_;
  double seconds_ = 0;
};

}  // namespace

int main(int count, char** words) {
  try {
    const Options options = optionsOf(count, words);
    Errors errors(options);
    for (const fs::path& map : options.maps) errors.look(map);
    errors.print();
    return 0;
  } catch (const Error& fault) {
    std::fprintf(stderr, "object_errors: %s\n", fault.what());
    return static_cast<int>(fault.kind());
  }
}
