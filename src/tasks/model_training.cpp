// SPDX-License-Identifier: Apache-2.0
// Groups of scans into places; figures into a card.
#include "cluxel/tasks/model_training.hpp"

#include <sstream>

#include "cluxel/base/diagnostic.hpp"

namespace cluxel {

namespace {

struct LabelledScans {
  std::vector<Scan> scans;
  std::vector<PointTruth> truth;
};

/// Scans and truth of `first` up to `last`, not included.
LabelledScans loadGroup(const ScanSet& scans, const TruthSource& truth, std::size_t first, std::size_t last) {
  LabelledScans group;
  for (std::size_t i = first; i < last; ++i) {
    group.scans.push_back(scans.load(i));
    group.truth.push_back(truth.truthOf(group.scans.back()));
  }
  return group;
}

void addPlace(const LabelledScans& scans, const ModelTrainingParams& params, unsigned threads, int group,
              std::vector<TrainingPlace>& places) {
  TrainingPlace place = makePlace(scans.scans, scans.truth, params.perception, threads);
  place.name = scans.scans.front().source;
  place.group = group;
  places.push_back(std::move(place));
}

}  // namespace

std::vector<TrainingPlace> trainingPlaces(const ScanSet& scans, const TruthSource& truth,
                                          const ModelTrainingParams& params, unsigned threads, ProgressSink& sink) {
  if (params.scans_per_group < 1) throw Error(ExitCode::Usage, "--scans-per-group must be at least 1");
  std::vector<TrainingPlace> places;
  const auto per_group = static_cast<std::size_t>(params.scans_per_group);
  const std::size_t step = params.together ? per_group : 1;
  for (std::size_t first = 0; first < scans.size(); first += step) {
    const std::size_t last = std::min(first + step, scans.size());
    const LabelledScans group = loadGroup(scans, truth, first, last);
    const int number = static_cast<int>(first / per_group);
    addPlace(group, params, threads, number, places);
    sink.progress("places", last, scans.size());
  }
  return places;
}

std::string modelCard(const TrainingReport& report, const ModelTrainingParams& params, const std::string& command,
                      const std::string& data) {
  std::ostringstream card;
  card << "# Model `" << params.name << "`\n\nMade by\n\n```\n" << command << "\n```\n\n## Data\n\n" << data
       << "\n\n## Features\n\nThe columns stand in `model.json` under `layout`; docs/features.md tells what they mean.\n"
       << "\n## Figures on left-out groups, by point\n\nEach group of " << params.scans_per_group
       << " consecutive scans was labelled by a unary that did not see it.\n\n"
       << toMarkdown(report.left_out) << "\nWithout the pairwise term:\n\n"
       << toMarkdown(report.left_out_unary) << "\nExpected calibration error: " << report.calibration_error_before
       << " before, " << report.calibration_error << " after calibration.\n";
  return card.str();
}

}  // namespace cluxel
