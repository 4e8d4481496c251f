// SPDX-License-Identifier: Apache-2.0
// Visits all points of all clouds with their truth.
#include "tasks/evaluation/evaluation.hpp"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <map>
#include <numeric>

#include "cluxel/error.hpp"
#include "mapping/clouds/scan_store.hpp"
#include "mapping/layers/stored_layers.hpp"
#include "mapping/map_inputs.hpp"
#include "mapping/regions/answered_clouds.hpp"
#include "tasks/evaluation/object_matching.hpp"
#include "tasks/evaluation/truth_class.hpp"

namespace cluxel::tasks {

namespace {

double ratio(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

double harmonic(double a, double b) {
  return a + b == 0 ? 0.0 : 2 * a * b / (a + b);
}

/// The objects of the map, without what belongs to them.
std::vector<rules::SemanticObject> namedObjects(const mapping::MapReader& map) {
  std::vector<rules::SemanticObject> objects;
  mapping::forEachRecord(map.transaction(), [&](const ContentHash& id, const mapping::ObjectRecord& record) {
    rules::SemanticObject& object = objects.emplace_back();
    object.id = id, object.class_iri = record.class_iri, object.confidence = record.confidence;
  });
  return objects;
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

/// Enters the points of a map, cloud by cloud.
struct PointVisit {
  const TruthSource& source;
  std::vector<std::size_t> class_of_object;
  ObjectMatching matching;
  ClassVotes votes;
  MapEvaluation& evaluation;
  CrownPairs crowns = {};
  std::map<std::int32_t, std::string> kinds = {};
  std::int32_t next_instance = 0;  ///< of the next cloud, where each cloud begins anew

  void see(const scan::Scan& scan, const mapping::PointAnswers& answers) {
    const scan::PointTruth truth = source.truthOf(scan);
    const std::int32_t first = source.countsInstancesByScan() ? next_instance : 0;
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
      if (truth.primitive[i] >= 0)
        evaluation.primitives.add(static_cast<std::size_t>(truth.primitive[i]), answers.label[i]);
      if (truth.object_class[i] < 0) {
        matching.addWithoutTruth(answers.object[i]);
        if (answers.object[i] != mapping::kNoObjectOfPoint) votes.addWithoutTruth(answers.object[i]);
        continue;
      }
      const std::int32_t instance = truth.instance[i] < 0 ? -1 : first + truth.instance[i];
      if (source.countsInstancesByScan()) next_instance = std::max(next_instance, instance + 1);
      seePoint(scan, i, truth, instance, answers.object[i]);
    }
  }

  void seePoint(const scan::Scan& scan, std::size_t i, const scan::PointTruth& truth, std::int32_t instance,
                std::uint32_t object) {
    const auto truth_class = static_cast<std::size_t>(truth.object_class[i]);
    const bool is_free = object == mapping::kNoObjectOfPoint;
    evaluation.objects.add(truth_class, is_free ? evaluation.objects.names.size() : class_of_object[object]);
    if (!is_free) votes.add(object, truth_class);
    const Eigen::Vector3d p_map =
        scan::toMap(scan.T_map_sensor, Eigen::Vector3f(scan.points.x[i], scan.points.y[i], scan.points.z[i]));
    matching.add(p_map, truth_class, instance, object);
    const bool is_trunk = truth.primitive[i] == static_cast<std::int8_t>(scan::PrimitiveLabel::Column);
    if (instance >= 0 && truth.class_names[truth_class] == "Tree") crowns.add(p_map, instance, is_trunk, object);
    if (instance < 0 || scan.points.label.empty() || kinds.contains(instance)) return;
    if (std::string name = source.nameOfLabel(scan.points.label[i]); !name.empty())
      kinds.emplace(instance, std::move(name));
  }
};

void addScores(const std::vector<ObjectScore>& from, std::vector<ObjectScore>& into) {
  for (std::size_t i = 0; i < into.size(); ++i) {
    into[i].truth += from[i].truth;
    into[i].answers += from[i].answers;
    into[i].matched_truth += from[i].matched_truth;
    into[i].matched_answers += from[i].matched_answers;
  }
}

void addKinds(const std::vector<KindAnswers>& from, std::vector<KindAnswers>& into) {
  for (const KindAnswers& kind : from) {
    const auto after = std::lower_bound(into.begin(), into.end(), kind.name,
                                        [](const KindAnswers& a, const std::string& name) { return a.name < name; });
    if (after == into.end() || after->name != kind.name) {
      into.insert(after, kind);
      continue;
    }
    after->truth += kind.truth;
    for (std::size_t i = 0; i < kind.found.size(); ++i) {
      after->found[i] += kind.found[i];
      after->called[i] += kind.called[i];
      after->boxed[i] += kind.boxed[i];
    }
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

void ConfusionMatrix::add(const ConfusionMatrix& other) {
  if (names != other.names) throw Error(ErrorKind::InvalidArgument, "evaluations of different classes cannot be added");
  for (std::size_t i = 0; i < counts.size(); ++i) counts[i] += other.counts[i];
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

std::vector<PrecisionRecall> MapEvaluation::precisionRecallOf(std::size_t class_number) const {
  const std::uint64_t truth = by_points.at(class_number).truth;
  std::map<double, std::pair<std::uint64_t, std::uint64_t>, std::greater<>> counts;  // answers and right ones
  for (const JudgedAnswer& object : judged) {
    if (object.class_number != class_number) continue;
    auto& [answers, right] = counts[object.confidence];
    ++answers;
    right += object.is_right ? 1 : 0;
  }
  std::vector<PrecisionRecall> curve;
  if (truth == 0) return curve;
  std::uint64_t answers = 0, right = 0;
  for (const auto& [confidence, at] : counts) {
    answers += at.first, right += at.second;
    curve.push_back({confidence, answers, right, ratio(right, answers), ratio(right, truth)});
  }
  return curve;
}

void MapEvaluation::add(const MapEvaluation& other) {
  primitives.add(other.primitives);
  objects.add(other.objects);
  has_instances |= other.has_instances;
  covers_all &= other.covers_all;
  matched_whole += other.matched_whole;
  judged.insert(judged.end(), other.judged.begin(), other.judged.end());
  calibration.add(other.calibration);
  crown_pairs.pairs += other.crown_pairs.pairs;
  crown_pairs.parted += other.crown_pairs.parted;
  addScores(other.by_box, by_box);
  addScores(other.by_points, by_points);
  addKinds(other.kinds, kinds);
}

MapEvaluation evaluateMap(const mapping::MapReader& map, const TruthSource& source, const EvaluationParams& params) {
  refuseSharedTruth(map, source);
  const TruthClasses classes = source.classes();
  MapEvaluation evaluation{ConfusionMatrix(primitiveNames()), ConfusionMatrix(classes.names), false, {}, {}, {}};
  const std::vector<rules::SemanticObject> objects = namedObjects(map);
  std::vector<std::size_t> class_of_object = truthClassesOf(objects, classes, classCatalogueOf(map.inputs().ontology));
  ObjectMatching matching(classes.names, class_of_object, source.ambiguous());
  PointVisit visit{source, std::move(class_of_object), std::move(matching), ClassVotes(objects.size()), evaluation};
  forEachAnsweredCloud(map, [&](const mapping::Cloud& cloud, const scan::ScanPoints& points,
                                const mapping::PointAnswers& answers) { visit.see(scanOf(cloud, points), answers); });
  if (evaluation.primitives.total() == 0 && evaluation.objects.total() == 0)
    throw Error(ErrorKind::FaultyInput, "the truth says nothing about the points of this map; is it of other scans?");
  evaluation.covers_all = source.coversAll();
  evaluation.has_instances = visit.matching.hasInstances();
  evaluation.by_box = visit.matching.scoreByBox(params);
  evaluation.by_points = visit.matching.scoreByPoints(params);
  evaluation.matched_whole = visit.matching.matchedWhole(params);
  evaluation.judged = visit.matching.judgedByPoints(params);
  for (JudgedAnswer& judged : evaluation.judged) judged.confidence = objects[judged.object].confidence;
  evaluation.kinds = visit.matching.answersByKind(visit.kinds, params);
  const auto ground = std::find(classes.names.begin(), classes.names.end(), "Ground") - classes.names.begin();
  evaluation.calibration =
      visit.votes.calibrationOf(objects, visit.class_of_object, classes.names.size(), static_cast<std::size_t>(ground));
  evaluation.crown_pairs = visit.crowns.score(source.ambiguous());
  return evaluation;
}

}  // namespace cluxel::tasks
