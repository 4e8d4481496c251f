// SPDX-License-Identifier: Apache-2.0
// Rows of labelled marks and matrices. Lengths are in pixels of the drawing.
#include "tasks/plots/plot_charts.hpp"

#include <algorithm>
#include <cmath>

#include "base/quantile.hpp"
#include "tasks/plots/plot_drawing.hpp"

namespace cluxel::tasks {

namespace {

constexpr double kRowHeight = 24, kLabelWidth = 150, kBarsWidth = 420;

std::string rowLabel(const std::string& label, double y) {
  return drawnText({kLabelWidth - 8, y + 16}, label, "", "end");
}

/// Of five roundish numbers from 0 to `most`, or fewer.
double tickStep(double most) {
  const double rough = std::max(most, 1e-9) / 5, power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (rough <= factor * power) return factor * power;
  return 10 * power;
}

std::string cellOf(const PlotMatrix& matrix, std::size_t row, std::size_t column, std::uint64_t row_total, double x,
                   double y, double size) {
  const std::uint64_t count = matrix.counts[row * matrix.columns.size() + column];
  const double share = row_total == 0 ? 0 : static_cast<double>(count) / static_cast<double>(row_total);
  std::string text = markupElement(
      "title", {}, escapedText(matrix.rows[row] + ", " + matrix.columns[column] + ": " + std::to_string(count)));
  const std::string square = markupElement("rect",
                                           {{"x", plotNumber(x)},
                                            {"y", plotNumber(y)},
                                            {"width", plotNumber(size)},
                                            {"height", plotNumber(kRowHeight)},
                                            {"class", "cell"},
                                            {"fill-opacity", plotNumber(share)}},
                                           text);
  if (count == 0) return square;
  const std::string percent = share < 0.01 ? "<1" : plotNumber(100 * share, 0);
  return square + drawnText({x + size / 2, y + 16}, percent, share > 0.5 ? "strong" : "", "middle");
}

}  // namespace

std::string matrixChart(const std::string& name, const PlotMatrix& matrix) {
  constexpr double kCell = 46, kHead = 110;
  std::string drawing;
  for (std::size_t c = 0; c < matrix.columns.size(); ++c) {
    const double x = kLabelWidth + kCell * static_cast<double>(c) + kCell / 2;
    drawing += markupElement(
        "text", {{"transform", "translate(" + plotNumber(x) + " " + plotNumber(kHead - 8) + ") rotate(-50)"}},
        escapedText(matrix.columns[c]));
  }
  for (std::size_t r = 0; r < matrix.rows.size(); ++r) {
    const double y = kHead + kRowHeight * static_cast<double>(r);
    std::uint64_t total = 0;
    for (std::size_t c = 0; c < matrix.columns.size(); ++c) total += matrix.counts[r * matrix.columns.size() + c];
    drawing += rowLabel(matrix.rows[r], y);
    for (std::size_t c = 0; c < matrix.columns.size(); ++c)
      drawing += cellOf(matrix, r, c, total, kLabelWidth + kCell * static_cast<double>(c), y, kCell);
  }
  return drawingOf(name, kLabelWidth + kCell * static_cast<double>(matrix.columns.size()) + 90,
                   kHead + kRowHeight * static_cast<double>(matrix.rows.size()) + 4, drawing);
}

std::string barChart(const std::string& name, const std::vector<PlotBar>& bars) {
  double most = 0;
  for (const PlotBar& bar : bars) most = std::max(most, bar.value);
  std::string drawing;
  for (std::size_t i = 0; i < bars.size(); ++i) {
    const double y = kRowHeight * static_cast<double>(i), length = most > 0 ? kBarsWidth * bars[i].value / most : 0;
    drawing += rowLabel(bars[i].label, y) + drawnBox({kLabelWidth, y + 3}, length, kRowHeight - 6, "mark") +
               drawnText({kLabelWidth + length + 6, y + 16}, bars[i].text, "faint");
  }
  return drawingOf(name, kLabelWidth + kBarsWidth + 130, kRowHeight * static_cast<double>(bars.size()) + 2, drawing);
}

PlotSpread spreadOf(const std::string& label, std::vector<double> values) {
  PlotSpread spread{label, values.size()};
  if (values.empty()) return spread;
  std::sort(values.begin(), values.end());
  spread.least = values.front(), spread.most = values.back();
  spread.lower = quantileOf(values, 0.25), spread.middle = quantileOf(values, 0.5);
  spread.upper = quantileOf(values, 0.75);
  return spread;
}

std::string spreadChart(const std::string& name, const std::string& unit, const std::vector<PlotSpread>& spreads) {
  double most = 0;
  for (const PlotSpread& spread : spreads) most = std::max(most, spread.most);
  const auto x = [&](double value) { return kLabelWidth + (most > 0 ? kBarsWidth * value / most : 0); };
  const double bottom = kRowHeight * static_cast<double>(spreads.size());
  std::string drawing;
  for (double tick = 0, step = tickStep(most); tick <= most + 1e-9; tick += step)
    drawing += drawnLine({x(tick), 0}, {x(tick), bottom + 4}, "axis") +
               drawnText({x(tick), bottom + 18}, plotNumber(tick), "faint", "middle");
  drawing += drawnText({kLabelWidth + kBarsWidth + 16, bottom + 18}, unit, "faint");
  for (std::size_t i = 0; i < spreads.size(); ++i) {
    const PlotSpread& spread = spreads[i];
    const double y = kRowHeight * static_cast<double>(i), middle = y + kRowHeight / 2;
    drawing +=
        rowLabel(spread.label, y) + drawnLine({x(spread.least), middle}, {x(spread.most), middle}, "whisker") +
        drawnBox({x(spread.lower), y + 5}, std::max(2.0, x(spread.upper) - x(spread.lower)), kRowHeight - 10, "mark") +
        drawnLine({x(spread.middle), y + 5}, {x(spread.middle), y + kRowHeight - 5}, "middle");
  }
  return drawingOf(name, kLabelWidth + kBarsWidth + 60, bottom + 24, drawing);
}

}  // namespace cluxel::tasks
