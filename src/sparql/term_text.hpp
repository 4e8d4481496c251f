// SPDX-License-Identifier: Apache-2.0
// Terms as text, in the ways that the result formats write them. Each function appends to `text`.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cluxel/sparql/result_table.hpp"

namespace cluxel {

using PrefixList = std::vector<std::pair<std::string, std::string>>;

/// N-Triples, every literal in quotes.
void appendNTriples(std::string& text, const TermView& term);
/// Turtle without prefixes: numbers and booleans bare. The form of TSV results.
void appendTurtle(std::string& text, const TermView& term);
/// Turtle with IRIs shortened where a prefix fits.
void appendTurtle(std::string& text, const TermView& term, const PrefixList& prefixes);
/// The value alone, quoted where CSV (RFC 4180) needs it.
void appendCsv(std::string& text, const TermView& term);
/// The object of one binding in application/sparql-results+json.
void appendJson(std::string& text, const TermView& term);
/// The element of one binding in application/sparql-results+xml.
void appendXml(std::string& text, const TermView& term);
/// For people: short names, strings without quotes, the language behind an @.
void appendPlain(std::string& text, const TermView& term, const PrefixList& prefixes);

void appendJsonString(std::string& text, std::string_view value);
/// Text or attribute value of XML; characters that XML 1.0 cannot hold become U+FFFD.
void appendXmlText(std::string& text, std::string_view value);

}  // namespace cluxel
