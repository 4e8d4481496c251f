// SPDX-License-Identifier: Apache-2.0
// A cache of compiled regular expressions (XPath syntax and flags, by PCRE2).
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
  /// Null for a malformed pattern or unknown flags.
  const CompiledRegex* find(const std::string& pattern, const std::string& flags);

 private:
  std::map<std::pair<std::string, std::string>, std::unique_ptr<CompiledRegex>> compiled_;
};

/// Why a pattern with these flags is no regular expression; empty when it is one.
std::string regexFault(const std::string& pattern, const std::string& flags);
/// Throws Error (BudgetExceeded) when matching exceeds the step limit.
bool regexMatches(const CompiledRegex& regex, std::string_view text);
/// fn:replace; none when the pattern matches the empty string or the replacement is malformed.
std::optional<std::string> regexReplace(const CompiledRegex& regex, std::string_view text,
                                        std::string_view replacement);

}  // namespace cluxel::sparql
