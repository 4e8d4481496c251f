// SPDX-License-Identifier: Apache-2.0
// Copies a pattern, with other words for what PCRE2 reads differently.
#include "sparql/regex_pattern.hpp"

#include <algorithm>

namespace cluxel::sparql {
namespace {

constexpr std::string_view kSpace = " \t\r\n";
constexpr std::size_t kMostNesting = 16;   // of classes within classes

class PatternReader {
 public:
  PatternReader(std::string_view text, bool ignores_space) : text_(text), ignores_space_(ignores_space) {}

  std::optional<std::string> translated() {
    std::string out;
    while (at_ < text_.size()) {
      const char c = text_[at_++];
      if (c == '\\') {
        if (ignores_space_) at_ = std::min(text_.find_first_not_of(kSpace, at_), text_.size());
        if (!escape(out)) return std::nullopt;
      } else if (c == '[') {
        if (!characterClass(out, 0)) return std::nullopt;
      } else if (!ignores_space_ || kSpace.find(c) == std::string_view::npos) {
        out += c;
      }
    }
    return out;
  }

 private:
  char next() const { return at_ < text_.size() ? text_[at_] : '\0'; }

  /// What follows a backslash.
  bool escape(std::string& out) {
    if (std::string_view("iIcC").find(next()) != std::string_view::npos && at_ < text_.size()) return false;
    out += '\\';
    if (at_ < text_.size()) out += text_[at_++];
    return true;
  }

  /// What follows the bracket that opens a class. A bracket that closes it cannot come first.
  bool characterClass(std::string& out, std::size_t depth) {
    if (depth > kMostNesting) return false;
    std::string kept = "[", removed;
    if (next() == '^') kept += text_[at_++];
    for (bool first = true; at_ < text_.size(); first = false) {
      const char c = text_[at_++];
      if (c == ']' && !first) {
        kept += c;
        out += removed.empty() ? kept : "(?:(?!" + removed + ")" + kept + ")";
        return true;
      }
      if (c == '-' && next() == '[' && !first) {
        ++at_;
        if (!characterClass(removed, depth + 1) || next() != ']') return false;
      } else if (c == '\\') {
        if (!escape(kept)) return false;
      } else {
        kept += c;
      }
    }
    return false;
  }

  std::string_view text_;
  bool ignores_space_;
  std::size_t at_ = 0;
};

}  // namespace

std::optional<std::string> pcrePattern(std::string_view xpath, bool ignores_space) {
  return PatternReader(xpath, ignores_space).translated();
}

}  // namespace cluxel::sparql
