// SPDX-License-Identifier: Apache-2.0
// Charts in the unit square.
#include <algorithm>

#include "tasks/plots/plot_drawing.hpp"

namespace cluxel::tasks {

namespace {

/// A square whose lower left corner is (0, 0) and upper right corner (1, 1).
struct UnitSquare {
  PlotPoint corner;  ///< upper left, in the drawing
  double size = 0;

  PlotPoint at(const PlotPoint& p) const { return {corner.x + size * p.x, corner.y + size * (1 - p.y)}; }

  std::string frame(const std::string& x_name, const std::string& y_name) const {
    std::string text;
    for (const double tick : {0.0, 0.5, 1.0})
      text += drawnLine(at({tick, 0}), at({tick, 1}), "axis") + drawnLine(at({0, tick}), at({1, tick}), "axis") +
              drawnText({at({tick, 0}).x, corner.y + size + 16}, plotNumber(tick), "faint", "middle") +
              drawnText({corner.x - 6, at({0, tick}).y + 4}, plotNumber(tick), "faint", "end");
    const PlotPoint side{corner.x - 30, corner.y + size / 2};
    return text + drawnText({corner.x + size / 2, corner.y + size + 32}, x_name, "faint", "middle") +
           markupElement("text",
                         {{"transform", "translate(" + plotNumber(side.x) + " " + plotNumber(side.y) + ") rotate(-90)"},
                          {"class", "faint"},
                          {"text-anchor", "middle"}},
                         escapedText(y_name));
  }
};

/// Horizontal to the next point, then vertical: what lies between two thresholds was not measured.
std::string stepPath(const UnitSquare& square, const std::vector<PlotPoint>& points) {
  std::string path;
  for (const PlotPoint& point : points) {
    const PlotPoint p = square.at(point);
    path += path.empty() ? "M" + plotNumber(p.x, 1) + " " + plotNumber(p.y, 1)
                         : "H" + plotNumber(p.x, 1) + "V" + plotNumber(p.y, 1);
  }
  return markupElement("path", {{"class", "curve"}, {"d", path}});
}

std::string dot(const PlotPoint& at, const std::string& title) {
  return markupElement("circle", {{"cx", plotNumber(at.x)}, {"cy", plotNumber(at.y)}, {"r", "4"}, {"class", "mark"}},
                       markupElement("title", {}, escapedText(title)));
}

}  // namespace

std::string curveChart(const std::string& name, const std::string& x_name, const std::string& y_name,
                       const std::vector<PlotCurve>& curves) {
  constexpr double kSize = 140, kLeft = 44, kTop = 24, kStep = 210, kRow = 226;
  constexpr std::size_t kInRow = 4;
  std::string drawing;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const double left = kStep * static_cast<double>(i % kInRow) + kLeft;
    const double top = kRow * static_cast<double>(i / kInRow) + kTop;
    const UnitSquare square{{left, top}, kSize};
    drawing += drawnText({left, top - 8}, curves[i].label, "title") + square.frame(x_name, y_name) +
               stepPath(square, curves[i].points);
    if (curves[i].points.empty()) continue;
    const PlotPoint last = curves[i].points.back();
    drawing += dot(square.at(last), plotNumber(last.x) + ", " + plotNumber(last.y));
  }
  const double rows = static_cast<double>((curves.size() + kInRow - 1) / kInRow);
  return drawingOf(name, kStep * static_cast<double>(std::min(kInRow, curves.size())), kRow * rows, drawing);
}

std::string diagonalChart(const std::string& name, const std::string& x_name, const std::string& y_name,
                          const std::vector<PlotInterval>& points) {
  const UnitSquare square{{60, 12}, 300};
  std::string drawing = square.frame(x_name, y_name) + drawnLine(square.at({0, 0}), square.at({1, 1}), "rule");
  for (const PlotInterval& point : points)
    drawing += drawnLine(square.at({point.at.x, point.low}), square.at({point.at.x, point.high}), "whisker") +
               dot(square.at(point.at), plotNumber(point.at.x) + ", " + plotNumber(point.at.y));
  return drawingOf(name, 400, 356, drawing);
}

}  // namespace cluxel::tasks
