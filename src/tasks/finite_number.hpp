// SPDX-License-Identifier: Apache-2.0
// A text as a number.
#pragma once

#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

namespace cluxel::tasks {

/// The whole text, without blanks, as a finite number; absent when it is none.
inline std::optional<double> finiteNumber(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_read = error == std::errc() && end == text.data() + text.size() && std::isfinite(value);
  return is_read ? std::optional(value) : std::nullopt;
}

}  // namespace cluxel::tasks
