// SPDX-License-Identifier: Apache-2.0
// Serialises terms in the result formats, with escapes.
#include "sparql/results/term_text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>

#include "base/utf8.hpp"
#include "rdf/iri.hpp"
#include "sparql/syntax/character_class.hpp"

namespace cluxel::sparql {

namespace {

constexpr std::string_view kXsd = "http://www.w3.org/2001/XMLSchema#";
constexpr std::string_view kHexDigits = "0123456789ABCDEF";

enum Escape : std::uint8_t { kTurtleEscape = 1, kIriEscape = 2, kCsvQuote = 4, kJsonEscape = 8, kXmlEscape = 16 };

constexpr std::array<std::uint8_t, 256> makeEscapes() {
  std::array<std::uint8_t, 256> table{};
  const auto mark = [&table](std::string_view characters, std::uint8_t flag) {
    for (const char c : characters) table[static_cast<unsigned char>(c)] |= flag;
  };
  for (std::size_t c = 0; c < 0x20; ++c) table[c] = kTurtleEscape | kJsonEscape | kXmlEscape;
  for (std::size_t c = 0; c < 256; ++c) table[c] |= rdf::isForbiddenInIri(static_cast<char>(c)) ? kIriEscape : 0;
  table[0x7F] = kTurtleEscape;
  mark("\"\\", kTurtleEscape | kJsonEscape);
  mark("\",\r\n", kCsvQuote);
  mark("<>&\"", kXmlEscape);
  mark("\xEF", kXmlEscape);  // the first byte of U+FFFE and U+FFFF
  return table;
}
constexpr std::array<std::uint8_t, 256> kEscapes = makeEscapes();

bool needs(std::string_view value, std::uint8_t flag) {
  return std::any_of(value.begin(), value.end(),
                     [flag](char c) { return (kEscapes[static_cast<unsigned char>(c)] & flag) != 0; });
}

void appendHexEscape(std::string& text, unsigned char c) {
  text.append("\\u00") += kHexDigits[c >> 4U];
  text += kHexDigits[c & 15U];
}

void appendEscapedString(std::string& text, std::string_view value, std::uint8_t flag) {
  constexpr std::string_view special = "\t\b\n\r\f\"\\";
  constexpr std::string_view letters = "tbnrf\"\\";
  for (const char c : value) {
    if ((kEscapes[static_cast<unsigned char>(c)] & flag) == 0) {
      text += c;
      continue;
    }
    const std::size_t place = special.find(c);
    if (place == std::string_view::npos)
      appendHexEscape(text, static_cast<unsigned char>(c));
    else
      (text += '\\') += letters[place];
  }
}

void appendQuoted(std::string& text, std::string_view value, std::uint8_t flag) {
  text += '"';
  if (needs(value, flag))
    appendEscapedString(text, value, flag);
  else
    text.append(value);
  text += '"';
}

void appendIri(std::string& text, std::string_view iri) {
  text += '<';
  if (!needs(iri, kIriEscape)) {
    text.append(iri);
  } else {
    for (const char c : iri) {
      if ((kEscapes[static_cast<unsigned char>(c)] & kIriEscape) != 0)
        appendHexEscape(text, static_cast<unsigned char>(c));
      else
        text += c;
    }
  }
  text += '>';
}

bool isLabelByte(char c) {
  return character::is(c, character::kLetter | character::kDigit | character::kHigh) || c == '_';
}

/// Encodes characters that are not allowed in blank node labels as hexadecimal.
void appendBlank(std::string& text, std::string_view label) {
  text.append("_:");
  if (label.empty() || !isLabelByte(label[0])) text += 'b';
  for (const char c : label) {
    if (isLabelByte(c)) {
      text += c;
      continue;
    }
    const auto byte = static_cast<unsigned char>(c);
    ((text += "-") += kHexDigits[byte >> 4U]) += kHexDigits[byte & 15U];
  }
}

bool isXsd(const rdf::TermView& term, std::string_view local) {
  return term.datatype.size() == kXsd.size() + local.size() && term.datatype.starts_with(kXsd) &&
         term.datatype.ends_with(local);
}

std::size_t digitsAt(std::string_view text, std::size_t at) {
  std::size_t end = at;
  while (end < text.size() && character::is(text[end], character::kDigit)) ++end;
  return end - at;
}

/// True when the bare lexical form is Turtle shorthand for exactly this literal.
bool isBareLiteral(const rdf::TermView& term) {
  if (isXsd(term, "boolean")) return term.text == "true" || term.text == "false";
  const bool integer = isXsd(term, "integer");
  const bool decimal = !integer && isXsd(term, "decimal");
  if (!integer && !decimal && !isXsd(term, "double")) return false;
  const std::string_view text = term.text;
  std::size_t at = !text.empty() && (text[0] == '+' || text[0] == '-') ? 1 : 0;
  const std::size_t whole = digitsAt(text, at);
  at += whole;
  if (integer) return whole > 0 && at == text.size();
  const bool point = at < text.size() && text[at] == '.';
  const std::size_t fraction = point ? digitsAt(text, at + 1) : 0;
  if (point) at += 1 + fraction;
  if (decimal) return point && fraction > 0 && at == text.size();
  if (whole + fraction == 0 || at == text.size() || (text[at] != 'e' && text[at] != 'E')) return false;
  ++at;
  if (at < text.size() && (text[at] == '+' || text[at] == '-')) ++at;
  const std::size_t exponent = digitsAt(text, at);
  return exponent > 0 && at + exponent == text.size();
}

/// Writes a prefixed name with the longest matching namespace that leaves a valid local name; false if there is none.
bool appendShortIri(std::string& text, std::string_view iri, const PrefixList& prefixes, bool for_people) {
  const std::pair<std::string, std::string>* best = nullptr;
  for (const auto& candidate : prefixes)
    if (iri.starts_with(candidate.second) && (!best || candidate.second.size() > best->second.size()))
      best = &candidate;
  if (!best) return false;
  const std::string_view local = iri.substr(best->second.size());
  const bool plain = std::all_of(local.begin(), local.end(), [for_people](char c) {
    return character::is(c, character::kLetter | character::kDigit) || c == '_' || c == '-' || (for_people && c == '/');
  });
  if (!plain || local.starts_with('-')) return false;
  text.append(best->first).append(":").append(local);
  return true;
}

void appendLiteral(std::string& text, const rdf::TermView& term) {
  appendQuoted(text, term.text, kTurtleEscape);
  if (!term.language.empty())
    text.append("@").append(term.language);
  else if (!isXsd(term, "string"))
    appendIri(text.append("^^"), term.datatype);
}

}  // namespace

void appendNTriples(std::string& text, const rdf::TermView& term) {
  switch (term.kind) {
    case TermKind::Iri:
      return appendIri(text, term.text);
    case TermKind::BlankNode:
      return appendBlank(text, term.text);
    case TermKind::Literal:
      return appendLiteral(text, term);
  }
}

void appendTurtle(std::string& text, const rdf::TermView& term) {
  if (term.kind == TermKind::Literal && isBareLiteral(term))
    text.append(term.text);
  else
    appendNTriples(text, term);
}

void appendTurtle(std::string& text, const rdf::TermView& term, const PrefixList& prefixes) {
  if (term.kind == TermKind::Iri && appendShortIri(text, term.text, prefixes, false)) return;
  const bool typed = term.kind == TermKind::Literal && term.language.empty() && !isXsd(term, "string");
  std::string datatype;
  if (!typed || isBareLiteral(term) || !appendShortIri(datatype, term.datatype, prefixes, false))
    return appendTurtle(text, term);
  appendQuoted(text, term.text, kTurtleEscape);
  text.append("^^").append(datatype);
}

void appendCsv(std::string& text, const rdf::TermView& term) {
  if (term.kind == TermKind::BlankNode) return appendBlank(text, term.text);
  if (!needs(term.text, kCsvQuote)) {
    text.append(term.text);
    return;
  }
  text += '"';
  for (const char c : term.text) {
    if (c == '"') text += '"';
    text += c;
  }
  text += '"';
}

void appendJsonString(std::string& text, std::string_view value) {
  appendQuoted(text, value, kJsonEscape);
}

void appendJson(std::string& text, const rdf::TermView& term) {
  constexpr std::array<std::string_view, 3> types{"uri", "bnode", "literal"};
  text.append("{\"type\":\"").append(types[static_cast<std::size_t>(term.kind)]).append("\",\"value\":");
  if (term.kind == TermKind::BlankNode) {
    std::string label;
    appendBlank(label, term.text);
    appendJsonString(text, std::string_view(label).substr(2));
  } else {
    appendJsonString(text, term.text);
  }
  if (!term.language.empty()) {
    appendJsonString(text.append(",\"xml:lang\":"), term.language);
  } else if (term.kind == TermKind::Literal && !isXsd(term, "string")) {
    appendJsonString(text.append(",\"datatype\":"), term.datatype);
  }
  text += '}';
}

void appendXmlText(std::string& text, std::string_view value) {
  constexpr std::string_view replacement = "\xEF\xBF\xBD";
  if (!needs(value, kXmlEscape)) {
    text.append(value);
    return;
  }
  for (std::size_t i = 0; i < value.size(); ++i) {
    const char c = value[i];
    const std::string_view rest = value.substr(i, 3);
    if (rest == "\xEF\xBF\xBE" || rest == "\xEF\xBF\xBF") {
      text.append(replacement);
      i += 2;
    } else if (c == '<')
      text.append("&lt;");
    else if (c == '>')
      text.append("&gt;");
    else if (c == '&')
      text.append("&amp;");
    else if (c == '"')
      text.append("&quot;");
    else if (c == '\t' || c == '\n' || c == '\r')
      text.append("&#").append(std::to_string(c)).append(";");
    else if (static_cast<unsigned char>(c) < 0x20)
      text.append(replacement);
    else
      text += c;
  }
}

void appendXml(std::string& text, const rdf::TermView& term) {
  if (term.kind == TermKind::Iri) {
    appendXmlText(text.append("<uri>"), term.text);
    text.append("</uri>");
  } else if (term.kind == TermKind::BlankNode) {
    std::string label;
    appendBlank(label, term.text);
    text.append("<bnode>").append(label, 2).append("</bnode>");
  } else {
    text.append("<literal");
    if (!term.language.empty())
      text.append(" xml:lang=\"").append(term.language).append("\"");
    else if (!isXsd(term, "string")) {
      appendXmlText(text.append(" datatype=\""), term.datatype);
      text += '"';
    }
    appendXmlText(text += '>', term.text);
    text.append("</literal>");
  }
}

void appendPlain(std::string& text, const rdf::TermView& term, const PrefixList& prefixes) {
  if (term.kind == TermKind::BlankNode) return appendBlank(text, term.text);
  if (term.kind == TermKind::Iri) {
    if (!appendShortIri(text, term.text, prefixes, true)) text.append(term.text);
    return;
  }
  double number = 0;
  const char* end = term.text.data() + term.text.size();
  if (isXsd(term, "double") && std::from_chars(term.text.data(), end, number).ptr == end) {
    std::array<char, 32> digits{};
    const int length = std::snprintf(digits.data(), digits.size(), "%.10g", number);
    text.append(digits.data(), static_cast<std::size_t>(length));
    return;
  }
  for (std::size_t at = 0; at < term.text.size();) {
    const CodePoint point = decodeUtf8(term.text, at);
    const std::uint32_t bytes = std::max(point.bytes, 1U);
    text.append(isControl(point) ? " " : std::string_view(term.text).substr(at, bytes));
    at += bytes;
  }
  if (!term.language.empty()) text.append("@").append(term.language);
}

}  // namespace cluxel::sparql
