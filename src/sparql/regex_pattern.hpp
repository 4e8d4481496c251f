// SPDX-License-Identifier: Apache-2.0
// XPath's regular expressions in PCRE2's words, where the two differ.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace cluxel::sparql {

/// White space of the flag x goes, but not from classes ('#' begins no comment); [a-z-[aeiou]] becomes an assertion and
/// a class; \w \W \s \S are XML Schema's. Nothing for a pattern with \i or \c, which mean something else to PCRE2, with
/// a bracket within a class, or with a class that does not end.
std::optional<std::string> pcrePattern(std::string_view xpath, bool ignores_space);

}  // namespace cluxel::sparql
