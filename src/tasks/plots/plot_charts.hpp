// SPDX-License-Identifier: Apache-2.0
// The drawings of figures as SVG. Colours come from the style of the page.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace cluxel::tasks {

/// Counts by row and column; each cell is as dark as its share of the row.
struct PlotMatrix {
  std::vector<std::string> rows, columns;
  std::vector<std::uint64_t> counts;  ///< row-major
};
std::string matrixChart(const std::string& name, const PlotMatrix& matrix);

struct PlotBar {
  std::string label;
  double value = 0;
  std::string text;  ///< printed after the bar
};
std::string barChart(const std::string& name, const std::vector<PlotBar>& bars);

/// Minimum, quartiles and maximum.
struct PlotSpread {
  std::string label;
  std::size_t count = 0;
  double least = 0, lower = 0, middle = 0, upper = 0, most = 0;
};
/// Of values in any order; all numbers are 0 without values. Quartiles are interpolated linearly.
PlotSpread spreadOf(const std::string& label, std::vector<double> values);
std::string spreadChart(const std::string& name, const std::string& unit, const std::vector<PlotSpread>& spreads);

struct PlotPoint {
  double x = 0, y = 0;
};
/// Points in the unit square, drawn as steps.
struct PlotCurve {
  std::string label;
  std::vector<PlotPoint> points;
};
/// A small square for each curve.
std::string curveChart(const std::string& name, const std::string& x_name, const std::string& y_name,
                       const std::vector<PlotCurve>& curves);

/// A point of a reliability diagram with an interval of y.
struct PlotInterval {
  PlotPoint at;
  double low = 0, high = 0;
};
/// With the diagonal on which the points should lie.
std::string diagonalChart(const std::string& name, const std::string& x_name, const std::string& y_name,
                          const std::vector<PlotInterval>& points);

}  // namespace cluxel::tasks
