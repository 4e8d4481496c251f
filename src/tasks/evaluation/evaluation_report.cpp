// SPDX-License-Identifier: Apache-2.0
// An evaluation as tables for people.
#include <cstdio>
#include <span>

#include "tasks/evaluation/evaluation_shares.hpp"

namespace cluxel::tasks {

namespace {

std::string padded(std::string text, std::size_t width) {
  if (text.size() < width) text.append(width - text.size(), ' ');
  return text;
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

constexpr std::size_t kShareWidth = 22;

/// "   0.722 (0.49-0.88)  "
std::string cell(const ObjectShare& share) {
  char text[40];
  if (!share.share) return padded("       -", kShareWidth);
  std::snprintf(text, sizeof text, "%8.3f (%.2f-%.2f)", *share.share, share.interval.low, share.interval.high);
  return padded(text, kShareWidth);
}

std::string row(const ObjectScore& score, bool with_precision) {
  const auto [precision, recall, f1] = sharesOf(score);
  std::string text = padded(score.name, 18);
  if (with_precision) text += cell(precision);
  text += cell(recall);
  if (with_precision) text += cell(f1);
  return text + std::to_string(score.truth) + '\n';
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

/// With the limits of 95 % Wilson intervals.
std::string objectTable(const char* title, const std::vector<ObjectScore>& scores, bool with_precision) {
  std::string text = std::string(title) + "\n" + padded("class", 18);
  if (with_precision) text += padded("   precision", kShareWidth);
  text += padded("   recall", kShareWidth);
  if (with_precision) text += padded("   F1", kShareWidth);
  text += "objects\n";
  ObjectScore all{"all", 0, 0, 0, 0};
  for (const ObjectScore& score : scores) {
    all.truth += score.truth, all.answers += score.answers;
    all.matched_truth += score.matched_truth, all.matched_answers += score.matched_answers;
    if (score.truth + (with_precision ? score.answers : 0) > 0) text += row(score, with_precision);
  }
  return text + row(all, with_precision);
}

/// "StreetSign 13, none 5"
std::string countsText(const std::vector<std::uint64_t>& counts, const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] == 0) continue;
    if (!text.empty()) text += ", ";
    text += i < names.size() ? names[i] : i == names.size() ? "another class" : "none";
    text += ' ' + std::to_string(counts[i]);
  }
  return text;
}

std::string kindTable(const MapEvaluation& evaluation) {
  std::string text = "True objects by kind: the class of the object that is their partner by points (IoU of 0.5)\n";
  for (const KindAnswers& kind : evaluation.kinds)
    text += padded(kind.name, 18) + padded(std::to_string(kind.truth), 6) +
            countsText(kind.found, evaluation.objects.names) + '\n';
  text += "\nTrue objects by kind: the class of the object that has the most of their points\n";
  for (const KindAnswers& kind : evaluation.kinds)
    text += padded(kind.name, 18) + padded(std::to_string(kind.truth), 6) +
            countsText(kind.called, evaluation.objects.names) + '\n';
  return text;
}

std::string calibrationLine(const Calibration& calibration) {
  char line[200];
  std::snprintf(line, sizeof line,
                "Confidence of the class: expected calibration error %.3f over %llu objects (by chance alone %.3f)\n",
                calibration.expectedError(), static_cast<unsigned long long>(calibration.objects()),
                calibration.errorByChance());
  return line;
}

std::string crownLine(const CrownPairScore& score) {
  return "Trees whose crowns touch and whose trunks stand 2 m or more apart: " + std::to_string(score.parted) + " of " +
         std::to_string(score.pairs) + " pairs are separated\n";
}

}  // namespace

std::string toText(const MapEvaluation& evaluation) {
  std::string text = pointTable("Primitives by point", evaluation.primitives) + '\n' +
                     confusionTable(evaluation.primitives) + '\n' + pointTable("Objects by point", evaluation.objects) +
                     '\n' + confusionTable(evaluation.objects) + '\n';
  text += calibrationLine(evaluation.calibration) + '\n';
  if (!evaluation.has_instances) return text + "Objects by object: the truth has no instances.\n";
  if (!evaluation.covers_all)
    text += "Only some objects are labelled: points of others count neither way, and objects have no precision.\n\n";
  return text +
         objectTable("Objects by object, point sets with IoU of 0.5", evaluation.by_points, evaluation.covers_all) +
         '\n' + objectTable("Objects by object, boxes with IoU of 0.8", evaluation.by_box, evaluation.covers_all) +
         '\n' + kindTable(evaluation) + '\n' + crownLine(evaluation.crown_pairs);
}

}  // namespace cluxel::tasks
