// SPDX-License-Identifier: Apache-2.0
// How much of a faulty file a message shows: authored files are short, hostile ones need not be.
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include "cluxel/error.hpp"

namespace cluxel {

/// At most this number of errors, and of warnings, is listed; further ones are only counted.
inline constexpr std::size_t kMaxFaults = 200;

/// The diagnostic that gives the number of further faults.
inline Diagnostic furtherFaults(Severity severity, std::string file, std::size_t count) {
  Diagnostic further;
  further.severity = severity;
  further.location.file = std::move(file);
  further.message = std::to_string(count) + (severity == Severity::Error ? " further errors" : " further warnings");
  further.hint = "correct those above first";
  return further;
}

/// Line `line` (from 1) of `text`; empty for one that is longer than anyone could read.
inline std::string shownLine(std::string_view text, std::size_t line) {
  constexpr std::size_t kMaxShownBytes = 500;
  const std::string_view whole = lineOf(text, line);
  return whole.size() <= kMaxShownBytes ? std::string(whole) : std::string();
}

}  // namespace cluxel
