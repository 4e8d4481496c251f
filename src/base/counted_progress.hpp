// SPDX-License-Identifier: Apache-2.0
// Progress of work that several threads share.
#pragma once

#include <cstddef>
#include <mutex>

#include "cluxel/progress.hpp"

namespace cluxel {

/// Counts finished units for a sink, from any thread.
class CountedProgress {
 public:
  CountedProgress(ProgressSink& sink, const char* stage, std::size_t total)
      : sink_(&sink), stage_(stage), total_(total) {}
  void step() {
    const std::lock_guard lock(mutex_);
    sink_->progress(stage_, ++done_, total_);
  }

 private:
  ProgressSink* sink_;
  const char* stage_;
  std::size_t done_ = 0, total_;
  std::mutex mutex_;
};

}  // namespace cluxel
