// SPDX-License-Identifier: Apache-2.0
// UTF-8: decoding, encoding, validation and cutting of text.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace cluxel {

struct CodePoint {
  std::uint32_t value = 0;
  std::uint32_t bytes = 0;  ///< 0 when the bytes are not UTF-8
};

/// Some editors begin UTF-8 files with it.
inline constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

/// The text after a byte order mark, if it begins with one.
constexpr std::string_view withoutByteOrderMark(std::string_view text) {
  return text.starts_with(kByteOrderMark) ? text.substr(kByteOrderMark.size()) : text;
}

constexpr bool isUtf8Continuation(char c) {
  return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U;
}

/// The code point at `offset`, which is less than the text's size. Overlong forms, surrogates and values above U+10FFFF
/// are not UTF-8 (Unicode 15, table 3-7).
CodePoint decodeUtf8(std::string_view text, std::size_t offset);

/// `code_point` is a Unicode scalar value.
void appendUtf8(std::string& text, std::uint32_t code_point);

/// The offset of the first byte that is not part of valid UTF-8. Cost O(length).
std::optional<std::size_t> firstInvalidUtf8(std::string_view text);

/// U+0000 to U+001F and U+007F to U+009F.
constexpr bool isControl(CodePoint point) {
  return point.bytes > 0 && (point.value < 0x20 || (point.value >= 0x7F && point.value < 0xA0));
}

/// For terminals: control characters but line feed and tab as \u001B, so that no text of a map moves the cursor or sets
/// colours.
std::string withoutControls(std::string_view text);

/// The number of code points of valid UTF-8.
std::size_t countCodePoints(std::string_view text);

/// The longest prefix of at most `max_bytes` bytes that does not end within a code point.
std::string_view utf8Prefix(std::string_view text, std::size_t max_bytes);

}  // namespace cluxel
