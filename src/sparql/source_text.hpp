// SPDX-License-Identifier: Apache-2.0
// The text of a request: checked, its \u and \U code points decoded, and places in it told to people.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cluxel/base/diagnostic.hpp"

namespace cluxel {

class SourceText {
 public:
  /// InputError when the text is longer than `max_bytes`, no UTF-8, or holds a zero byte. `original` must outlive it.
  SourceText(std::string_view original, std::string file, std::size_t max_bytes);

  /// What the lexer reads.
  std::string_view text() const { return decoded_.empty() ? original_ : std::string_view(decoded_); }
  std::string_view original() const { return original_; }
  /// The place in the original of a place in text().
  std::uint32_t originalOffset(std::uint32_t offset) const;
  [[noreturn]] void fail(std::uint32_t offset, std::string message, std::string hint) const;

 private:
  [[noreturn]] void failAtOriginal(std::size_t offset, std::string message, std::string hint) const;
  void decodeCodePoints();

  std::string_view original_;
  std::string file_;
  std::string decoded_;                                         ///< empty when there was nothing to decode
  std::vector<std::pair<std::uint32_t, std::uint32_t>> jumps_;  ///< from here in decoded_ on: this in original_
};

/// Throws InputError with the place of a byte of `text` and its line, as far as it can be shown.
[[noreturn]] void failAt(const std::string& file, std::string_view text, std::size_t offset, std::string message,
                         std::string hint);

/// Appends UTF-8.
void appendCodePoint(std::string& text, std::uint32_t code_point);

}  // namespace cluxel
