// SPDX-License-Identifier: Apache-2.0
// The elements of drawings.
#pragma once

#include <string>

#include "tasks/plots/plot_charts.hpp"
#include "tasks/plots/plot_page.hpp"

namespace cluxel::tasks {

/// An image with a name for screen readers.
std::string drawingOf(const std::string& name, double width, double height, const std::string& content);
/// `anchor` is start, middle or end; `text` is escaped.
std::string drawnText(const PlotPoint& at, const std::string& text, const std::string& style = "",
                      const std::string& anchor = "start");
std::string drawnLine(const PlotPoint& from, const PlotPoint& to, const std::string& style);
std::string drawnBox(const PlotPoint& corner, double width, double height, const std::string& style);

}  // namespace cluxel::tasks
