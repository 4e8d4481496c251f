// SPDX-License-Identifier: Apache-2.0
// Prints answers of tasks.
#include "app/answer_output.hpp"

namespace cluxel::app {

namespace {

tasks::AnswerFormat formatIn(const AnswerOutput& output, const Session& session) {
  if (output.geojson) return tasks::AnswerFormat::GeoJson;
  if (output.format.empty()) return session.json ? tasks::AnswerFormat::Json : tasks::AnswerFormat::Table;
  return *tasks::answerFormatOf(output.format);
}

}  // namespace

void addAnswerOutput(CLI::App& command, AnswerOutput& output) {
  command.add_option("--format", output.format, "table, csv, json, geojson")
      ->check(CLI::IsMember({"table", "csv", "json", "geojson"}));
  command.add_flag("--geojson", output.geojson, "the same as --format geojson");
  command.add_flag("--local", output.local, "geojson in metres of the map frame, not in longitude and latitude");
}

ExitCode printAnswer(const mapping::MapReader& map, const tasks::TaskAnswer& answer, const AnswerOutput& output,
                     Session& session) {
  const tasks::ExportFrame frame = output.local ? tasks::ExportFrame::Local : tasks::ExportFrame::LongitudeLatitude;
  std::string text = answerText(map, answer, formatIn(output, session), frame);
  if (text.ends_with('\n')) text.pop_back();  // print() ends the line
  print(text);
  if (answer.is_negative) return ExitCode::NegativeFinding;
  return answer.rows.empty() ? ExitCode::NoRows : ExitCode::Done;
}

}  // namespace cluxel::app
