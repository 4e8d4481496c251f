// SPDX-License-Identifier: Apache-2.0
// From labelled scans to a model file with its card.
#pragma once

#include <filesystem>
#include <string>

#include "cluxel/base/progress.hpp"
#include "cluxel/perception/training.hpp"
#include "cluxel/scan/scan_set.hpp"
#include "cluxel/tasks/truth_source.hpp"

namespace cluxel {

struct ModelTrainingParams {
  std::string name;                  ///< of the model, in its file and card
  int scans_per_group = 2;           ///< consecutive scans that are left out together
  bool together = false;             ///< consecutive scans of a group overlap and are perceived together
  TrainParams train;
  PerceptionParams perception;
};

/// Reads all scans with their truth and makes places of them.
std::vector<TrainingPlace> trainingPlaces(const ScanSet& scans, const TruthSource& truth,
                                          const ModelTrainingParams& params, unsigned threads, ProgressSink& sink);

/// A model card in Markdown: data, settings, figures on left-out groups.
std::string modelCard(const TrainingReport& report, const ModelTrainingParams& params, const std::string& command,
                      const std::string& data);

}  // namespace cluxel
