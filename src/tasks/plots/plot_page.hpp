// SPDX-License-Identifier: Apache-2.0
// Figures as one HTML file: SVG with a table of the same numbers, light and dark, without scripts.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace cluxel::tasks {

/// As the content of an element or attribute: "&lt;b&gt;" of "<b>". What XML cannot hold becomes U+FFFD.
std::string escapedText(std::string_view text);

using MarkupAttributes = std::vector<std::pair<std::string_view, std::string>>;

/// <name key="value">content</name>. Values are escaped; `content` is markup.
std::string markupElement(std::string_view name, const MarkupAttributes& attributes, const std::string& content = "");

/// At most `digits` decimals, without trailing zeros.
std::string plotNumber(double value, int digits = 3);

struct PlotTable {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;  ///< the first cell names the row
};

struct PlotFigure {
  std::string id, title;
  std::string text;        ///< what is seen: axes, units, definitions
  std::string svg;         ///< markup
  std::string table_name;  ///< of the table of the same numbers
  PlotTable table;
};

struct PlotReport {
  std::string title;
  std::vector<std::string> lines;  ///< below the title
  std::vector<PlotFigure> figures;
};

/// A whole HTML file, which is well-formed XML too.
std::string plotPage(const PlotReport& report);

}  // namespace cluxel::tasks
