// SPDX-License-Identifier: Apache-2.0
// Constructs terms and writes them as canonical N-Triples and N-Quads.
#include "cluxel/term.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "base/ascii.hpp"
#include "rdf/io/ntriples_text.hpp"
#include "rdf/iri.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel {

namespace {

void appendHex(std::string& out, unsigned char byte) {
  constexpr std::string_view digits = "0123456789ABCDEF";
  out += "\\u00";
  out += digits[byte >> 4U];
  out += digits[byte & 15U];
}

/// Canonical N-Triples escapes only these four characters; other control characters are written verbatim.
void appendEscapedLiteral(std::string& out, std::string_view text) {
  for (const char c : text) {
    switch (c) {
      case '"':
        out += "\\\"";
        break;
      case '\\':
        out += "\\\\";
        break;
      case '\n':
        out += "\\n";
        break;
      case '\r':
        out += "\\r";
        break;
      default:
        out += c;
    }
  }
}

void appendEscapedIri(std::string& out, std::string_view iri) {
  for (const char c : iri) {
    if (rdf::isForbiddenInIri(c))
      appendHex(out, static_cast<unsigned char>(c));
    else
      out += c;
  }
}

/// XSD canonical form: at least one fraction digit, and an exponent without plus sign and leading zeros (1.5E-7).
std::string canonicalDouble(double value) {
  if (std::isnan(value)) return "NaN";
  if (std::isinf(value)) return value > 0 ? "INF" : "-INF";
  std::array<char, 40> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::scientific);
  const std::string_view digits(buffer.data(), static_cast<std::size_t>(end.ptr - buffer.data()));
  const std::size_t e = digits.find('e');
  std::string text(digits.substr(0, e));
  if (text.find('.') == std::string::npos) text += ".0";
  int exponent = 0;
  std::string_view exponent_digits = digits.substr(e + 1);
  if (exponent_digits.front() == '+') exponent_digits.remove_prefix(1);
  std::from_chars(exponent_digits.data(), exponent_digits.data() + exponent_digits.size(), exponent);
  return text + 'E' + std::to_string(exponent);
}

}  // namespace

namespace rdf {

void appendNTriples(std::string& out, const TermView& term) {
  static const std::string plain = vocabulary::xsd("string");
  switch (term.kind) {
    case TermKind::Iri:
      out += '<';
      appendEscapedIri(out, term.text);
      out += '>';
      return;
    case TermKind::BlankNode:
      out.append("_:").append(term.text);
      return;
    case TermKind::Literal:
      break;
  }
  out += '"';
  appendEscapedLiteral(out, term.text);
  out += '"';
  if (!term.language.empty()) {
    out.append("@").append(term.language);
  } else if (term.datatype != plain) {
    out += "^^<";
    appendEscapedIri(out, term.datatype);
    out += '>';
  }
}

}  // namespace rdf

Term Term::literal(std::string_view lexical) {
  return {TermKind::Literal, std::string(lexical), rdf::vocabulary::xsd("string"), {}};
}

Term Term::literal(std::string_view lexical, std::string_view datatype) {
  return {TermKind::Literal, std::string(lexical), std::string(datatype), {}};
}

Term Term::langLiteral(std::string_view lexical, std::string_view language) {
  return {TermKind::Literal, std::string(lexical), rdf::vocabulary::rdf("langString"), lowerCase(language)};
}

Term Term::integer(std::int64_t value) {
  return literal(std::to_string(value), rdf::vocabulary::xsd("integer"));
}

Term Term::real(double value) {
  return literal(canonicalDouble(value), rdf::vocabulary::xsd("double"));
}

Term Term::boolean(bool value) {
  return literal(value ? "true" : "false", rdf::vocabulary::xsd("boolean"));
}

std::string toNTriples(const Term& term) {
  std::string out;
  rdf::appendNTriples(out, rdf::TermView::of(term));
  return out;
}

std::string toNQuads(const Quad& quad) {
  std::string out;
  for (const Term* term : {&quad.subject, &quad.predicate, &quad.object}) {
    rdf::appendNTriples(out, rdf::TermView::of(*term));
    out += ' ';
  }
  const bool default_graph = quad.graph.kind == TermKind::Iri && quad.graph.text.empty();
  if (!default_graph) {
    rdf::appendNTriples(out, rdf::TermView::of(quad.graph));
    out += ' ';
  }
  return out += ".\n";
}

}  // namespace cluxel
