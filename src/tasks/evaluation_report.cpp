// SPDX-License-Identifier: Apache-2.0
// An evaluation as tables for people and as JSON.
#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>

#include "tasks/evaluation.hpp"

namespace cluxel::tasks {

namespace {

using Json = nlohmann::ordered_json;

std::string padded(std::string text, std::size_t width) {
  if (text.size() < width) text.append(width - text.size(), ' ');
  return text;
}

/// A share; empty where the total is 0.
using Share = std::optional<double>;

Share shareOf(double value, std::uint64_t whole) {
  return whole == 0 ? Share() : Share(value);
}

std::string row(const std::string& name, std::span<const Share> shares, std::uint64_t count) {
  std::string text = padded(name, 18);
  for (const Share& share : shares) {
    char cell[32];
    if (share)
      std::snprintf(cell, sizeof cell, "%9.3f", *share);
    else
      std::snprintf(cell, sizeof cell, "%9s", "-");
    text += cell;
  }
  return text + padded("", 3) + std::to_string(count) + '\n';
}

/// Precision, recall, F1, IoU. A class without truth has a count of false answers only.
std::array<Share, 4> sharesOf(const ConfusionMatrix& matrix, std::size_t i) {
  const std::uint64_t truth = matrix.truthCount(i);
  return {shareOf(matrix.precision(i), matrix.answerCount(i)), shareOf(matrix.recall(i), truth),
          shareOf(matrix.f1(i), truth), shareOf(matrix.iou(i), truth)};
}

std::array<Share, 3> sharesOf(const ObjectScore& score) {
  return {shareOf(score.precision(), score.answers), shareOf(score.recall(), score.truth),
          shareOf(score.f1(), score.truth)};
}

Json jsonOf(const Share& share) {
  return share ? Json(*share) : Json();
}

std::string pointTable(const char* title, const ConfusionMatrix& matrix) {
  std::string text =
      std::string(title) + "\n" + padded("class", 18) + "precision   recall       F1      IoU   points\n";
  for (std::size_t i = 0; i < matrix.names.size(); ++i)
    if (matrix.truthCount(i) + matrix.answerCount(i) > 0)
      text += row(matrix.names[i], sharesOf(matrix, i), matrix.truthCount(i));
  char total[160];
  std::snprintf(total, sizeof total, "overall accuracy %.4f   macro F1 %.4f   macro IoU %.4f   %llu points\n",
                matrix.overallAccuracy(), matrix.macroF1(), matrix.macroIou(),
                static_cast<unsigned long long>(matrix.total()));
  return text + total;
}

std::string confusionTable(const ConfusionMatrix& matrix) {
  std::string text = padded("truth \\ answer", 18);
  for (const std::string& name : matrix.names) text += padded(name.substr(0, 10), 11);
  text += "none\n";
  for (std::size_t truth = 0; truth < matrix.names.size(); ++truth) {
    text += padded(matrix.names[truth], 18);
    for (std::size_t answer = 0; answer <= matrix.names.size(); ++answer)
      text += padded(std::to_string(matrix.at(truth, answer)), 11);
    text += '\n';
  }
  return text;
}

std::string objectTable(const char* title, const std::vector<ObjectScore>& scores) {
  std::string text = std::string(title) + "\n" + padded("class", 18) + "precision   recall       F1   objects\n";
  std::uint64_t truth = 0, answers = 0, matched_truth = 0, matched_answers = 0;
  for (const ObjectScore& score : scores) {
    truth += score.truth, answers += score.answers;
    matched_truth += score.matched_truth, matched_answers += score.matched_answers;
    if (score.truth + score.answers > 0) text += row(score.name, sharesOf(score), score.truth);
  }
  const ObjectScore all{"all", truth, answers, matched_truth, matched_answers};
  return text + row("all", sharesOf(all), truth);
}

Json pointJson(const ConfusionMatrix& matrix) {
  Json json{{"overall_accuracy", matrix.overallAccuracy()},
            {"macro_f1", matrix.macroF1()},
            {"macro_iou", matrix.macroIou()},
            {"points", matrix.total()},
            {"classes", Json::array()}};
  for (std::size_t i = 0; i < matrix.names.size(); ++i) {
    Json counts = Json::object();
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

Json objectJson(const std::vector<ObjectScore>& scores) {
  Json json = Json::array();
  for (const ObjectScore& score : scores) {
    const auto [precision, recall, f1] = sharesOf(score);
    json.push_back({{"class", score.name},
                    {"truth", score.truth},
                    {"answers", score.answers},
                    {"matched_truth", score.matched_truth},
                    {"matched_answers", score.matched_answers},
                    {"precision", jsonOf(precision)},
                    {"recall", jsonOf(recall)},
                    {"f1", jsonOf(f1)}});
  }
  return json;
}

}  // namespace

std::string toText(const MapEvaluation& evaluation) {
  std::string text = pointTable("Primitives by point", evaluation.primitives) + '\n' +
                     confusionTable(evaluation.primitives) + '\n' + pointTable("Objects by point", evaluation.objects) +
                     '\n' + confusionTable(evaluation.objects) + '\n';
  if (!evaluation.has_instances) return text + "Objects by object: the truth has no instances.\n";
  return text + objectTable("Objects by object, point sets with IoU of 0.5", evaluation.by_points) + '\n' +
         objectTable("Objects by object, boxes with IoU of 0.8", evaluation.by_box);
}

std::string toJson(const MapEvaluation& evaluation) {
  Json json{{"primitives_by_point", pointJson(evaluation.primitives)},
            {"objects_by_point", pointJson(evaluation.objects)}};
  if (evaluation.has_instances) {
    json["objects_by_point_set"] = objectJson(evaluation.by_points);
    json["objects_by_box"] = objectJson(evaluation.by_box);
  }
  return json.dump(2);
}

}  // namespace cluxel::tasks
