// SPDX-License-Identifier: Apache-2.0
// What a person should know of a trained model: data, command, figures.
#pragma once

#include <string>

#include "cluxel/perception/training.hpp"

namespace cluxel {

struct ModelCardText {
  std::string name, command, data;  ///< the command that makes it; what the data are, with their licence
};

/// Markdown with the figures on left-out groups.
std::string modelCard(const TrainingReport& report, const ModelCardText& text);

}  // namespace cluxel
