// SPDX-License-Identifier: Apache-2.0
// Writes the card as Markdown.
#include "tasks/evaluation/model_card.hpp"

#include <sstream>

namespace cluxel::tasks {

std::string modelCard(const perception::TrainingReport& report, const ModelCardText& text) {
  std::ostringstream card;
  card << "# Model `" << text.name << "`\n\nMade by\n\n```\n"
       << text.command << "\n```\n\n## Data\n\n"
       << text.data
       << "\n\n## Features\n\nThe feature groups and settings stand in `model.json`; docs/features.md tells what they "
          "mean.\n"
       << "\n## Figures on left-out groups, by point\n\nEach group was labelled by a unary that did not see it.\n\n"
       << toMarkdown(report.left_out) << "\nWithout the pairwise term:\n\n"
       << toMarkdown(report.left_out_unary) << "\nExpected calibration error: " << report.calibration_error_before
       << " before, " << report.calibration_error << " after calibration.\n";
  return card.str();
}

}  // namespace cluxel::tasks
