// SPDX-License-Identifier: Apache-2.0
// UTF-8 decoding and the ranges of name characters.
#include "sparql/character_class.hpp"

#include <algorithm>

namespace cluxel::character {

namespace {

struct Range {
  std::uint32_t first, last;
};

constexpr std::array<Range, 12> kNameStart{{{0xC0, 0xD6},
                                            {0xD8, 0xF6},
                                            {0xF8, 0x2FF},
                                            {0x370, 0x37D},
                                            {0x37F, 0x1FFF},
                                            {0x200C, 0x200D},
                                            {0x2070, 0x218F},
                                            {0x2C00, 0x2FEF},
                                            {0x3001, 0xD7FF},
                                            {0xF900, 0xFDCF},
                                            {0xFDF0, 0xFFFD},
                                            {0x10000, 0xEFFFF}}};

bool isContinuation(char c) {
  return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U;
}

}  // namespace

CodePoint decode(std::string_view text, std::size_t offset) {
  const auto first = static_cast<unsigned char>(text[offset]);
  if (first < 0x80) return {first, 1};
  const std::uint32_t bytes = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : first >= 0xC2 ? 2 : 0;
  if (bytes == 0 || first > 0xF4 || offset + bytes > text.size()) return {};
  std::uint32_t value = first & (0x7FU >> bytes);
  for (std::uint32_t i = 1; i < bytes; ++i) {
    if (!isContinuation(text[offset + i])) return {};
    value = (value << 6U) | (static_cast<unsigned char>(text[offset + i]) & 0x3FU);
  }
  constexpr std::array<std::uint32_t, 5> least{0, 0, 0x80, 0x800, 0x10000};
  const bool surrogate = value >= 0xD800 && value <= 0xDFFF;
  if (value < least[bytes] || value > 0x10FFFF || surrogate) return {};
  return {value, bytes};
}

bool isNameStart(std::uint32_t code_point) {
  return std::any_of(kNameStart.begin(), kNameStart.end(), [code_point](const Range& range) {
    return code_point >= range.first && code_point <= range.last;
  });
}

bool isNameExtra(std::uint32_t code_point) {
  return code_point == 0xB7 || (code_point >= 0x300 && code_point <= 0x36F) || code_point == 0x203F ||
         code_point == 0x2040;
}

std::size_t firstInvalidByte(std::string_view text) {
  const std::size_t zero = text.find('\0');
  for (std::size_t i = 0; i < text.size() && i < zero;) {
    if (static_cast<unsigned char>(text[i]) < 0x80) {
      ++i;
      continue;
    }
    const CodePoint code_point = decode(text, i);
    if (code_point.bytes == 0) return i;
    i += code_point.bytes;
  }
  return zero;
}

}  // namespace cluxel::character
