// SPDX-License-Identifier: Apache-2.0
// Replaces from the end of the text to its start, so that places before a change stay valid.
#include "tasks/rule_fitting/rule_text_edit.hpp"

#include <algorithm>
#include <cmath>

#include "cluxel/error.hpp"
#include "tasks/rule_fitting/round_number.hpp"

namespace cluxel::tasks {

namespace {

std::size_t offsetOf(const std::string& text, const SourceLocation& at) {
  std::size_t offset = 0;
  for (std::size_t line = 1; line < at.line; ++line) {
    offset = text.find('\n', offset);
    if (offset == std::string::npos) break;
    ++offset;
  }
  if (offset == std::string::npos || offset + at.column > text.size() + 1)
    throw Error(ErrorKind::FaultyInput, toString(at) + ": the rule file ends before this place");
  return offset + at.column - 1;
}

}  // namespace

std::string writtenNumber(const FittedNumber& number) {
  return sixDigitText(number.is_share ? std::clamp(std::round(number.after * 1000) / 1000, 0.001, 0.999)
                                      : std::round(number.after * 1000) / 1000 + 0.0);
}

std::string withNumbers(const std::string& text, const std::string& file, std::vector<FittedNumber> changes) {
  std::erase_if(changes, [&](const FittedNumber& change) { return change.at.file != file; });
  std::sort(changes.begin(), changes.end(), [](const FittedNumber& a, const FittedNumber& b) {
    return std::pair(b.at.line, b.at.column) < std::pair(a.at.line, a.at.column);
  });
  std::string changed = text;
  for (const FittedNumber& change : changes) {
    const std::size_t first = offsetOf(changed, change.at);
    const std::size_t end = std::min(changed.find_first_not_of("+-.0123456789eE%", first), changed.size());
    if (end == first) throw Error(ErrorKind::FaultyInput, toString(change.at) + ": no number stands here");
    changed.replace(first, end - first, writtenNumber(change));
  }
  return changed;
}

}  // namespace cluxel::tasks
