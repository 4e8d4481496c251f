// SPDX-License-Identifier: Apache-2.0
// The card of a trained model: data, command, measured accuracy.
#pragma once

#include <string>

#include "perception/training/training.hpp"

namespace cluxel::tasks {

struct ModelCardText {
  std::string name, command, data;  ///< the command that makes it; what the data are, with their licence
};

/// Markdown with the figures on left-out groups.
std::string modelCard(const perception::TrainingReport& report, const ModelCardText& text);

}  // namespace cluxel::tasks
