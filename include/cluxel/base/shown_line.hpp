// SPDX-License-Identifier: Apache-2.0
// How much of a faulty file a message shows: authored files are short, hostile ones need not be.
#pragma once

#include <string>
#include <string_view>

#include "cluxel/base/diagnostic.hpp"

namespace cluxel {

/// So many faults of one file are told; who mends them meets the others.
inline constexpr std::size_t kMostFaults = 200;

/// Line `line` (from 1) of `text`; empty for one that is longer than anyone could read.
inline std::string shownLine(std::string_view text, std::size_t line) {
  constexpr std::size_t kLongestShown = 500;
  const std::string_view whole = lineOf(text, line);
  return whole.size() <= kLongestShown ? std::string(whole) : std::string();
}

}  // namespace cluxel
