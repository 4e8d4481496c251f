// SPDX-License-Identifier: Apache-2.0
// Tries ever smaller steps until a multiple lies within the interval.
#include "tasks/rule_fitting/round_number.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace cluxel::tasks {

double roundestIn(double low, double high) {
  const double middle = (low + high) / 2;
  for (double power = 1e4; power > 1e-6; power /= 10)
    for (const double digit : {1.0, 0.5, 0.2}) {
      const double step = power * digit;
      const double nearest = std::round(middle / step) * step;
      if (low <= nearest && nearest <= high) return nearest;
    }
  return middle;
}

std::string sixDigitText(double value) {
  std::array<char, 64> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%.6g", value);
  return buffer.data();
}

}  // namespace cluxel::tasks
