// SPDX-License-Identifier: Apache-2.0
// The figures of an evaluation: confusion, precision and recall, calibration.
#pragma once

#include "tasks/evaluation/evaluation.hpp"
#include "tasks/plots/plot_page.hpp"

namespace cluxel::tasks {

/// `maps` are names for the page. The numbers are those of toJson(evaluation).
PlotReport evaluationPlots(const MapEvaluation& evaluation, const std::vector<std::string>& maps);

}  // namespace cluxel::tasks
