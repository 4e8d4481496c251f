// SPDX-License-Identifier: Apache-2.0
// An evaluation as JSON.
#include <nlohmann/json.hpp>

#include "tasks/evaluation/evaluation_shares.hpp"

namespace cluxel::tasks {

namespace {

using EvaluationJson = nlohmann::ordered_json;

EvaluationJson jsonOf(const Share& share) {
  return share ? EvaluationJson(*share) : EvaluationJson();
}

EvaluationJson intervalJson(const ObjectShare& share) {
  if (!share.share) return {};
  return EvaluationJson::array({share.interval.low, share.interval.high});
}

EvaluationJson pointJson(const ConfusionMatrix& matrix) {
  EvaluationJson json{{"overall_accuracy", matrix.overallAccuracy()},
                      {"macro_f1", matrix.macroF1()},
                      {"macro_iou", matrix.macroIou()},
                      {"points", matrix.total()},
                      {"classes", EvaluationJson::array()}};
  for (std::size_t i = 0; i < matrix.names.size(); ++i) {
    EvaluationJson counts = EvaluationJson::object();
    for (std::size_t answer = 0; answer <= matrix.names.size(); ++answer)
      counts[answer < matrix.names.size() ? matrix.names[answer] : "none"] = matrix.at(i, answer);
    const auto [precision, recall, f1, iou] = sharesOf(matrix, i);
    json["classes"].push_back({{"class", matrix.names[i]},
                               {"precision", jsonOf(precision)},
                               {"recall", jsonOf(recall)},
                               {"f1", jsonOf(f1)},
                               {"iou", jsonOf(iou)},
                               {"points", matrix.truthCount(i)},
                               {"answers", counts}});
  }
  return json;
}

EvaluationJson objectJson(const std::vector<ObjectScore>& scores) {
  EvaluationJson json = EvaluationJson::array();
  for (const ObjectScore& score : scores) {
    const auto [precision, recall, f1] = sharesOf(score);
    json.push_back({{"class", score.name},
                    {"truth", score.truth},
                    {"answers", score.answers},
                    {"matched_truth", score.matched_truth},
                    {"matched_answers", score.matched_answers},
                    {"precision", jsonOf(precision.share)},
                    {"precision_interval", intervalJson(precision)},
                    {"recall", jsonOf(recall.share)},
                    {"recall_interval", intervalJson(recall)},
                    {"f1", jsonOf(f1.share)},
                    {"f1_interval", intervalJson(f1)}});
  }
  return json;
}

EvaluationJson curvesJson(const MapEvaluation& evaluation) {
  EvaluationJson json = EvaluationJson::array();
  for (std::size_t i = 0; i < evaluation.by_points.size(); ++i) {
    EvaluationJson points = EvaluationJson::array();
    for (const PrecisionRecall& point : evaluation.precisionRecallOf(i))
      points.push_back({{"confidence", point.confidence},
                        {"answers", point.answers},
                        {"right", point.right},
                        {"precision", point.precision},
                        {"recall", point.recall}});
    if (!points.empty()) json.push_back({{"class", evaluation.by_points[i].name}, {"points", std::move(points)}});
  }
  return json;
}

/// Only classes that occur.
EvaluationJson answersJson(const std::vector<std::uint64_t>& counts, const std::vector<std::string>& names) {
  EvaluationJson json = EvaluationJson::object();
  for (std::size_t i = 0; i < counts.size(); ++i)
    if (counts[i] > 0) json[i < names.size() ? names[i] : i == names.size() ? "another class" : "none"] = counts[i];
  return json;
}

EvaluationJson kindJson(const MapEvaluation& evaluation) {
  EvaluationJson json = EvaluationJson::array();
  for (const KindAnswers& kind : evaluation.kinds)
    json.push_back({{"kind", kind.name},
                    {"truth", kind.truth},
                    {"found", answersJson(kind.found, evaluation.objects.names)},
                    {"called", answersJson(kind.called, evaluation.objects.names)},
                    {"boxed", answersJson(kind.boxed, evaluation.objects.names)}});
  return json;
}

EvaluationJson calibrationJson(const Calibration& calibration) {
  EvaluationJson bins = EvaluationJson::array();
  for (const CalibrationBin& bin : calibration.bins)
    bins.push_back({{"objects", bin.objects},
                    {"right", bin.right},
                    {"confidence_sum", bin.confidence_sum},
                    {"variance_sum", bin.variance_sum}});
  return {{"expected_error", calibration.expectedError()},
          {"error_by_chance", calibration.errorByChance()},
          {"objects", calibration.objects()},
          {"bins", bins}};
}

}  // namespace

std::string toJson(const MapEvaluation& evaluation) {
  EvaluationJson json{{"primitives_by_point", pointJson(evaluation.primitives)},
                      {"objects_by_point", pointJson(evaluation.objects)}};
  if (evaluation.has_instances) {
    json["coverage"] = evaluation.covers_all ? "all" : "some";
    json["objects_by_point_set"] = objectJson(evaluation.by_points);
    json["precision_recall"] = curvesJson(evaluation);
    json["objects_by_box"] = objectJson(evaluation.by_box);
    json["objects_by_kind"] = kindJson(evaluation);
    json["matched_whole"] = evaluation.matched_whole;
    json["crown_pairs"] = {{"pairs", evaluation.crown_pairs.pairs}, {"parted", evaluation.crown_pairs.parted}};
  }
  json["calibration"] = calibrationJson(evaluation.calibration);
  return json.dump(2);
}

}  // namespace cluxel::tasks
