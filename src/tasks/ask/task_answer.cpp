// SPDX-License-Identifier: Apache-2.0
// Writes answers of tasks.
#include "tasks/ask/task_answer.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/csv_text.hpp"
#include "base/utf8.hpp"
#include "rdf/vocabulary.hpp"
#include "tasks/export/footprint_export.hpp"

namespace cluxel::tasks {

namespace {

using AnswerJson = nlohmann::ordered_json;

double roundedCell(double value) {
  constexpr double per_unit = 1e4;
  return std::round(value * per_unit) / per_unit + 0.0;  // + 0.0: -0 becomes 0
}

std::string numberText(double value) {
  std::array<char, 64> text{};
  const double rounded = roundedCell(value);
  const bool is_short = std::abs(rounded) < 1e15;  // people read 0.0003, not 3e-04
  const auto [end, error] =
      is_short ? std::to_chars(text.data(), text.data() + text.size(), rounded, std::chars_format::fixed)
               : std::to_chars(text.data(), text.data() + text.size(), rounded);
  return error == std::errc() ? std::string(text.data(), end) : std::string();
}

std::string shortIri(const std::string& text) {
  if (text.starts_with(rdf::vocabulary::kMap)) return "map:" + text.substr(rdf::vocabulary::kMap.size());
  if (text.starts_with(rdf::vocabulary::kClx)) return "clx:" + text.substr(rdf::vocabulary::kClx.size());
  return text;
}

std::string cellText(const TaskCell& cell, bool is_short) {
  if (const double* number = std::get_if<double>(&cell)) return numberText(*number);
  if (const std::string* text = std::get_if<std::string>(&cell)) return is_short ? shortIri(*text) : *text;
  return {};
}

void addPadded(std::string& line, const std::string& text, std::size_t width) {
  line += text;
  line.append(width - std::min(width, countCodePoints(text)) + 2, ' ');
}

void endLine(std::string& text) {
  while (text.ends_with(' ')) text.pop_back();
  text += '\n';
}

std::string headOf(const QueryColumn& column) {
  const bool has_unit = !column.unit.empty() && column.unit != "IRI" && column.unit != "text" && column.unit != "1";
  return has_unit ? column.name + " [" + column.unit + "]" : column.name;
}

std::string tableText(const TaskAnswer& answer) {
  std::vector<std::size_t> width;
  for (std::size_t c = 0; c < answer.columns.size(); ++c) {
    width.push_back(countCodePoints(headOf(answer.columns[c])));
    for (const TaskRow& row : answer.rows) width[c] = std::max(width[c], countCodePoints(cellText(row.cells[c], true)));
  }
  std::string text;
  if (!answer.rows.empty()) {
    for (std::size_t c = 0; c < width.size(); ++c) addPadded(text, headOf(answer.columns[c]), width[c]);
    endLine(text);
    for (const std::size_t w : width) addPadded(text, std::string(w, '-'), w);
    endLine(text);
  }
  for (const TaskRow& row : answer.rows) {
    for (std::size_t c = 0; c < width.size(); ++c) addPadded(text, cellText(row.cells[c], true), width[c]);
    endLine(text);
    for (const std::string& reason : row.why) text += "    " + reason + "\n";
  }
  for (const std::string& note : answer.notes) text += note + "\n";
  return text;
}

std::string csvLine(const std::vector<std::string>& fields) {
  std::string line;
  for (std::size_t c = 0; c < fields.size(); ++c) line += (c == 0 ? "" : ",") + csvField(fields[c]);
  return line + "\r\n";
}

std::string joinedLines(const std::vector<std::string>& lines) {
  std::string text;
  for (std::size_t i = 0; i < lines.size(); ++i) text += (i == 0 ? "" : "\n") + lines[i];
  return text;
}

std::string csvText(const TaskAnswer& answer) {
  std::vector<std::string> header;
  for (const QueryColumn& column : answer.columns) header.push_back(column.name);
  if (answer.has_reasons) header.emplace_back("why");
  std::string text = csvLine(header);
  for (const TaskRow& row : answer.rows) {
    std::vector<std::string> fields;
    for (std::size_t c = 0; c < answer.columns.size(); ++c) fields.push_back(cellText(row.cells[c], false));
    if (answer.has_reasons) fields.push_back(joinedLines(row.why));
    text += csvLine(fields);
  }
  return text;
}

AnswerJson cellJson(const TaskCell& cell) {
  if (const double* number = std::get_if<double>(&cell))
    return std::isfinite(*number) ? AnswerJson(roundedCell(*number)) : AnswerJson(nullptr);
  if (const std::string* text = std::get_if<std::string>(&cell)) return *text;
  return nullptr;
}

AnswerJson propertiesOfRow(const TaskAnswer& answer, const TaskRow& row) {
  AnswerJson json = AnswerJson::object();
  for (std::size_t c = 0; c < answer.columns.size(); ++c) json[answer.columns[c].name] = cellJson(row.cells[c]);
  if (!row.why.empty()) json["why"] = row.why;
  return json;
}

AnswerJson ringOf(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const PlaceWriter& position) {
  const Eigen::Vector2d low = a.cwiseMin(b), high = a.cwiseMax(b);
  AnswerJson ring = AnswerJson::array();
  for (const Eigen::Vector2d& corner :
       {low, Eigen::Vector2d(high.x(), low.y()), high, Eigen::Vector2d(low.x(), high.y()), low}) {
    const Eigen::Vector2d p = position(corner);
    ring.push_back({p.x(), p.y()});
  }
  return ring;
}

AnswerJson geometryJson(const TaskShape& shape, const PlaceWriter& position) {
  if (shape.kind == TaskShape::Kind::None) return nullptr;
  AnswerJson places = AnswerJson::array();
  if (shape.kind == TaskShape::Kind::Area) {
    for (std::size_t i = 0; i + 1 < shape.places.size(); i += 2)
      places.push_back(AnswerJson::array({ringOf(shape.places[i], shape.places[i + 1], position)}));
    return {{"type", "MultiPolygon"}, {"coordinates", std::move(places)}};
  }
  for (const Eigen::Vector2d& place : shape.places) {
    const Eigen::Vector2d p = position(place);
    places.push_back({p.x(), p.y()});
  }
  if (shape.kind == TaskShape::Kind::Point) return {{"type", "Point"}, {"coordinates", places.at(0)}};
  if (places.size() == 1) places.push_back(places.front());  // a LineString has two places or more
  return {{"type", "LineString"}, {"coordinates", std::move(places)}};
}

std::string jsonText(const mapping::MapReader& map, const TaskAnswer& answer) {
  const PlaceWriter position = placesIn(ExportFrame::Local, map.inputs());
  AnswerJson json{{"columns", AnswerJson::array()}, {"rows", AnswerJson::array()}, {"notes", answer.notes}};
  for (const QueryColumn& column : answer.columns)
    json["columns"].push_back({{"name", column.name}, {"unit", column.unit}, {"help", column.help}});
  for (const TaskRow& row : answer.rows) {
    AnswerJson entry = propertiesOfRow(answer, row);
    if (row.shape.kind != TaskShape::Kind::None) entry["geometry"] = geometryJson(row.shape, position);
    if (row.way.size() > 1) entry["way"] = geometryJson({TaskShape::Kind::Line, row.way}, position)["coordinates"];
    json["rows"].push_back(std::move(entry));
  }
  return json.dump(2, ' ', false, AnswerJson::error_handler_t::replace) + "\n";
}

std::string geoJsonText(const mapping::MapReader& map, const TaskAnswer& answer, ExportFrame frame) {
  const PlaceWriter position = placesIn(frame, map.inputs());
  AnswerJson collection{{"type", "FeatureCollection"}};
  if (frame == ExportFrame::Local) collection["frame"] = "map frame of Cluxel, metres: not longitude and latitude";
  if (!answer.notes.empty()) collection["notes"] = answer.notes;
  collection["features"] = AnswerJson::array();
  for (const TaskRow& row : answer.rows)
    collection["features"].push_back({{"type", "Feature"},
                                      {"geometry", geometryJson(row.shape, position)},
                                      {"properties", propertiesOfRow(answer, row)}});
  return collection.dump(1, ' ', false, AnswerJson::error_handler_t::replace) + "\n";
}

}  // namespace

std::optional<AnswerFormat> answerFormatOf(std::string_view name) {
  if (name == "table") return AnswerFormat::Table;
  if (name == "csv") return AnswerFormat::Csv;
  if (name == "json") return AnswerFormat::Json;
  if (name == "geojson") return AnswerFormat::GeoJson;
  return std::nullopt;
}

std::string answerText(const mapping::MapReader& map, const TaskAnswer& answer, AnswerFormat format,
                       ExportFrame frame) {
  switch (format) {
    case AnswerFormat::Table:
      return tableText(answer);
    case AnswerFormat::Csv:
      return csvText(answer);
    case AnswerFormat::Json:
      return jsonText(map, answer);
    case AnswerFormat::GeoJson:
      return geoJsonText(map, answer, frame);
  }
  return {};
}

bool showsNotes(AnswerFormat format) {
  return format == AnswerFormat::Table || format == AnswerFormat::Json;
}

}  // namespace cluxel::tasks
