// SPDX-License-Identifier: Apache-2.0
// Checks and decodes the text of a request before lexing (SPARQL 1.1, section 19.2).
#include "sparql/syntax/source_text.hpp"

#include <algorithm>
#include <charconv>
#include <optional>

#include "base/shown_line.hpp"
#include "base/utf8.hpp"
#include "sparql/syntax/character_class.hpp"

namespace cluxel::sparql {

namespace {

/// The code point of \uXXXX or \UXXXXXXXX at `offset`; none when digits are missing.
std::optional<std::uint32_t> escapedCodePoint(std::string_view text, std::size_t offset) {
  const std::size_t digits = text[offset + 1] == 'u' ? 4 : 8;
  if (offset + 2 + digits > text.size()) return std::nullopt;
  const char* begin = text.data() + offset + 2;
  std::uint32_t value = 0;
  if (!std::all_of(begin, begin + digits, character::isHexDigit)) return std::nullopt;
  std::from_chars(begin, begin + digits, value, 16);
  return value;
}

/// The first byte that is not UTF-8 or is zero; npos when there is none.
std::size_t firstInvalidByte(std::string_view text) {
  const std::size_t zero = text.find('\0');
  return firstInvalidUtf8(text.substr(0, zero)).value_or(zero);
}

}  // namespace

SourceText::SourceText(std::string_view original, std::string file, std::size_t max_bytes)
    : original_(original), file_(std::move(file)) {
  if (original.size() > max_bytes)
    throw InputError(
        {.file = file_},
        "the request has " + std::to_string(original.size()) + " bytes; the limit is " + std::to_string(max_bytes),
        "split it, or load data from a file instead of writing it into the request");
  const std::size_t invalid = firstInvalidByte(original);
  if (invalid != std::string_view::npos)
    failAtOriginal(invalid, original[invalid] == '\0' ? "the request holds a zero byte" : "this byte is not UTF-8",
                   "save the request as UTF-8 text");
  if (original.find("\\u") != std::string_view::npos || original.find("\\U") != std::string_view::npos)
    decodeCodePoints();
}

/// An escaped backslash is copied, so that "\\u0041" remains unchanged. The lexer reports escapes with too few digits.
void SourceText::decodeCodePoints() {
  decoded_.reserve(original_.size());
  for (std::size_t i = 0; i < original_.size();) {
    const char next = i + 1 < original_.size() ? original_[i + 1] : '\0';
    if (original_[i] != '\\' || (next != 'u' && next != 'U' && next != '\\')) {
      decoded_ += original_[i++];
      continue;
    }
    const std::optional<std::uint32_t> code_point = next == '\\' ? std::nullopt : escapedCodePoint(original_, i);
    if (!code_point) {
      decoded_.append(original_, i, 2);
      i += 2;
      continue;
    }
    if (*code_point == 0 || *code_point > 0x10FFFF || (*code_point >= 0xD800 && *code_point <= 0xDFFF))
      failAtOriginal(i, "this is no code point that text may hold", "surrogates and zero cannot be written");
    appendUtf8(decoded_, *code_point);
    i += next == 'u' ? 6 : 10;
    jumps_.emplace_back(static_cast<std::uint32_t>(decoded_.size()), static_cast<std::uint32_t>(i));
  }
}

std::uint32_t SourceText::originalOffset(std::uint32_t offset) const {
  const auto after = std::upper_bound(jumps_.begin(), jumps_.end(), offset,
                                      [](std::uint32_t place, const auto& jump) { return place < jump.first; });
  if (after == jumps_.begin()) return offset;
  const auto& [decoded, original] = *std::prev(after);
  return original + (offset - decoded);
}

void SourceText::fail(std::uint32_t offset, std::string message, std::string hint) const {
  failAtOriginal(originalOffset(offset), std::move(message), std::move(hint));
}

void SourceText::failAtOriginal(std::size_t offset, std::string message, std::string hint) const {
  failAt(file_, original_, offset, std::move(message), std::move(hint));
}

void failAt(const std::string& file, std::string_view text, std::size_t offset, std::string message, std::string hint,
            Remedy remedy) {
  constexpr std::size_t kMaxShownBytes = 240;
  Diagnostic diagnostic;
  diagnostic.location = locate(file, text, offset);
  diagnostic.message = std::move(message);
  diagnostic.hint = std::move(hint);
  const std::string_view line = lineOf(text, diagnostic.location.line);
  const bool valid = firstInvalidByte(line) == std::string_view::npos;
  const std::string_view shown = utf8Prefix(line, kMaxShownBytes);
  if (valid && diagnostic.location.column <= shown.size() + 1) diagnostic.source_line = shown;
  throw InputError({std::move(diagnostic)}, remedy);
}

Diagnostic warningAt(const std::string& file, std::string_view text, std::size_t offset, std::string message,
                     std::string hint) {
  Diagnostic diagnostic;
  diagnostic.severity = Severity::Warning;
  diagnostic.location = locate(file, text, offset);
  diagnostic.message = std::move(message);
  diagnostic.hint = std::move(hint);
  diagnostic.source_line = shownLine(text, diagnostic.location.line);
  return diagnostic;
}

}  // namespace cluxel::sparql
