// SPDX-License-Identifier: Apache-2.0
// Translation of XPath regular expressions to PCRE2 syntax.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace cluxel::sparql {

/// With flag x, removes white space outside classes ('#' does not start a comment). Translates [a-z-[aeiou]] to a
/// lookahead and a class, and \w \W \s \S to the XML Schema classes. None for patterns with \i or \c (which PCRE2
/// interprets differently), a bracket inside a class, or an unterminated class.
std::optional<std::string> pcrePattern(std::string_view xpath, bool ignores_space);

}  // namespace cluxel::sparql
