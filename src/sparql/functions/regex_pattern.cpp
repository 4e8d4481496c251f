// SPDX-License-Identifier: Apache-2.0
// Translates XPath regular expressions to PCRE2 syntax.
#include "sparql/functions/regex_pattern.hpp"

#include <algorithm>
#include <array>

namespace cluxel::sparql {
namespace {

constexpr std::string_view kSpace = " \t\r\n";
constexpr std::size_t kMaxClassNesting = 16;  // of classes within classes

/// The XML Schema class escapes, outside and inside brackets. PCRE2 differs: its \w includes the underscore but no
/// marks and symbols, its \s includes all Unicode spaces.
struct SharedEscape {
  char letter;
  std::string_view alone, in_class;
};
constexpr std::array<SharedEscape, 4> kSharedEscapes{{
    {'w', "[\\p{L}\\p{M}\\p{N}\\p{S}]", "\\p{L}\\p{M}\\p{N}\\p{S}"},
    {'W', "[\\p{P}\\p{Z}\\p{C}]", "\\p{P}\\p{Z}\\p{C}"},
    {'s', "[ \\t\\n\\r]", " \\t\\n\\r"},
    {'S', "[^ \\t\\n\\r]", "\\x{0}-\\x{8}\\x{B}\\x{C}\\x{E}-\\x{1F}\\x{21}-\\x{10FFFF}"},
}};

class PatternReader {
 public:
  PatternReader(std::string_view text, bool ignores_space) : text_(text), ignores_space_(ignores_space) {}

  std::optional<std::string> translated() {
    std::string out;
    while (at_ < text_.size()) {
      const char c = text_[at_++];
      if (c == '\\') {
        if (ignores_space_) at_ = std::min(text_.find_first_not_of(kSpace, at_), text_.size());
        if (!escape(out, false)) return std::nullopt;
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

  /// Translates an escape after the backslash.
  bool escape(std::string& out, bool in_class) {
    if (std::string_view("iIcC").find(next()) != std::string_view::npos && at_ < text_.size()) return false;
    const auto shared = std::find_if(kSharedEscapes.begin(), kSharedEscapes.end(), [this](const SharedEscape& escape) {
      return at_ < text_.size() && escape.letter == next();
    });
    if (shared != kSharedEscapes.end()) {
      out += in_class ? shared->in_class : shared->alone;
      ++at_;
      return true;
    }
    out += '\\';
    if (at_ < text_.size()) out += text_[at_++];
    return true;
  }

  /// Translates a class after its opening bracket. A closing bracket cannot come first.
  bool characterClass(std::string& out, std::size_t depth) {
    if (depth > kMaxClassNesting) return false;
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
        if (!escape(kept, true)) return false;
      } else if (c == '[') {
        return false;  // XML Schema has no POSIX classes such as [:alpha:]
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
