// SPDX-License-Identifier: Apache-2.0
// Drawings keep their size on wide screens and shrink on narrow ones.
#include "tasks/plots/plot_drawing.hpp"

namespace cluxel::tasks {

std::string drawingOf(const std::string& name, double width, double height, const std::string& content) {
  return markupElement("svg",
                       {{"xmlns", "http://www.w3.org/2000/svg"},
                        {"role", "img"},
                        {"aria-label", name},
                        {"width", plotNumber(width)},
                        {"height", plotNumber(height)},
                        {"viewBox", "0 0 " + plotNumber(width) + " " + plotNumber(height)}},
                       content);
}

std::string drawnText(const PlotPoint& at, const std::string& text, const std::string& style,
                      const std::string& anchor) {
  return markupElement("text",
                       {{"x", plotNumber(at.x)}, {"y", plotNumber(at.y)}, {"class", style}, {"text-anchor", anchor}},
                       escapedText(text));
}

std::string drawnLine(const PlotPoint& from, const PlotPoint& to, const std::string& style) {
  return markupElement("line", {{"x1", plotNumber(from.x)},
                                {"y1", plotNumber(from.y)},
                                {"x2", plotNumber(to.x)},
                                {"y2", plotNumber(to.y)},
                                {"class", style}});
}

std::string drawnBox(const PlotPoint& corner, double width, double height, const std::string& style) {
  return markupElement("rect", {{"x", plotNumber(corner.x)},
                                {"y", plotNumber(corner.y)},
                                {"width", plotNumber(width)},
                                {"height", plotNumber(height)},
                                {"class", style}});
}

}  // namespace cluxel::tasks
