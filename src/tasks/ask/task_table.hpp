// SPDX-License-Identifier: Apache-2.0
// The tasks that a map answers by name: ways, searches and the shipped questions, with their parameters and columns.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "tasks/ask/task_answer.hpp"

namespace cluxel::tasks {

struct TaskParameter {
  enum class Kind : std::uint8_t { Number, WholeNumber, Class, Place, Text, Flag };
  std::string name, unit, default_value, help;  ///< without a default an absent value means what `help` says
  Kind kind = Kind::Text;
  bool is_required = false, may_repeat = false;
  double min = -std::numeric_limits<double>::infinity(), max = std::numeric_limits<double>::infinity();
};
/// "number", "whole number", "class", "place", "text", "flag".
const char* nameOf(TaskParameter::Kind kind);

using NamedValues = std::vector<std::pair<std::string, std::string>>;

/// The values of a task's parameters: those that were given, else the defaults.
class TaskValues {
 public:
  /// Throws Error (InvalidArgument) for an unknown name, a second value of a parameter that is no list, a missing value
  /// and a number that is none or out of range.
  TaskValues(std::span<const TaskParameter> parameters, const NamedValues& given);
  bool has(const std::string& name) const;
  std::string text(const std::string& name) const;
  double number(const std::string& name) const;
  std::size_t whole(const std::string& name) const { return static_cast<std::size_t>(number(name)); }
  bool flag(const std::string& name) const { return text(name) == "true"; }
  std::vector<std::string> all(const std::string& name) const;

 private:
  NamedValues values_;
};

/// What every run of a task takes besides its parameters.
struct TaskContext {
  const mapping::MapReader& map;
  bool with_reasons = false;
  sparql::QueryOptions query = {};  ///< budget of the shipped questions
};

struct Task {
  std::string name, title;  ///< title: the question in English
  std::vector<TaskParameter> parameters;
  std::vector<QueryColumn> columns;
  bool has_reasons = false;
  std::string file = {};  ///< of a shipped question, in queries/
  std::function<TaskAnswer(const TaskContext&, const TaskValues&)> run;
};

/// All tasks: route, reach, search and the like, then the shipped questions.
std::vector<Task> tasksOf(const std::vector<Question>& questions);
/// By name; "-" and "_" are one, and a question may be written as its file. Throws Error (NotFound).
const Task& taskNamed(std::span<const Task> tasks, const std::string& name);
/// Runs the task; the answer has its columns and tells whether it has reasons.
TaskAnswer answerOf(const Task& task, const TaskContext& context, const TaskValues& values);
/// Name, title, parameters and columns as a JSON array.
std::string taskListJson(std::span<const Task> tasks);

/// The parts of the table.
std::vector<Task> wayTasks();
std::vector<Task> surveyTasks();  ///< inventory, next-view, changes
Task questionTask(const Question& question);

}  // namespace cluxel::tasks
