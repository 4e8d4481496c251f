// SPDX-License-Identifier: Apache-2.0
// How long each stage of a build or change takes, for the history.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "cluxel/progress.hpp"

namespace cluxel::mapping {

/// Passes progress on, and measures it: the time since the last report, or since the start, belongs to the stage that
/// reports next.
class StageClock : public ProgressSink {
 public:
  explicit StageClock(ProgressSink& sink);
  void progress(std::string_view stage, std::size_t done, std::size_t total) override;
  void note(std::string_view message) override { sink_.note(message); }
  /// Seconds by stage, in the order of their first report.
  const std::vector<std::pair<std::string, double>>& seconds() const { return seconds_; }

 private:
  ProgressSink& sink_;
  double last_s_;
  std::vector<std::pair<std::string, double>> seconds_;
};

}  // namespace cluxel::mapping
