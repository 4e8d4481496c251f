// SPDX-License-Identifier: Apache-2.0
// The line of text that shows how far a stage is.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace cluxel::app {

/// "45 s", "3 min 05 s", "2 h 07 min".
std::string durationText(double seconds);

/// Measures the rate of the running stage. The clock is passed in, in seconds from any start.
class ProgressMeter {
 public:
  /// "reading 30/120  25 %  2.5/s  36 s left". Rate and time left need a second of the same stage to be known.
  std::string line(std::string_view stage, std::size_t done, std::size_t total, double now_s);

 private:
  std::string stage_;
  std::size_t first_done_ = 0, last_done_ = 0, total_ = 0;
  double start_s_ = 0;
};

}  // namespace cluxel::app
