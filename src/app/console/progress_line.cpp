// SPDX-License-Identifier: Apache-2.0
// Rates are means since the stage's first report: steady, and exact at the end.
#include "app/console/progress_line.hpp"

#include <cmath>
#include <cstdio>

namespace cluxel::app {

std::string durationText(double seconds) {
  constexpr double kMaxShown_s = 1e9;
  const auto whole = static_cast<long long>(std::lround(std::fmin(std::fmax(seconds, 0), kMaxShown_s)));
  char text[48];
  if (whole < 60)
    std::snprintf(text, sizeof text, "%lld s", whole);
  else if (whole < 3600)
    std::snprintf(text, sizeof text, "%lld min %02lld s", whole / 60, whole % 60);
  else
    std::snprintf(text, sizeof text, "%lld h %02lld min", whole / 3600, whole / 60 % 60);
  return text;
}

std::string ProgressMeter::line(std::string_view stage, std::size_t done, std::size_t total, double now_s) {
  const bool is_new = stage != stage_ || done < last_done_ || total != total_;
  if (is_new) {
    stage_ = stage;
    first_done_ = done;
    total_ = total;
    start_s_ = now_s;
  }
  last_done_ = done;
  std::string text = stage_ + " " + std::to_string(done) + "/" + std::to_string(total);
  if (total > 0 && done <= total) text += "  " + std::to_string(100 * done / total) + " %";
  const double elapsed_s = now_s - start_s_;
  if (elapsed_s < 1 || done <= first_done_) return text;
  const double rate = static_cast<double>(done - first_done_) / elapsed_s;
  char rate_text[32];
  std::snprintf(rate_text, sizeof rate_text, rate < 10 ? "%.1f" : "%.0f", rate);
  text += "  " + std::string(rate_text) + "/s";
  if (done < total) text += "  " + durationText(static_cast<double>(total - done) / rate) + " left";
  return text;
}

}  // namespace cluxel::app
