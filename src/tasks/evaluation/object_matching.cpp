// SPDX-License-Identifier: Apache-2.0
// Greedy matching in order of decreasing IoU: with thresholds of 0.5 or more, a truth object has few candidates.
#include "tasks/evaluation/object_matching.hpp"

#include <algorithm>
#include <tuple>

namespace cluxel::tasks {

namespace {

double boxIou(Eigen::AlignedBox3d a, Eigen::AlignedBox3d b, double padding_m) {
  for (Eigen::AlignedBox3d* box : {&a, &b}) {
    box->min().array() -= padding_m;
    box->max().array() += padding_m;
  }
  const Eigen::AlignedBox3d common = a.intersection(b);
  const double shared = common.isEmpty() ? 0.0 : common.volume();
  return shared / (a.volume() + b.volume() - shared);
}

double pointIou(const PointSet& found, const PointSet& truth, std::uint64_t shared) {
  return static_cast<double>(shared) / static_cast<double>(found.count + truth.count - shared);
}

}  // namespace

ObjectMatching::ObjectMatching(const std::vector<std::string>& class_names,
                               const std::vector<std::size_t>& class_of_object,
                               const std::vector<std::int32_t>& ambiguous)
    : names_(class_names), ambiguous_(ambiguous), found_(class_of_object.size()) {
  ground_ = static_cast<std::size_t>(std::find(names_.begin(), names_.end(), "Ground") - names_.begin());
  for (std::size_t i = 0; i < found_.size(); ++i) found_[i].class_number = class_of_object[i];
}

void ObjectMatching::add(const Eigen::Vector3d& p_map, std::size_t truth_class, std::int32_t instance,
                         std::uint32_t object) {
  if (truth_class == ground_) instance = -1;
  if (instance >= 0) {
    PointSet& truth = truth_[instance];
    if (truth.count == 0)
      truth.counts = !std::binary_search(ambiguous_.begin(), ambiguous_.end(), instance),
      truth.class_number = truth_class;
    ++truth.count;
    truth.box.extend(p_map);
  }
  if (object == mapping::kNoObjectOfPoint) return;
  PointSet& found = found_[object];
  ++found.count;
  found.box.extend(p_map);
  if (instance >= 0)
    ++shared_[{object, instance}];
  else if (truth_class == found.class_number)
    ++found.without_instance;
}

void ObjectMatching::addWithoutTruth(std::uint32_t object) {
  if (object != mapping::kNoObjectOfPoint) ++found_[object].without_truth;
}

std::int32_t ObjectMatching::bestInstance(std::uint32_t object) const {
  std::int32_t best = -1;
  std::uint64_t max_shared = 0;
  for (auto it = shared_.lower_bound({object, -1}); it != shared_.end() && it->first.first == object; ++it)
    if (it->second > max_shared) max_shared = it->second, best = it->first.second;
  return best;
}

/// A prediction whose best match is ambiguous, or mostly instance -1 of its class, counts neither as right nor as
/// wrong.
bool ObjectMatching::countsAsAnswer(std::uint32_t object) const {
  const PointSet& found = found_[object];
  if (found.count == 0 || found.class_number == ground_ || 2 * found.without_instance > found.count) return false;
  const std::int32_t best = bestInstance(object);
  return best < 0 || truth_.at(best).counts;
}

template <typename Iou>
ObjectMatching::Partners ObjectMatching::match(double min_iou, const Iou& iou) const {
  std::vector<Candidate> candidates;
  for (const auto& [pair, count] : shared_) {
    const auto& [object, instance] = pair;
    if (truth_.at(instance).class_number != found_[object].class_number) continue;
    const double value = iou(found_[object], truth_.at(instance), count);
    if (value >= min_iou) candidates.push_back({value, instance, object});
  }
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return std::tie(b.iou, a.instance, a.object) < std::tie(a.iou, b.instance, b.object);
  });
  Partners partners;
  for (const Candidate& candidate : candidates) {
    if (partners.instances.contains(candidate.instance) || partners.objects.contains(candidate.object)) continue;
    partners.instances.insert(candidate.instance);
    partners.objects.insert(candidate.object);
  }
  return partners;
}

template <typename Iou>
std::vector<ObjectScore> ObjectMatching::score(double min_iou, const Iou& iou) const {
  const auto [matched_truth, matched_objects] = match(min_iou, iou);
  std::vector<ObjectScore> scores(names_.size());
  for (std::size_t i = 0; i < names_.size(); ++i) scores[i].name = names_[i];
  for (const auto& [instance, truth] : truth_) {
    if (!truth.counts) continue;
    ++scores[truth.class_number].truth;
    scores[truth.class_number].matched_truth += matched_truth.contains(instance) ? 1 : 0;
  }
  for (std::uint32_t object = 0; object < found_.size(); ++object) {
    if (found_[object].class_number >= names_.size() || !countsAsAnswer(object)) continue;
    ++scores[found_[object].class_number].answers;
    scores[found_[object].class_number].matched_answers += matched_objects.contains(object) ? 1 : 0;
  }
  return scores;
}

std::vector<ObjectScore> ObjectMatching::scoreByBox(const EvaluationParams& params) const {
  return score(params.box_iou, [&](const PointSet& found, const PointSet& truth, std::uint64_t) {
    return boxIou(found.box, truth.box, params.box_padding_m);
  });
}

std::vector<ObjectScore> ObjectMatching::scoreByPoints(const EvaluationParams& params) const {
  return score(params.point_iou, pointIou);
}

std::vector<JudgedAnswer> ObjectMatching::judgedByPoints(const EvaluationParams& params) const {
  const Partners partners = match(params.point_iou, pointIou);
  std::vector<JudgedAnswer> judged;
  for (std::uint32_t object = 0; object < found_.size(); ++object)
    if (found_[object].class_number < names_.size() && countsAsAnswer(object))
      judged.push_back({object, found_[object].class_number, 0, partners.objects.contains(object)});
  return judged;
}

std::uint64_t ObjectMatching::matchedWhole(const EvaluationParams& params) const {
  const auto scores = score(params.point_iou, [](const PointSet& found, const PointSet& truth, std::uint64_t shared) {
    const std::uint64_t whole = found.count + found.without_truth + truth.count - shared;
    return static_cast<double>(shared) / static_cast<double>(whole);
  });
  std::uint64_t sum = 0;
  for (const ObjectScore& one : scores) sum += one.matched_truth;
  return sum;
}

std::map<std::int32_t, std::map<std::uint32_t, std::uint64_t>> ObjectMatching::objectsOfInstances() const {
  std::map<std::int32_t, std::map<std::uint32_t, std::uint64_t>> objects;
  for (const auto& [pair, count] : shared_) objects[pair.second][pair.first] = count;
  return objects;
}

std::size_t ObjectMatching::boxedClass(const PointSet& truth, const std::map<std::uint32_t, std::uint64_t>& takers,
                                       const EvaluationParams& params) const {
  std::size_t boxed = names_.size() + 1;
  double best = params.box_iou;
  for (const auto& [object, shared] : takers) {
    const double iou = boxIou(found_[object].box, truth.box, params.box_padding_m);
    if (iou >= best) best = iou, boxed = found_[object].class_number;
  }
  return boxed;
}

void ObjectMatching::countAnswers(const PointSet& truth, const std::map<std::uint32_t, std::uint64_t>& takers,
                                  const EvaluationParams& params, KindAnswers& answers) const {
  const std::size_t none = names_.size() + 1;
  std::size_t found = none, called = none;
  std::uint64_t max_shared = 0, in_none = truth.count;
  for (const auto& [object, shared] : takers) {
    const PointSet& taker = found_[object];
    const std::uint64_t whole = taker.count + truth.count - shared;
    if (static_cast<double>(shared) >= params.point_iou * static_cast<double>(whole)) found = taker.class_number;
    if (shared > max_shared) max_shared = shared, called = taker.class_number;
    in_none -= shared;
  }
  for (auto* counts : {&answers.found, &answers.called, &answers.boxed}) counts->resize(none + 1);
  ++answers.truth;
  ++answers.found[found];
  ++answers.called[in_none > max_shared ? none : called];
  ++answers.boxed[boxedClass(truth, takers, params)];
}

std::vector<KindAnswers> ObjectMatching::answersByKind(const std::map<std::int32_t, std::string>& kinds,
                                                       const EvaluationParams& params) const {
  std::map<std::string, KindAnswers> by_name;
  auto objects = objectsOfInstances();
  for (const auto& [instance, truth] : truth_) {
    if (!truth.counts) continue;
    const auto kind = kinds.find(instance);
    const std::string& name = kind == kinds.end() ? names_[truth.class_number] : kind->second;
    KindAnswers& answers = by_name.try_emplace(name, KindAnswers{name, 0, {}, {}, {}}).first->second;
    countAnswers(truth, objects[instance], params, answers);
  }
  std::vector<KindAnswers> sorted;
  for (auto& [name, answers] : by_name) sorted.push_back(std::move(answers));
  return sorted;
}

}  // namespace cluxel::tasks
