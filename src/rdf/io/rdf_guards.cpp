// SPDX-License-Identifier: Apache-2.0
// Checks of a text before it is passed to raptor.
#include "rdf/io/rdf_guards.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <optional>

#include "base/ascii.hpp"
#include "base/utf8.hpp"
#include "cluxel/error.hpp"

namespace cluxel::rdf {

namespace {

// Raptor keeps the length of a language tag in one byte and reads beyond the tag when it is longer.
constexpr std::size_t kMaxTagBytes = 255;

[[noreturn]] void refuse(const RdfSource& source, const RdfPiece& piece, std::size_t at, const char* what,
                         const char* remedy = "") {
  SourceLocation location = locate(source.name, piece.text, at);
  location.line += static_cast<std::size_t>(piece.first_line - 1);
  throw InputError(std::move(location), what, remedy);
}

bool isTagByte(char c) {
  return isAsciiAlphanumeric(c) || c == '-';
}

void refuseLongTags(const RdfSource& source, const RdfPiece& piece) {
  const std::string_view text = piece.text;
  for (std::size_t at = text.find('@'); at != std::string_view::npos; at = text.find('@', at + 1)) {
    std::size_t length = 0;
    while (at + 1 + length < text.size() && isTagByte(text[at + 1 + length])) ++length;
    if (length > kMaxTagBytes) refuse(source, piece, at, "the language tag is longer than 255 bytes");
  }
}

/// The value of so many hexadecimal digits; absent when they are not there.
std::optional<std::uint32_t> hexAt(std::string_view text, std::size_t at, std::size_t digits) {
  std::uint32_t value = 0;
  const std::string_view number = text.substr(std::min(at, text.size()), digits);
  const auto [end, fault] = std::from_chars(number.data(), number.data() + number.size(), value, 16);
  if (number.size() != digits || fault != std::errc() || end != number.data() + digits) return std::nullopt;
  return value;
}

/// Raptor ends a text at an escaped zero, and makes bytes that are not UTF-8 of escaped surrogates.
void refuseEscapes(const RdfSource& source, const RdfPiece& piece) {
  const std::string_view text = piece.text;
  for (std::size_t at = text.find('\\'); at != std::string_view::npos; at = text.find('\\', at + 2)) {
    if (at + 1 == text.size()) return;
    const char kind = text[at + 1];
    if (kind != 'u' && kind != 'U') continue;
    const auto code_point = hexAt(text, at + 2, kind == 'u' ? 4 : 8);
    if (code_point == 0U) refuse(source, piece, at, "zero is no character of a text", "leave it out");
    if (code_point && *code_point >= 0xD800 && *code_point <= 0xDFFF)
      refuse(source, piece, at, "a surrogate is no character", "write the character itself, or \\U and eight digits");
  }
}

/// The last character of a line of N-Triples or N-Quads that is no blank, before a comment; 0 for a line without any.
char lastOfStatement(std::string_view line) {
  char last = 0;
  for (std::size_t at = 0; at < line.size() && line[at] != '#'; ++at) {
    const char c = line[at];
    if (c == ' ' || c == '\t') continue;
    last = c;
    if (c == '<') at = line.find('>', at);
    if (c == '"')
      for (++at; at < line.size() && line[at] != '"'; ++at)
        if (line[at] == '\\') ++at;
    if (at >= line.size()) return last;  // not closed
  }
  return last;
}

/// Raptor takes a statement without its full stop, so that of a file that was cut it reads another last statement.
void refuseLinesWithoutEnd(const RdfSource& source, const RdfPiece& piece) {
  const std::string_view text = piece.text;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find_first_of("\n\r", begin), text.size());
    const char last = lastOfStatement(text.substr(begin, end - begin));
    if (last != 0 && last != '.')
      refuse(source, piece, begin, "the statement does not end in a full stop", "the file may have been cut");
    begin = end + 1;
  }
}

/// In RDF/XML the tag is an attribute; entities and declared default values could hide its length.
void refuseLongXmlTags(const RdfSource& source, const RdfPiece& piece) {
  const std::string_view text = piece.text;
  if (const std::size_t at = text.find("<!ATTLIST"); at != std::string_view::npos)
    refuse(source, piece, at, "declared attributes are not supported", "write the attributes out");
  for (std::size_t at = text.find("xml:lang"); at != std::string_view::npos; at = text.find("xml:lang", at + 1)) {
    const std::size_t open = text.find_first_of("'\"", at);
    if (open == std::string_view::npos) return;
    const std::size_t close = std::min(text.find(text[open], open + 1), text.size());
    const std::string_view tag = text.substr(open + 1, close - open - 1);
    if (tag.size() > kMaxTagBytes || tag.find('&') != std::string_view::npos)
      refuse(source, piece, at, "the language tag is longer than 255 bytes, or is made with entities");
  }
}

}  // namespace

void refuseHostileText(const RdfSource& source, const RdfPiece& piece) {
  if (source.format == RdfFormat::RdfXml) return refuseLongXmlTags(source, piece);  // XML declares its encoding
  if (const auto offset = firstInvalidUtf8(piece.text))
    refuse(source, piece, *offset, "is not UTF-8", "save the file in UTF-8");
  if (const std::size_t zero = piece.text.find('\0'); zero != std::string_view::npos)
    refuse(source, piece, zero, "holds a zero byte, which no RDF text has");
  refuseLongTags(source, piece);
  refuseEscapes(source, piece);
  if (source.format == RdfFormat::NTriples || source.format == RdfFormat::NQuads) refuseLinesWithoutEnd(source, piece);
}

}  // namespace cluxel::rdf
