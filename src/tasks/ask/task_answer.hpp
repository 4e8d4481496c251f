// SPDX-License-Identifier: Apache-2.0
// The answer of a task: rows with places and reasons, and its forms as text.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "mapping/map_reader.hpp"
#include "tasks/export/map_export.hpp"
#include "tasks/query_source.hpp"

namespace cluxel::tasks {

/// Absent, a number in the unit of its column, or a text. IRIs are written in full.
using TaskCell = std::variant<std::monostate, double, std::string>;

/// Where a row is [m, map].
struct TaskShape {
  enum class Kind : std::uint8_t { None, Point, Line, Area };
  Kind kind = Kind::None;
  /// Of Area: pairs of opposite corners of axis-parallel rectangles.
  std::vector<Eigen::Vector2d> places = {};
};

struct TaskRow {
  std::vector<TaskCell> cells;  ///< parallel to the columns
  TaskShape shape = {};
  std::vector<std::string> why = {};      ///< reasons, a line each; only where they were asked for
  std::vector<Eigen::Vector2d> way = {};  ///< of a tour: from the row before to this one [m, map]
};

struct TaskAnswer {
  std::vector<QueryColumn> columns;
  std::vector<TaskRow> rows;
  std::vector<std::string> notes = {};  ///< about the whole answer: why there is no route
  bool has_reasons = false;             ///< reasons were asked for, and the task gives them
  bool is_negative = false;             ///< the answer is "no", as for a place to which no way leads
};

enum class AnswerFormat : std::uint8_t { Table, Csv, Json, GeoJson };
/// By name: table, csv, json, geojson.
std::optional<AnswerFormat> answerFormatOf(std::string_view name);

/// Table: columns with units, then notes; reasons are indented below their row. Csv: RFC 4180, with a header; reasons
/// are the lines of a last column `why`, notes have no place. Json: rows as objects, with geometry and way in metres of
/// the map frame. GeoJson: a feature for each row, in `frame`, with the geometry null where the row has no place; notes
/// are a member of the collection (RFC 7946, section 6.1). Throws as writeFootprints(). All end with a line end.
std::string answerText(const mapping::MapReader& map, const TaskAnswer& answer, AnswerFormat format,
                       ExportFrame frame = ExportFrame::LongitudeLatitude);
/// Whether people see the notes where they see the rows. Csv has none, and most readers of GeoJson skip them.
bool showsNotes(AnswerFormat format);

}  // namespace cluxel::tasks
