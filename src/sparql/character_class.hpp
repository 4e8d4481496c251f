// SPDX-License-Identifier: Apache-2.0
// The character classes of SPARQL's names (PN_CHARS_BASE and its kin), over UTF-8.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace cluxel::character {

enum Class : std::uint8_t {
  kSpace = 1,
  kDigit = 2,
  kLetter = 4,    ///< of PN_CHARS_BASE, below 128
  kNotInIri = 8,  ///< may not stand between < and >
  kHigh = 16      ///< part of a longer code point
};

constexpr std::array<std::uint8_t, 256> makeClasses() {
  std::array<std::uint8_t, 256> classes{};
  for (std::size_t c = 0; c <= 0x20; ++c) classes[c] = kNotInIri;
  for (const char c : {' ', '\t', '\r', '\n'}) classes[static_cast<unsigned char>(c)] |= kSpace;
  for (std::size_t c = '0'; c <= '9'; ++c) classes[c] = kDigit;
  for (std::size_t c = 'a'; c <= 'z'; ++c) classes[c] = kLetter;
  for (std::size_t c = 'A'; c <= 'Z'; ++c) classes[c] = kLetter;
  for (const char c : {'<', '>', '"', '{', '}', '|', '^', '`', '\\'})
    classes[static_cast<unsigned char>(c)] |= kNotInIri;
  for (std::size_t c = 128; c < 256; ++c) classes[c] = kHigh;
  return classes;
}
inline constexpr std::array<std::uint8_t, 256> kClasses = makeClasses();

constexpr bool is(char c, std::uint8_t classes) {
  return (kClasses[static_cast<unsigned char>(c)] & classes) != 0;
}
constexpr bool isHexDigit(char c) {
  return is(c, kDigit) || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F');
}

struct CodePoint {
  std::uint32_t value = 0;
  std::uint32_t bytes = 0;  ///< 0: the bytes there are no UTF-8
};

/// The code point at `offset`; refuses overlong forms, surrogates and what lies beyond U+10FFFF.
CodePoint decode(std::string_view text, std::size_t offset);

/// PN_CHARS_BASE above 127.
bool isNameStart(std::uint32_t code_point);
/// What PN_CHARS adds to it above 127; variables may hold it too.
bool isNameExtra(std::uint32_t code_point);

/// The first byte that belongs to no valid UTF-8, or that is zero; npos when all is well. Cost O(length).
std::size_t firstInvalidByte(std::string_view text);

}  // namespace cluxel::character
