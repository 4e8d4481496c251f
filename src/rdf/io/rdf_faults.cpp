// SPDX-License-Identifier: Apache-2.0
// Converts raptor's messages to diagnostics with locations.
#include "rdf/io/rdf_faults.hpp"

#include <algorithm>

#include "base/shown_line.hpp"

namespace cluxel::rdf {

namespace {

constexpr std::size_t kMaxShown = 50;  // raptor continues after a faulty line

/// The token that raptor quotes in a message: 'b' or "y:z".
std::string_view quotedIn(std::string_view message) {
  const std::size_t open = message.find_first_of("'\"");
  if (open == std::string_view::npos) return {};
  const std::size_t close = message.find(message[open], open + 1);
  return close == std::string_view::npos ? std::string_view{} : message.substr(open + 1, close - open - 1);
}

/// Raptor's Turtle parser reports no column. It follows from the quoted token if that occurs once in the line.
std::size_t columnOf(std::string_view line, std::string_view message) {
  const std::string_view token = quotedIn(message);
  const std::size_t at = token.empty() ? std::string_view::npos : line.find(token);
  return at == std::string_view::npos || line.find(token, at + 1) != std::string_view::npos ? 0 : at + 1;
}

/// Raptor 2.0.15 appends freed memory to this message.
std::string_view withoutRubbish(std::string_view message) {
  return message.starts_with("Illegal string escape") ? message.substr(0, message.find(" in \"")) : message;
}

std::string printable(std::string_view message) {
  std::string text(message);
  std::replace_if(
      text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; }, ' ');
  return text;
}

}  // namespace

void RdfFaults::add(std::size_t line, std::size_t column, std::string_view raw_message) {
  const std::string message = printable(withoutRubbish(raw_message));
  if (diagnostics_.size() >= kMaxShown) return;
  if (line == 0) {
    if (without_place_.empty()) without_place_ = message;
    return;
  }
  Diagnostic diagnostic;
  diagnostic.message = without_place_.empty() ? message : std::exchange(without_place_, {});
  diagnostic.source_line = lineNumbered(line);
  diagnostic.location = {.file = source_.name, .line = line, .column = column};
  if (column == 0) diagnostic.location.column = columnOf(diagnostic.source_line, diagnostic.message);
  const bool follows = std::any_of(diagnostics_.begin(), diagnostics_.end(),
                                   [&](const Diagnostic& earlier) { return earlier.location.line == line; });
  if (!follows) diagnostics_.push_back(std::move(diagnostic));
}

std::string RdfFaults::lineNumbered(std::size_t line) const {
  if (line >= piece_.first_line) {
    std::string found = shownLine(piece_.text, static_cast<std::size_t>(line - piece_.first_line + 1));
    if (!found.empty()) return found;
  }
  return text_.line(line);
}

void RdfFaults::throwIfAny() const {
  if (!diagnostics_.empty()) throw InputError(diagnostics_);
  if (!without_place_.empty()) throw InputError({.file = source_.name}, without_place_);
}

}  // namespace cluxel::rdf
