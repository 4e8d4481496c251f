// SPDX-License-Identifier: Apache-2.0
// All texts are escaped where they become markup, and nowhere else.
#include "tasks/plots/plot_page.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "base/text/short_number.hpp"

namespace cluxel::tasks {

namespace {

constexpr std::string_view kPlotStyle = R"(
:root { color-scheme: light dark; --ground: #fbfbfa; --text: #1d2226; --faint: #667078; --line: #d5d9dc;
  --mark: #1f6f9f; --second: #b4551d; }
@media (prefers-color-scheme: dark) {
  :root { --ground: #15191c; --text: #e6e9eb; --faint: #9aa4ab; --line: #384047; --mark: #6db6e0; --second: #eb9a63; }
}
body { background: var(--ground); color: var(--text); font: 15px/1.45 system-ui, sans-serif; margin: 0 auto;
  max-width: 72rem; padding: 1.5rem 1rem 4rem; }
h1 { font-size: 1.5rem; margin: 0 0 .5rem; } h2 { font-size: 1.1rem; margin: 2.5rem 0 .25rem; }
p { margin: .25rem 0; } figure { margin: .75rem 0 0; } .figure { overflow-x: auto; }
svg { display: block; }
text { fill: var(--text); font-size: 12px; } text.faint { fill: var(--faint); } text.title { font-weight: 600; }
.axis { stroke: var(--line); stroke-width: 1; fill: none; } .mark { fill: var(--mark); }
.curve { fill: none; stroke: var(--mark); stroke-width: 2; } .whisker { stroke: var(--mark); stroke-width: 1.5; }
.rule { fill: none; stroke: var(--second); stroke-width: 1.5; stroke-dasharray: 4 3; }
.middle { stroke: var(--ground); stroke-width: 2.5; } .cell { fill: var(--mark); stroke: var(--line); stroke-width: .5; }
text.strong { fill: var(--ground); }
details { margin: .5rem 0 0; overflow-x: auto; } summary { color: var(--faint); cursor: pointer; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; margin: .5rem 0; }
caption { color: var(--faint); text-align: left; } th, td { border-bottom: 1px solid var(--line);
  padding: .15rem .7rem; text-align: right; white-space: nowrap; }
th:first-child { text-align: left; } th { font-weight: 600; }
)";

std::string tableMarkup(const PlotTable& table, const std::string& name) {
  std::string head, body;
  for (const std::string& cell : table.head) head += markupElement("th", {{"scope", "col"}}, escapedText(cell));
  for (const std::vector<std::string>& row : table.rows) {
    std::string cells;
    for (std::size_t i = 0; i < row.size(); ++i)
      cells += i == 0 ? markupElement("th", {{"scope", "row"}}, escapedText(row[i]))
                      : markupElement("td", {}, escapedText(row[i]));
    body += markupElement("tr", {}, cells) + "\n";
  }
  return markupElement("table", {},
                       markupElement("caption", {}, escapedText(name)) +
                           markupElement("thead", {}, markupElement("tr", {}, head)) + "\n" +
                           markupElement("tbody", {}, body));
}

std::string figureMarkup(const PlotFigure& figure) {
  const std::string table = figure.table.rows.empty() ? "" : tableMarkup(figure.table, figure.table_name);
  const std::string drawing =
      figure.svg.empty() ? "" : markupElement("figure", {}, markupElement("div", {{"class", "figure"}}, figure.svg));
  const std::string numbers =
      drawing.empty() ? table
                      : markupElement("details", {}, markupElement("summary", {}, "The numbers as a table") + table);
  return markupElement("section", {{"id", figure.id}, {"aria-labelledby", figure.id + "-title"}},
                       markupElement("h2", {{"id", figure.id + "-title"}}, escapedText(figure.title)) +
                           markupElement("p", {}, escapedText(figure.text)) + drawing + numbers) +
         "\n";
}

/// As UTF-8: names of files may hold any bytes.
std::string validText(std::string_view text) {
  using nlohmann::json;
  return json::parse(json(std::string(text)).dump(-1, ' ', false, json::error_handler_t::replace)).get<std::string>();
}

}  // namespace

std::string escapedText(std::string_view text) {
  std::string escaped;
  for (const char c : validText(text)) {
    const bool is_control = static_cast<unsigned char>(c) < 0x20 && c != '\t' && c != '\n';
    if (is_control)
      escaped += "\xEF\xBF\xBD";
    else if (c == '&')
      escaped += "&amp;";
    else if (c == '<')
      escaped += "&lt;";
    else if (c == '>')
      escaped += "&gt;";
    else if (c == '"')
      escaped += "&quot;";
    else
      escaped += c;
  }
  return escaped;
}

std::string markupElement(std::string_view name, const MarkupAttributes& attributes, const std::string& content) {
  std::string text = "<" + std::string(name);
  for (const auto& [key, value] : attributes) text.append(" ").append(key).append("=\"" + escapedText(value) + "\"");
  return text + ">" + content + "</" + std::string(name) + ">";
}

std::string plotNumber(double value, int digits) {
  return shortNumber(value, digits);
}

std::string plotPage(const PlotReport& report) {
  std::string body = markupElement("h1", {}, escapedText(report.title)) + "\n";
  for (const std::string& line : report.lines) body += markupElement("p", {}, escapedText(line)) + "\n";
  for (const PlotFigure& figure : report.figures) body += figureMarkup(figure);
  const std::string policy = "default-src 'none'; style-src 'unsafe-inline'";
  return "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"/>"
         "<meta http-equiv=\"Content-Security-Policy\" content=\"" +
         policy + "\"/><meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>" +
         markupElement("title", {}, escapedText(report.title)) + markupElement("style", {}, std::string(kPlotStyle)) +
         "</head>\n" + markupElement("body", {}, markupElement("main", {}, body)) + "</html>\n";
}

}  // namespace cluxel::tasks
