// SPDX-License-Identifier: Apache-2.0
// Scans lines in place with std::from_chars, which ignores locales and does not allocate.
#include "scan/formats/text_scanner.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "cluxel/error.hpp"
#include "scan/scan.hpp"

namespace cluxel::scan {

namespace {

constexpr std::size_t kMaxShownLine = 200;

bool isBlank(char c) {
  return c == ' ' || c == '\t' || c == ',';
}

}  // namespace

bool TextScanner::nextLine() {
  while (next_ != end_) {
    ++line_;
    start_ = next_;
    const void* newline = std::memchr(start_, '\n', static_cast<std::size_t>(end_ - start_));
    stop_ = newline ? static_cast<const char*>(newline) : end_;
    next_ = newline ? stop_ + 1 : end_;
    if (stop_ != start_ && stop_[-1] == '\r') --stop_;
    at_ = start_;
    if (!atLineEnd()) return true;
  }
  return false;
}

bool TextScanner::atLineEnd() {
  skipBlanks();
  return at_ == stop_ || *at_ == '#';
}

double TextScanner::number(const char* what) {
  skipBlanks();
  const char* from = at_;
  const double value = anyNumber(what);
  if (std::isfinite(value)) return value;
  at_ = from;
  refuse(std::string(what) + " is not finite: '" + wordAt() + "'");
}

double TextScanner::anyNumber(const char* what) {
  if (atLineEnd()) refuse(std::string("the line ends where ") + what + " was expected");
  if (checked_line_ != line_) checkCommas();
  const bool has_plus = *at_ == '+' && at_ + 1 != stop_ && at_[1] != '-';
  const char* from = has_plus ? at_ + 1 : at_;
  double value = 0;
  const auto [end, error] = std::from_chars(from, stop_, value);
  if (error == std::errc::result_out_of_range) refuse(std::string(what) + " is out of range: '" + wordAt() + "'");
  if (error != std::errc()) refuse(std::string(what) + " is not a number: '" + wordAt() + "'");
  endNumber(end, what);
  return value;
}

std::uint32_t TextScanner::count(const char* what) {
  if (atLineEnd()) refuse(std::string("the line ends where ") + what + " was expected");
  if (checked_line_ != line_) checkCommas();
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(at_, stop_, value);
  if (error != std::errc())
    refuse(std::string(what) + " is not a whole number from 0 to 4294967295: '" + wordAt() + "'");
  endNumber(end, what);
  return value;
}

std::uint32_t TextScanner::label(const char* what) {
  if (atLineEnd()) refuse(std::string("the line ends where ") + what + " was expected");
  if (checked_line_ != line_) checkCommas();
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(at_, stop_, value);
  if (error != std::errc() || value < -1 || value > kNoLabel)
    refuse(std::string(what) + " is not a whole number from 0 to 4294967294, or -1 for none: '" + wordAt() + "'");
  endNumber(end, what);
  return value < 0 ? kNoLabel : static_cast<std::uint32_t>(value);
}

void TextScanner::endNumber(const char* end, const char* what) {
  if (end != stop_ && !isBlank(*end) && *end != '#') refuse(std::string(what) + " is not a number: '" + wordAt() + "'");
  if (end == end_ && !trusts_last_number_)
    refuse("the file ends with " + std::string(what) + " '" + wordAt() + "', which may be cut",
           "copy the file again, or, when it is whole, end its last line with a line end");
  at_ = end;
}

/// From the first number of a line on. Two commas in a row mean a missing value.
void TextScanner::checkCommas() {
  checked_line_ = line_;
  if (std::memchr(at_, ',', static_cast<std::size_t>(stop_ - at_)) == nullptr) return;
  const char* const line_at = at_;
  if (std::memchr(start_, ',', static_cast<std::size_t>(at_ - start_)) != nullptr)
    refuse("a value is missing before the first comma of the line");
  bool has_gap = false, with_comma = false;
  for (const char* at = at_; at != stop_ && *at != '#';) {
    while (at != stop_ && !isBlank(*at) && *at != '#') ++at;
    const char* const gap = at;
    while (at != stop_ && isBlank(*at)) ++at;
    if (at == stop_ || *at == '#') break;
    const auto commas = std::count(gap, at, ',');
    at_ = gap;
    if (commas > 1) refuse("a value is missing between two commas");
    if (has_gap && with_comma != (commas == 1))
      refuse("the line mixes commas and blanks between numbers",
             "write decimals with a point, and separate numbers by blanks, or all of them by commas");
    has_gap = true;
    with_comma = commas == 1;
  }
  at_ = line_at;
}

std::string_view TextScanner::word(const char* what) {
  if (atLineEnd()) refuse(std::string("the line ends where ") + what + " was expected");
  const char* from = at_;
  while (at_ != stop_ && !isBlank(*at_)) ++at_;
  return {from, static_cast<std::size_t>(at_ - from)};
}

void TextScanner::endLine(const char* expected) {
  if (!atLineEnd()) refuse("unexpected '" + wordAt() + "'", std::string("a line holds ") + expected);
}

std::string TextScanner::wordAt() const {
  const char* to = at_;
  while (to != stop_ && !isBlank(*to) && to - at_ < 40) ++to;
  return {at_, to};
}

void TextScanner::refuse(const std::string& message, const std::string& hint) const {
  refuseAt(at_, message, hint);
}

void TextScanner::refuseWord(std::string_view word, const std::string& message) const {
  refuseAt(word.data(), message, {});
}

void TextScanner::refuseAt(const char* at, const std::string& message, const std::string& hint) const {
  Diagnostic diagnostic;
  diagnostic.location = {.file = file_, .line = line_, .column = static_cast<std::size_t>(at - start_) + 1};
  diagnostic.message = message;
  diagnostic.hint = hint;
  if (currentLine().size() <= kMaxShownLine) diagnostic.source_line = currentLine();
  throw InputError({diagnostic});
}

void TextScanner::refuseEnd(const std::string& message, const std::string& hint) const {
  throw InputError(locate(file_, text_, text_.size()), message, hint);
}

}  // namespace cluxel::scan
