// SPDX-License-Identifier: Apache-2.0
// Serialisation of terms for the result formats. Each function appends to `text`.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sparql/results/result_table.hpp"

namespace cluxel::sparql {

using PrefixList = std::vector<std::pair<std::string, std::string>>;

/// N-Triples: every literal is quoted.
void appendNTriples(std::string& text, const rdf::TermView& term);
/// Turtle without prefixes, numbers and booleans unquoted: the form of TSV results.
void appendTurtle(std::string& text, const rdf::TermView& term);
/// Turtle with prefixed names.
void appendTurtle(std::string& text, const rdf::TermView& term, const PrefixList& prefixes);
/// The lexical form, quoted as CSV requires (RFC 4180).
void appendCsv(std::string& text, const rdf::TermView& term);
/// The object of one binding in application/sparql-results+json.
void appendJson(std::string& text, const rdf::TermView& term);
/// The element of one binding in application/sparql-results+xml.
void appendXml(std::string& text, const rdf::TermView& term);
/// The text table form: prefixed names, strings without quotes, language tags after @.
void appendPlain(std::string& text, const rdf::TermView& term, const PrefixList& prefixes);

void appendJsonString(std::string& text, std::string_view value);
/// XML text or attribute value; characters that XML 1.0 does not allow become U+FFFD.
void appendXmlText(std::string& text, std::string_view value);

}  // namespace cluxel::sparql
