// SPDX-License-Identifier: Apache-2.0
// Reports come at the end of work, from one thread at a time.
#include "mapping/build/stage_clock.hpp"

#include <algorithm>
#include <chrono>

namespace cluxel::mapping {

namespace {

double steadySeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

StageClock::StageClock(ProgressSink& sink) : sink_(sink), last_s_(steadySeconds()) {}

void StageClock::progress(std::string_view stage, std::size_t done, std::size_t total) {
  const double now_s = steadySeconds();
  auto place = std::find_if(seconds_.begin(), seconds_.end(), [&](const auto& known) { return known.first == stage; });
  if (place == seconds_.end()) place = seconds_.insert(seconds_.end(), {std::string(stage), 0.0});
  place->second += now_s - last_s_;
  last_s_ = now_s;
  sink_.progress(stage, done, total);
}

}  // namespace cluxel::mapping
