// SPDX-License-Identifier: Apache-2.0
// What printf writes, without what does not read well.
#include "base/text/short_number.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace cluxel {

namespace {

constexpr double kFirstWithExponent = 1e15;

}  // namespace

std::string shortNumber(double value, int decimals) {
  constexpr int kMostDecimals = 17;
  if (std::isnan(value)) return "nan";
  std::array<char, 64> text{};
  if (!(std::abs(value) < kFirstWithExponent)) {
    std::snprintf(text.data(), text.size(), "%g", value);
    std::string number = text.data();
    number.erase(std::remove(number.begin(), number.end(), '+'), number.end());
    return number;
  }
  std::snprintf(text.data(), text.size(), "%.*f", std::clamp(decimals, 0, kMostDecimals), value);
  std::string number = text.data();
  if (number.find('.') != std::string::npos) number.erase(number.find_last_not_of('0') + 1);
  if (number.ends_with('.')) number.pop_back();
  return number == "-0" ? "0" : number;
}

}  // namespace cluxel
