// SPDX-License-Identifier: Apache-2.0
// A shipped question as a task: its rows get places from their columns x and y, or from the object that they name.
#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "mapping/facts/object_geometry.hpp"
#include "mapping/regions/whole_objects.hpp"
#include "rdf/map_iris.hpp"
#include "rdf/vocabulary.hpp"
#include "tasks/ask/task_table.hpp"
#include "tasks/explanation.hpp"

namespace cluxel::tasks {

namespace {

bool isNumberUnit(const std::string& unit) {
  return unit != "IRI" && unit != "text";
}

bool isNumeric(const Term& term) {
  if (term.kind != TermKind::Literal) return false;
  for (const char* type : {"integer", "decimal", "double", "float"})
    if (term.datatype == rdf::vocabulary::xsd(type)) return true;
  return false;
}

TaskCell cellOf(const Term* term) {
  if (term == nullptr) return std::monostate();
  if (isNumeric(*term)) return std::strtod(term->text.c_str(), nullptr);
  return term->text;
}

std::optional<std::size_t> columnNamed(const std::vector<QueryColumn>& columns, const std::string& name) {
  for (std::size_t c = 0; c < columns.size(); ++c)
    if (columns[c].name == name) return c;
  return std::nullopt;
}

/// The number of each object by its IRI.
std::map<std::string, std::uint32_t> objectsByIri(const mapping::MapReader& map) {
  std::map<std::string, std::uint32_t> by_iri;
  for (std::uint32_t i = 0; i < map.objectIds().size(); ++i) by_iri[rdf::iriOfObject(map.objectIds()[i])] = i;
  return by_iri;
}

std::optional<std::uint32_t> objectOfRow(const TaskRow& row, const std::map<std::string, std::uint32_t>& by_iri) {
  for (const TaskCell& cell : row.cells)
    if (const std::string* text = std::get_if<std::string>(&cell))
      if (const auto found = by_iri.find(*text); found != by_iri.end()) return found->second;
  return std::nullopt;
}

/// The place that the columns x and y of a row say.
std::optional<Eigen::Vector2d> placeInRow(const TaskAnswer& answer, const TaskRow& row) {
  const auto x = columnNamed(answer.columns, "x"), y = columnNamed(answer.columns, "y");
  if (!x || !y) return std::nullopt;
  const double *px = std::get_if<double>(&row.cells[*x]), *py = std::get_if<double>(&row.cells[*y]);
  if (px == nullptr || py == nullptr) return std::nullopt;
  return Eigen::Vector2d(*px, *py);
}

/// Gives each row its place: the one that it says, or that of its object. Objects are read region by region.
void placeRows(const mapping::MapReader& map, const std::vector<std::optional<std::uint32_t>>& object_of_row,
               TaskAnswer& answer) {
  std::vector<bool> is_wanted(map.objectIds().size(), false);
  std::multimap<std::uint32_t, std::size_t> rows_of_object;
  for (std::size_t i = 0; i < answer.rows.size(); ++i) {
    if (const auto place = placeInRow(answer, answer.rows[i])) {
      answer.rows[i].shape = {TaskShape::Kind::Point, {*place}};
    } else if (const auto object = object_of_row[i]) {
      rows_of_object.emplace(*object, i);
      is_wanted[*object] = true;
    }
  }
  if (rows_of_object.empty()) return;
  mapping::forEachWholeObject(map, is_wanted, [&](const mapping::WholeObject& whole) {
    const auto cluxels = mapping::cluxelsOf(whole.object);
    const Eigen::Vector2d place = mapping::geometryOf(whole.cluxels, cluxels).centroid.head<2>();
    const auto [first, end] = rows_of_object.equal_range(whole.number);
    for (auto row = first; row != end; ++row) answer.rows[row->second].shape = {TaskShape::Kind::Point, {place}};
  });
}

std::string measuredText(const nlohmann::json& step) {
  std::string text = step.value("passed", false) ? "yes  " : "no   ";
  text += step.value("test", "");
  if (!step.contains("measured") || !step["measured"].is_number()) return text;
  const double measured = std::round(step["measured"].get<double>() * 1e3) / 1e3;
  text += " (measured " + nlohmann::json(measured).dump();
  const std::string unit = step.value("unit", "");
  return text + (unit.empty() ? "" : " " + unit) + ")";
}

/// The accepted decision of an explanation in a few lines.
std::vector<std::string> reasonLines(const std::string& explanation) {
  const nlohmann::json json = nlohmann::json::parse(explanation);
  std::vector<std::string> lines;
  for (const nlohmann::json& decision : json.value("decisions", nlohmann::json::array())) {
    if (!decision.value("accepted", false)) continue;
    lines.push_back("rule " + decision.value("rule", "") + ":");
    for (const nlohmann::json& step : decision.value("path", nlohmann::json::array()))
      lines.push_back(measuredText(step));
    break;
  }
  return lines;
}

/// The header's columns in the order of the answer; a variable without a header line is a text.
std::vector<QueryColumn> columnsOf(const Question& question, const std::vector<std::string>& variables) {
  std::vector<QueryColumn> columns;
  for (const std::string& variable : variables) {
    const auto known = columnNamed(question.columns, variable);
    columns.push_back(known ? question.columns[*known] : QueryColumn{variable, "text", ""});
  }
  return columns;
}

TaskAnswer answerQuestionTask(const Question& question, const TaskContext& context, const TaskValues& values) {
  std::vector<std::string> given;
  for (const QueryParameter& parameter : question.parameters)
    given.push_back(parameter.name + "=" + values.text(parameter.name));
  const std::vector<sparql::Binding> bindings = bindingsFor(question, given);
  std::vector<std::string> names;
  for (const sparql::Binding& binding : bindings) names.push_back(binding.first);
  sparql::QueryOptions options = context.query;
  options.source_name = question.file.filename().string();
  const sparql::ResultTable table =
      sparql::PreparedQuery(context.map.quads(), question.text, options, names).evaluate(bindings).table;
  TaskAnswer answer{columnsOf(question, table.variables), {}};
  const auto by_iri = objectsByIri(context.map);
  const std::vector<std::string> explanations =
      context.with_reasons ? explainObjects(context.map) : std::vector<std::string>();
  std::vector<std::optional<std::uint32_t>> object_of_row;
  for (std::size_t i = 0; i < table.row_count; ++i) {
    TaskRow row;
    for (std::size_t c = 0; c < table.variables.size(); ++c) row.cells.push_back(cellOf(table.at(i, c)));
    const auto object = object_of_row.emplace_back(objectOfRow(row, by_iri));
    if (object && context.with_reasons) row.why = reasonLines(explanations[*object]);
    answer.rows.push_back(std::move(row));
  }
  placeRows(context.map, object_of_row, answer);
  return answer;
}

}  // namespace

Task questionTask(const Question& question) {
  Task task;
  task.name = question.file.stem().string();
  task.title = question.title;
  task.columns = question.columns;
  task.file = question.file.filename().string();
  task.has_reasons = std::any_of(question.columns.begin(), question.columns.end(), [](const QueryColumn& column) {
    return column.unit == "IRI" && column.name != "class";
  });
  for (const QueryParameter& p : question.parameters) {
    TaskParameter parameter;
    parameter.name = p.name;
    parameter.unit = p.unit;
    parameter.default_value = p.default_value;
    parameter.help = p.help;
    parameter.min = p.min;
    parameter.max = p.max;
    parameter.kind = isNumberUnit(p.unit) ? TaskParameter::Kind::Number : TaskParameter::Kind::Text;
    task.parameters.push_back(std::move(parameter));
  }
  task.run = [question](const TaskContext& context, const TaskValues& values) {
    return answerQuestionTask(question, context, values);
  };
  return task;
}

}  // namespace cluxel::tasks
