// SPDX-License-Identifier: Apache-2.0
// Scalar UTF-8 with a fast path for runs of ASCII.
#include "base/utf8.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>

namespace cluxel {

CodePoint decodeUtf8(std::string_view text, std::size_t offset) {
  const auto first = static_cast<unsigned char>(text[offset]);
  if (first < 0x80) return {first, 1};
  const std::uint32_t bytes = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : first >= 0xC2 ? 2 : 0;
  if (bytes == 0 || first > 0xF4 || bytes > text.size() - offset) return {};
  std::uint32_t value = first & (0x7FU >> bytes);
  for (std::uint32_t i = 1; i < bytes; ++i) {
    if (!isUtf8Continuation(text[offset + i])) return {};
    value = (value << 6U) | (static_cast<unsigned char>(text[offset + i]) & 0x3FU);
  }
  constexpr std::array<std::uint32_t, 5> min_value{0, 0, 0x80, 0x800, 0x10000};
  const bool surrogate = value >= 0xD800 && value <= 0xDFFF;
  if (value < min_value[bytes] || value > 0x10FFFF || surrogate) return {};
  return {value, bytes};
}

void appendUtf8(std::string& text, std::uint32_t c) {
  const auto byte = [&text](std::uint32_t value) { text += static_cast<char>(value); };
  if (c < 0x80) return byte(c);
  if (c < 0x800) {
    byte(0xC0U | (c >> 6U));
  } else if (c < 0x10000) {
    byte(0xE0U | (c >> 12U));
    byte(0x80U | ((c >> 6U) & 0x3FU));
  } else {
    byte(0xF0U | (c >> 18U));
    byte(0x80U | ((c >> 12U) & 0x3FU));
    byte(0x80U | ((c >> 6U) & 0x3FU));
  }
  byte(0x80U | (c & 0x3FU));
}

std::optional<std::size_t> firstInvalidUtf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    std::uint64_t eight = 0;
    if (i + 8 <= text.size()) {
      std::memcpy(&eight, text.data() + i, 8);
      if ((eight & 0x8080808080808080U) == 0) {
        i += 8;
        continue;
      }
    }
    const CodePoint code_point = decodeUtf8(text, i);
    if (code_point.bytes == 0) return i;
    i += code_point.bytes;
  }
  return std::nullopt;
}

std::string withoutControls(std::string_view text) {
  std::string shown;
  shown.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    const CodePoint point = decodeUtf8(text, at);
    const std::uint32_t value = point.value;
    if (isControl(point) && value != '\n' && value != '\t') {
      std::array<char, 8> escape{};
      std::snprintf(escape.data(), escape.size(), "\\u%04X", value);
      shown += escape.data();
    } else {
      shown.append(text.substr(at, std::max(point.bytes, 1U)));
    }
    at += std::max(point.bytes, 1U);
  }
  return shown;
}

std::size_t countCodePoints(std::string_view text) {
  return text.size() - static_cast<std::size_t>(std::count_if(text.begin(), text.end(), isUtf8Continuation));
}

std::string_view utf8Prefix(std::string_view text, std::size_t max_bytes) {
  if (text.size() <= max_bytes) return text;
  while (max_bytes > 0 && isUtf8Continuation(text[max_bytes])) --max_bytes;
  return text.substr(0, max_bytes);
}

}  // namespace cluxel
