// SPDX-License-Identifier: Apache-2.0
// The character classes of SPARQL's grammar: PN_CHARS_BASE, PN_CHARS and what an IRI may hold.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "rdf/iri.hpp"

namespace cluxel::sparql::character {

enum Class : std::uint8_t {
  kSpace = 1,
  kDigit = 2,
  kLetter = 4,    ///< of PN_CHARS_BASE, below 128
  kNotInIri = 8,  ///< not allowed between < and >
  kHigh = 16      ///< part of a multi-byte code point
};

constexpr std::array<std::uint8_t, 256> makeClasses() {
  std::array<std::uint8_t, 256> classes{};
  for (std::size_t c = 0; c < 128; ++c) classes[c] = rdf::isForbiddenInIri(static_cast<char>(c)) ? kNotInIri : 0;
  for (const char c : {' ', '\t', '\r', '\n'}) classes[static_cast<unsigned char>(c)] |= kSpace;
  for (std::size_t c = '0'; c <= '9'; ++c) classes[c] = kDigit;
  for (std::size_t c = 'a'; c <= 'z'; ++c) classes[c] = kLetter;
  for (std::size_t c = 'A'; c <= 'Z'; ++c) classes[c] = kLetter;
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

/// PN_CHARS_BASE above 127.
bool isNameStart(std::uint32_t code_point);
/// The characters above 127 that PN_CHARS adds to PN_CHARS_BASE; also allowed in variable names.
bool isNameExtra(std::uint32_t code_point);

}  // namespace cluxel::sparql::character
