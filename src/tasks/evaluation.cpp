// SPDX-License-Identifier: Apache-2.0
// Visits all points of all clouds with their truth.
#include "tasks/evaluation.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <numeric>

#include "cluxel/error.hpp"
#include "mapping/map_inputs.hpp"
#include "tasks/object_matching.hpp"
#include "tasks/truth_class.hpp"

namespace cluxel::tasks {

namespace {

double ratio(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

double harmonic(double a, double b) {
  return a + b == 0 ? 0.0 : 2 * a * b / (a + b);
}

scan::Scan scanOf(const mapping::MapReader& map, const mapping::Cloud& cloud) {
  scan::Scan scan;
  scan.points = map.pointsOf(cloud.id);
  scan.T_map_sensor = cloud.T_map_sensor;
  scan.has_pose = cloud.has_pose;
  scan.source = cloud.source;
  scan.id = cloud.id;
  return scan;
}

std::vector<std::string> primitiveNames() {
  return {scan::kPrimitiveLabelNames.begin(), scan::kPrimitiveLabelNames.end()};
}

/// Two scans with the same name would share a truth file, which can fit only one of them.
void refuseSharedTruth(const mapping::MapReader& map, const TruthSource& source) {
  std::map<std::filesystem::path, std::string> scan_of;
  for (const mapping::Cloud& cloud : map.clouds()) {
    scan::Scan scan;
    scan.source = cloud.source;
    const auto file = source.fileOf(scan);
    if (!file) continue;
    const auto [other, is_first] = scan_of.emplace(*file, cloud.source);
    if (!is_first)
      throw InputError({.file = cloud.source}, "has the truth file of " + other->second + ", " + file->string(),
                       "put truth files into folders named like the folders of the scans");
  }
}

}  // namespace

ConfusionMatrix::ConfusionMatrix(std::vector<std::string> class_names)
    : names(std::move(class_names)), counts(names.size() * (names.size() + 1), 0) {}

std::uint64_t ConfusionMatrix::truthCount(std::size_t name) const {
  std::uint64_t sum = 0;
  for (std::size_t answer = 0; answer <= names.size(); ++answer) sum += at(name, answer);
  return sum;
}

std::uint64_t ConfusionMatrix::answerCount(std::size_t name) const {
  std::uint64_t sum = 0;
  for (std::size_t truth = 0; truth < names.size(); ++truth) sum += at(truth, name);
  return sum;
}

std::uint64_t ConfusionMatrix::total() const {
  return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
}

double ConfusionMatrix::precision(std::size_t name) const {
  return ratio(at(name, name), answerCount(name));
}
double ConfusionMatrix::recall(std::size_t name) const {
  return ratio(at(name, name), truthCount(name));
}
double ConfusionMatrix::f1(std::size_t name) const {
  return harmonic(precision(name), recall(name));
}
double ConfusionMatrix::iou(std::size_t name) const {
  return ratio(at(name, name), truthCount(name) + answerCount(name) - at(name, name));
}

double ConfusionMatrix::overallAccuracy() const {
  std::uint64_t right = 0;
  for (std::size_t name = 0; name < names.size(); ++name) right += at(name, name);
  return ratio(right, total());
}

double ConfusionMatrix::macroF1() const {
  double sum = 0, present = 0;
  for (std::size_t name = 0; name < names.size(); ++name)
    if (truthCount(name) > 0) sum += f1(name), ++present;
  return present == 0 ? 0 : sum / present;
}

double ConfusionMatrix::macroIou() const {
  double sum = 0, present = 0;
  for (std::size_t name = 0; name < names.size(); ++name)
    if (truthCount(name) > 0) sum += iou(name), ++present;
  return present == 0 ? 0 : sum / present;
}

double ObjectScore::precision() const {
  return ratio(matched_answers, answers);
}
double ObjectScore::recall() const {
  return ratio(matched_truth, truth);
}
double ObjectScore::f1() const {
  return harmonic(precision(), recall());
}

MapEvaluation evaluateMap(const mapping::MapReader& map, const TruthSource& source, const EvaluationParams& params) {
  const std::vector<std::string> names = source.classNames();
  refuseSharedTruth(map, source);
  MapEvaluation evaluation{ConfusionMatrix(primitiveNames()), ConfusionMatrix(names), false, {}, {}};
  const std::vector<std::size_t> class_of_object =
      truthClassesOf(map.objects(), names, classCatalogueOf(map.inputs().ontology));
  ObjectMatching matching(names, class_of_object, source.ambiguous());
  // Ground has no well-defined instances: it counts by point only.
  const auto ground = static_cast<std::size_t>(std::find(names.begin(), names.end(), "Ground") - names.begin());
  for (const mapping::Cloud& cloud : map.clouds()) {
    const scan::Scan scan = scanOf(map, cloud);
    const scan::PointTruth truth = source.truthOf(scan);
    const mapping::PointAnswers answers = map.answersFor(cloud);
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
      if (truth.primitive[i] >= 0)
        evaluation.primitives.add(static_cast<std::size_t>(truth.primitive[i]), answers.label[i]);
      if (truth.object_class[i] < 0) continue;
      const auto truth_class = static_cast<std::size_t>(truth.object_class[i]);
      const std::uint32_t object = answers.object[i];
      evaluation.objects.add(truth_class, object == mapping::kNoObjectOfPoint ? names.size() : class_of_object[object]);
      const Eigen::Vector3f p(scan.points.x[i], scan.points.y[i], scan.points.z[i]);
      const bool has_instance = !truth.instance.empty() && truth_class != ground;
      matching.add(scan::toMap(scan.T_map_sensor, p), truth_class, has_instance ? truth.instance[i] : -1, object);
    }
  }
  if (evaluation.primitives.total() == 0 && evaluation.objects.total() == 0)
    throw Error(ErrorKind::FaultyInput, "the truth says nothing about the points of this map; is it of other scans?");
  evaluation.has_instances = matching.hasInstances();
  evaluation.by_box = matching.scoreByBox(params);
  evaluation.by_points = matching.scoreByPoints(params);
  return evaluation;
}

}  // namespace cluxel::tasks
