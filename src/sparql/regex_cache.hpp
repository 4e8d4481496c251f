// SPDX-License-Identifier: Apache-2.0
// Compiled regular expressions of one query: XPath's flags over PCRE2.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace cluxel::sparql {

struct CompiledRegex;

class RegexCache {
 public:
  RegexCache();
  ~RegexCache();
  /// Null for a faulty pattern or unknown flags.
  const CompiledRegex* find(const std::string& pattern, const std::string& flags);

 private:
  std::map<std::pair<std::string, std::string>, std::unique_ptr<CompiledRegex>> compiled_;
};

/// Throws Error (BudgetExceeded) when matching takes too many steps.
bool regexMatches(const CompiledRegex& regex, std::string_view text);
/// fn:replace; nothing when the pattern matches the empty text or the replacement is faulty.
std::optional<std::string> regexReplace(const CompiledRegex& regex, std::string_view text,
                                        std::string_view replacement);

}  // namespace cluxel::sparql
