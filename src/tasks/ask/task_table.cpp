// SPDX-License-Identifier: Apache-2.0
// Names and values of tasks.
#include "tasks/ask/task_table.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/nearest_name.hpp"
#include "base/text/short_number.hpp"
#include "cluxel/error.hpp"
#include "tasks/finite_number.hpp"

namespace cluxel::tasks {

namespace {

[[noreturn]] void refuseValue(const std::string& name, const std::string& why) {
  throw Error(ErrorKind::InvalidArgument, "parameter " + name + ": " + why);
}

void checkNumber(const TaskParameter& parameter, const std::string& text) {
  const auto value = finiteNumber(text);
  const bool is_whole = parameter.kind == TaskParameter::Kind::WholeNumber;
  if (value && *value >= parameter.min && *value <= parameter.max && (!is_whole || *value == std::floor(*value)))
    return;
  std::string wanted = is_whole ? "write a whole number" : "write a number";
  if (!parameter.unit.empty() && parameter.unit != "1") wanted += " [" + parameter.unit + "]";
  if (std::isfinite(parameter.min)) wanted += " from " + shortNumber(parameter.min);
  if (std::isfinite(parameter.max)) wanted += " to " + shortNumber(parameter.max);
  refuseValue(parameter.name, wanted + ", not '" + text + "'");
}

void checkValue(const TaskParameter& parameter, const std::string& text) {
  if (text.empty()) refuseValue(parameter.name, "the value is empty");
  if (parameter.kind == TaskParameter::Kind::Flag && text != "true" && text != "false")
    refuseValue(parameter.name, "write true or false");
  if (parameter.kind == TaskParameter::Kind::Number || parameter.kind == TaskParameter::Kind::WholeNumber)
    checkNumber(parameter, text);
}

std::string plainTaskName(std::string name) {
  if (name.ends_with(".rq")) name.resize(name.size() - 3);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

}  // namespace

const char* nameOf(TaskParameter::Kind kind) {
  switch (kind) {
    case TaskParameter::Kind::Number:
      return "number";
    case TaskParameter::Kind::WholeNumber:
      return "whole number";
    case TaskParameter::Kind::Class:
      return "class";
    case TaskParameter::Kind::Place:
      return "place";
    case TaskParameter::Kind::Text:
      return "text";
    case TaskParameter::Kind::Flag:
      return "flag";
  }
  return "";
}

TaskValues::TaskValues(std::span<const TaskParameter> parameters, const NamedValues& given) {
  std::vector<std::string> names;
  for (const TaskParameter& parameter : parameters) names.push_back(parameter.name);
  for (const auto& [name, value] : given) {
    const auto place = std::find(names.begin(), names.end(), name);
    if (place == names.end()) {
      const std::string hint = names.empty() ? "the task has no parameters" : suggestion(name, names);
      refuseValue(name, "the task has no such parameter" + (hint.empty() ? "" : "; " + hint));
    }
    const TaskParameter& parameter = parameters[static_cast<std::size_t>(place - names.begin())];
    if (!parameter.may_repeat && has(name)) refuseValue(name, "it may be given once");
    checkValue(parameter, value);
    values_.emplace_back(name, value);
  }
  for (const TaskParameter& parameter : parameters) {
    if (has(parameter.name)) continue;
    if (parameter.is_required) refuseValue(parameter.name, "it is missing: " + parameter.help);
    if (!parameter.default_value.empty()) values_.emplace_back(parameter.name, parameter.default_value);
  }
}

bool TaskValues::has(const std::string& name) const {
  return std::any_of(values_.begin(), values_.end(), [&](const auto& value) { return value.first == name; });
}

std::string TaskValues::text(const std::string& name) const {
  const auto values = all(name);
  return values.empty() ? std::string() : values.front();
}

double TaskValues::number(const std::string& name) const {
  return finiteNumber(text(name)).value_or(0);
}

std::vector<std::string> TaskValues::all(const std::string& name) const {
  std::vector<std::string> found;
  for (const auto& [known, value] : values_)
    if (known == name) found.push_back(value);
  return found;
}

std::vector<Task> tasksOf(const std::vector<Question>& questions) {
  std::vector<Task> tasks = wayTasks();
  for (Task& task : surveyTasks()) tasks.push_back(std::move(task));
  for (const Question& question : questions) tasks.push_back(questionTask(question));
  return tasks;
}

const Task& taskNamed(std::span<const Task> tasks, const std::string& name) {
  std::vector<std::string> known;
  for (const Task& task : tasks) {
    if (plainTaskName(task.name) == plainTaskName(name)) return task;
    known.push_back(task.name);
  }
  std::string hint = suggestion(name, known);
  if (hint.empty()) {
    hint = "the tasks are";
    for (const std::string& other : known) hint += (&other == &known.front() ? " " : ", ") + other;
  }
  throw Error(ErrorKind::NotFound, "there is no task '" + name + "'; " + hint);
}

TaskAnswer answerOf(const Task& task, const TaskContext& context, const TaskValues& values) {
  TaskAnswer answer = task.run(context, values);
  if (answer.columns.empty()) answer.columns = task.columns;
  answer.has_reasons = context.with_reasons && task.has_reasons;
  return answer;
}

std::string taskListJson(std::span<const Task> tasks) {
  using nlohmann::ordered_json;
  ordered_json all = ordered_json::array();
  for (const Task& task : tasks) {
    ordered_json entry{{"name", task.name}, {"title", task.title}, {"reasons", task.has_reasons}};
    if (!task.file.empty()) entry["file"] = task.file;
    entry["parameters"] = ordered_json::array();
    for (const TaskParameter& p : task.parameters) {
      ordered_json parameter{{"name", p.name}, {"kind", nameOf(p.kind)}, {"unit", p.unit}, {"help", p.help}};
      if (!p.default_value.empty()) parameter["default"] = p.default_value;
      if (p.is_required) parameter["required"] = true;
      if (p.may_repeat) parameter["repeated"] = true;
      if (std::isfinite(p.min)) parameter["min"] = p.min;
      if (std::isfinite(p.max)) parameter["max"] = p.max;
      entry["parameters"].push_back(std::move(parameter));
    }
    entry["columns"] = ordered_json::array();
    for (const QueryColumn& c : task.columns)
      entry["columns"].push_back({{"name", c.name}, {"unit", c.unit}, {"help", c.help}});
    all.push_back(std::move(entry));
  }
  return all.dump(2);
}

}  // namespace cluxel::tasks
