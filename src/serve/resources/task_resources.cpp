// SPDX-License-Identifier: Apache-2.0
// The table of tasks over HTTP: the same names, parameters and answers as `cluxel ask`.
#include <nlohmann/json.hpp>

#include "serve/http/refusal.hpp"
#include "serve/resources/answer_body.hpp"
#include "serve/resources/map_resources.hpp"
#include "tasks/ask/task_table.hpp"

namespace cluxel::serve {

namespace {

/// Parameters of the request that are not those of the task.
struct AnswerOptions {
  tasks::AnswerFormat format = tasks::AnswerFormat::Json;
  tasks::ExportFrame frame = tasks::ExportFrame::LongitudeLatitude;
  bool with_reasons = false;
};

AnswerOptions optionsIn(const Parameters& parameters) {
  AnswerOptions options;
  const std::string format = valueOf(parameters, "format").value_or("json");
  const auto known = tasks::answerFormatOf(format);
  if (!known) throw Refusal(400, "parameter format: write json, geojson, csv or table");
  options.format = *known;
  const std::string frame = valueOf(parameters, "frame").value_or("degrees");
  if (frame != "degrees" && frame != "local") throw Refusal(400, "parameter frame: write degrees or local");
  if (frame == "local") options.frame = tasks::ExportFrame::Local;
  const std::string why = valueOf(parameters, "why").value_or("false");
  if (why != "true" && why != "false") throw Refusal(400, "parameter why: write true or false");
  options.with_reasons = why == "true";
  return options;
}

const char* mediaTypeOf(tasks::AnswerFormat format) {
  switch (format) {
    case tasks::AnswerFormat::Table:
      return "text/plain; charset=utf-8";
    case tasks::AnswerFormat::Csv:
      return "text/csv; charset=utf-8";
    case tasks::AnswerFormat::Json:
      return "application/json";
    case tasks::AnswerFormat::GeoJson:
      return "application/geo+json";
  }
  return "";
}

}  // namespace

HttpResponse answerTaskList(const std::vector<tasks::Question>& questions) {
  return {200, "application/json", "{\"tasks\": " + taskListJson(tasksOf(questions)) + "}\n", {}};
}

HttpResponse answerTask(ServedMap& map, const ResourceRequest& asked, const std::vector<tasks::Question>& questions,
                        const std::string& name) {
  const std::vector<tasks::Task> all = tasksOf(questions);
  const tasks::Task& task = taskNamed(all, name);
  const AnswerOptions options = optionsIn(asked.target.parameters);
  tasks::NamedValues given;
  for (const auto& [parameter, value] : asked.target.parameters)
    if (parameter != "format" && parameter != "frame" && parameter != "why") given.emplace_back(parameter, value);
  const tasks::TaskValues values(task.parameters, given);
  LimitedBody body(asked.limits.max_answer_bytes);
  map.withReader([&](const mapping::MapReader& reader) {
    const tasks::TaskAnswer answer =
        answerOf(task, {reader, options.with_reasons, queryOptions(asked.limits, asked.request)}, values);
    body.add(answerText(reader, answer, options.format, options.frame));
  });
  return {200, mediaTypeOf(options.format), body.take(), {}};
}

}  // namespace cluxel::serve
