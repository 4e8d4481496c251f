// SPDX-License-Identifier: Apache-2.0
// The checked text of a request with decoded \u and \U escapes, and error locations in it.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cluxel/error.hpp"

namespace cluxel::sparql {

class SourceText {
 public:
  /// Throws InputError when the text is longer than `max_bytes`, is not UTF-8, or contains a zero byte. `original` must
  /// outlive the object.
  SourceText(std::string_view original, std::string file, std::size_t max_bytes);

  /// The decoded text.
  std::string_view text() const { return decoded_.empty() ? original_ : std::string_view(decoded_); }
  std::string_view original() const { return original_; }
  /// Maps an offset in text() to an offset in original().
  std::uint32_t originalOffset(std::uint32_t offset) const;
  [[noreturn]] void fail(std::uint32_t offset, std::string message, std::string hint) const;

 private:
  [[noreturn]] void failAtOriginal(std::size_t offset, std::string message, std::string hint) const;
  void decodeCodePoints();

  std::string_view original_;
  std::string file_;
  std::string decoded_;  ///< empty when there are no escapes
  std::vector<std::pair<std::uint32_t, std::uint32_t>>
      jumps_;  ///< offset in decoded_ and in original_ after each escape
};

/// Throws InputError with the location of a byte of `text` and, if printable, its line.
[[noreturn]] void failAt(const std::string& file, std::string_view text, std::size_t offset, std::string message,
                         std::string hint, Remedy remedy = Remedy::None);

/// A warning about a byte of `text`, with its line.
Diagnostic warningAt(const std::string& file, std::string_view text, std::size_t offset, std::string message,
                     std::string hint);

}  // namespace cluxel::sparql
