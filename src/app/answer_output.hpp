// SPDX-License-Identifier: Apache-2.0
// The options for the form of a task's answer, and its printing.
#pragma once

#include <string>

#include "app/command.hpp"
#include "tasks/ask/task_answer.hpp"

namespace cluxel::app {

struct AnswerOutput {
  std::string format;
  bool local = false, geojson = false;
};

/// Adds --format, --geojson and --local.
void addAnswerOutput(CLI::App& command, AnswerOutput& output);
/// Prints, and tells whether the answer is "no" or has no rows.
ExitCode printAnswer(const mapping::MapReader& map, const tasks::TaskAnswer& answer, const AnswerOutput& output,
                     Session& session);

}  // namespace cluxel::app
