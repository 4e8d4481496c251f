// SPDX-License-Identifier: Apache-2.0
// Character classes, case, white space and percent-encoding of ASCII text, independent of the locale.
#pragma once

#include <string>
#include <string_view>

namespace cluxel {

constexpr bool isAsciiDigit(char c) {
  return c >= '0' && c <= '9';
}
constexpr bool isAsciiLetter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}
constexpr bool isAsciiAlphanumeric(char c) {
  return isAsciiLetter(c) || isAsciiDigit(c);
}
constexpr char lowerAscii(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}
/// Other bytes than A to Z are kept.
std::string lowerCase(std::string_view text);

/// Strips blanks, tabs and line ends (XML's white space) at both ends.
std::string_view trimmed(std::string_view text);

/// RFC 3986: letters, digits, `-._~` and the characters of `also_kept` are kept, other bytes become %XX.
std::string percentEncoded(std::string_view text, std::string_view also_kept = {});

}  // namespace cluxel
