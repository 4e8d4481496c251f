// SPDX-License-Identifier: Apache-2.0
// Reads numbers from lines of text. '#' comments and empty lines are skipped; errors name line and column.
// Numbers of a line are separated by blanks, or each two of them by one comma: a decimal comma would shift the columns.
// A number that ends with the file may have been cut and is refused.
#pragma once

#include <charconv>
#include <cstdint>
#include <string>
#include <string_view>

#include "base/utf8.hpp"

namespace cluxel::scan {

class TextScanner {
 public:
  /// `text` must outlive the scanner; `file` is for messages. A byte order mark (written by Windows editors) is
  /// skipped.
  TextScanner(std::string_view text, std::string file)
      : next_(withoutByteOrderMark(text).data()),
        end_(text.data() + text.size()),
        text_(text),
        file_(std::move(file)) {}

  /// Goes to the next line with content; false at the end of the text.
  bool nextLine();
  /// True when nothing but blanks and a comment is left on the line.
  bool atLineEnd();
  /// The next number of the line, which must be finite; faults call it `what`.
  double number(const char* what);
  /// The next number of the line, which may be NaN or infinite.
  double anyNumber(const char* what);
  std::uint32_t count(const char* what);
  /// The next number of the line, a label; kNoLabel for -1.
  std::uint32_t label(const char* what);
  /// The next word of the line, ended by a blank.
  std::string_view word(const char* what);
  /// For a text whose last number has a known value: it need not be followed by a line end.
  void trustLastNumber() { trusts_last_number_ = true; }
  /// Refuses anything left on the line; `expected` says what a line holds.
  void endLine(const char* expected);

  std::size_t line() const { return line_; }
  std::string_view currentLine() const { return {start_, static_cast<std::size_t>(stop_ - start_)}; }
  const std::string& file() const { return file_; }
  /// Refuses the line at the current position.
  [[noreturn]] void refuse(const std::string& message, const std::string& hint = {}) const;
  /// Refuses a word of the line, at its first letter.
  [[noreturn]] void refuseWord(std::string_view word, const std::string& message) const;
  /// Refuses the file at its end.
  [[noreturn]] void refuseEnd(const std::string& message, const std::string& hint = {}) const;

 private:
  void skipBlanks() {
    while (at_ != stop_ && (*at_ == ' ' || *at_ == '\t' || *at_ == ',')) ++at_;
  }
  void endNumber(const char* end, const char* what);
  void checkCommas();
  std::string wordAt() const;
  [[noreturn]] void refuseAt(const char* at, const std::string& message, const std::string& hint) const;

  const char* next_;             ///< start of the next line
  const char* end_;              ///< end of the text
  const char* start_ = nullptr;  ///< start, current position and end of this line
  const char* at_ = nullptr;
  const char* stop_ = nullptr;
  std::size_t line_ = 0, checked_line_ = 0;
  bool trusts_last_number_ = false;
  std::string_view text_;
  std::string file_;
};

}  // namespace cluxel::scan
