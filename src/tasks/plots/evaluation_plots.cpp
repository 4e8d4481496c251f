// SPDX-License-Identifier: Apache-2.0
// Each figure has the numbers that it is drawn from as a table.
#include "tasks/plots/evaluation_plots.hpp"

#include <algorithm>

#include "tasks/evaluation/evaluation_shares.hpp"
#include "tasks/plots/plot_charts.hpp"

namespace cluxel::tasks {

namespace {

std::string shareText(const Share& share) {
  return share ? plotNumber(*share) : "-";
}

std::string shareText(const ObjectShare& share) {
  if (!share.share) return "-";
  return plotNumber(*share.share) + " (" + plotNumber(share.interval.low, 2) + " to " +
         plotNumber(share.interval.high, 2) + ")";
}

/// Rows with truth; columns with truth or answers, and "none".
PlotFigure confusionFigure(const std::string& id, const std::string& title, const ConfusionMatrix& matrix) {
  PlotFigure figure{id, title, "", "", "Points by class of the truth (rows) and answer (columns)", {{"truth"}, {}}};
  const std::size_t classes = matrix.names.size();
  PlotMatrix drawn;
  std::vector<std::size_t> columns;
  for (std::size_t i = 0; i < classes; ++i)
    if (matrix.truthCount(i) + matrix.answerCount(i) > 0) columns.push_back(i);
  columns.push_back(classes);
  for (const std::size_t i : columns) drawn.columns.push_back(i < classes ? matrix.names[i] : "none");
  for (std::size_t truth = 0; truth < classes; ++truth) {
    if (matrix.truthCount(truth) == 0) continue;
    drawn.rows.push_back(matrix.names[truth]);
    std::vector<std::string> row{matrix.names[truth]};
    for (const std::size_t i : columns) {
      drawn.counts.push_back(matrix.at(truth, i));
      row.push_back(std::to_string(matrix.at(truth, i)));
    }
    figure.table.rows.push_back(std::move(row));
  }
  figure.table.head.insert(figure.table.head.end(), drawn.columns.begin(), drawn.columns.end());
  figure.text =
      "Rows: class of the truth. Columns: answer of the map. Numbers: percent of the row's points. Overall "
      "accuracy " +
      plotNumber(matrix.overallAccuracy(), 4) + ", macro F1 " + plotNumber(matrix.macroF1(), 4) + ", macro IoU " +
      plotNumber(matrix.macroIou(), 4) + ", " + std::to_string(matrix.total()) + " points.";
  figure.svg = matrixChart(title, drawn);
  return figure;
}

PlotFigure classFigure(const std::string& id, const std::string& title, const ConfusionMatrix& matrix) {
  PlotFigure figure{id, title, "Shares of points.",
                    "", title, {{"class", "precision", "recall", "F1", "IoU", "points"}, {}}};
  std::vector<PlotBar> bars;
  for (std::size_t i = 0; i < matrix.names.size(); ++i) {
    if (matrix.truthCount(i) + matrix.answerCount(i) == 0) continue;
    const auto [precision, recall, f1, iou] = sharesOf(matrix, i);
    figure.table.rows.push_back({matrix.names[i], shareText(precision), shareText(recall), shareText(f1),
                                 shareText(iou), std::to_string(matrix.truthCount(i))});
    if (f1) bars.push_back({matrix.names[i], *f1, "F1 " + plotNumber(*f1)});
  }
  figure.svg = barChart(title, bars);
  return figure;
}

PlotFigure objectFigure(const std::string& id, const std::string& title, const std::vector<ObjectScore>& scores) {
  PlotFigure figure{
      id, title, "With 95 % intervals (Wilson).",
      "", title, {{"class", "precision", "recall", "F1", "true objects", "answers", "matched answers"}, {}}};
  for (const ObjectScore& score : scores) {
    if (score.truth + score.answers == 0) continue;
    const auto [precision, recall, f1] = sharesOf(score);
    figure.table.rows.push_back({score.name, shareText(precision), shareText(recall), shareText(f1),
                                 std::to_string(score.truth), std::to_string(score.answers),
                                 std::to_string(score.matched_answers)});
  }
  return figure;
}

PlotFigure curveFigure(const MapEvaluation& evaluation) {
  PlotFigure figure{"precision-recall",
                    "Precision and recall of objects by confidence",
                    "Each class: objects of at least some confidence, from the surest to all. A true object is found "
                    "when an object of its class shares half of their points. The dot is the map as it is.",
                    "",
                    "Objects of at least this confidence",
                    {{"class", "confidence", "answers", "right", "precision", "recall"}, {}}};
  std::vector<PlotCurve> curves;
  for (std::size_t i = 0; i < evaluation.by_points.size(); ++i) {
    const std::vector<PrecisionRecall> points = evaluation.precisionRecallOf(i);
    if (points.empty()) continue;
    PlotCurve curve{evaluation.by_points[i].name, {}};
    for (const PrecisionRecall& point : points) {
      curve.points.push_back({point.recall, point.precision});
      figure.table.rows.push_back({curve.label, plotNumber(point.confidence), std::to_string(point.answers),
                                   std::to_string(point.right), plotNumber(point.precision), plotNumber(point.recall)});
    }
    curves.push_back(std::move(curve));
  }
  if (!curves.empty()) figure.svg = curveChart(figure.title, "recall", "precision", curves);
  return figure;
}

PlotFigure calibrationFigure(const Calibration& calibration) {
  PlotFigure figure{
      "calibration",
      "Calibration of the confidence",
      "Objects but ground in tenths of confidence: share whose class is right, over the mean confidence, "
      "with 95 % intervals (Wilson). On the dashed line confidence is right. Expected calibration error " +
          plotNumber(calibration.expectedError()) + " over " + std::to_string(calibration.objects()) +
          " objects; exact confidences would measure " + plotNumber(calibration.errorByChance()) + " by chance.",
      "",
      "Objects by tenth of confidence",
      {{"confidence", "objects", "right", "mean confidence", "share right"}, {}}};
  std::vector<PlotInterval> points;
  for (std::size_t i = 0; i < calibration.bins.size(); ++i) {
    const CalibrationBin& bin = calibration.bins[i];
    const std::string tenth = plotNumber(0.1 * double(i), 1) + " to " + plotNumber(0.1 * double(i + 1), 1);
    if (bin.objects == 0) continue;
    const double objects = double(bin.objects), right = double(bin.right);
    const ShareInterval interval = wilsonInterval(right, objects);
    points.push_back({{bin.confidence_sum / objects, right / objects}, interval.low, interval.high});
    figure.table.rows.push_back({tenth, std::to_string(bin.objects), std::to_string(bin.right),
                                 plotNumber(bin.confidence_sum / objects), plotNumber(right / objects)});
  }
  if (!points.empty()) figure.svg = diagonalChart(figure.title, "mean confidence", "share right", points);
  return figure;
}

}  // namespace

PlotReport evaluationPlots(const MapEvaluation& evaluation, const std::vector<std::string>& maps) {
  PlotReport report{"Evaluation", {}, {}};
  std::string names = maps.size() == 1 ? "Map: " : "Maps, counts added: ";
  for (std::size_t i = 0; i < maps.size(); ++i) names += (i > 0 ? ", " : "") + maps[i];
  report.lines = {names};
  if (!evaluation.covers_all)
    report.lines.emplace_back("Only some objects are labelled: the precision of objects says little.");
  report.figures = {confusionFigure("confusion-objects", "Confusion of classes, by point", evaluation.objects),
                    classFigure("classes-objects", "Classes, by point", evaluation.objects),
                    confusionFigure("confusion-primitives", "Confusion of primitives, by point", evaluation.primitives),
                    classFigure("classes-primitives", "Primitives, by point", evaluation.primitives)};
  if (evaluation.has_instances) {
    report.figures.push_back(
        objectFigure("objects-by-points", "Objects found, point sets with IoU of at least 0.5", evaluation.by_points));
    report.figures.push_back(
        objectFigure("objects-by-box", "Objects found, boxes with IoU of at least 0.8", evaluation.by_box));
    report.figures.push_back(curveFigure(evaluation));
  }
  report.figures.push_back(calibrationFigure(evaluation.calibration));
  return report;
}

}  // namespace cluxel::tasks
