// SPDX-License-Identifier: Apache-2.0
// Reads SPARQL 1.1 Query and Update (and so 1.0) into a syntax tree.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cluxel/sparql/ast.hpp"

namespace cluxel {

struct SparqlParseOptions {
  std::string file = "query";  ///< how messages name the text
  std::string base_iri;        ///< for relative IRIs before any BASE; empty: a relative IRI is an error
  std::vector<std::pair<std::string, std::string>> prefixes;  ///< known without PREFIX: {"clx", "https://…#"}
  std::size_t max_bytes = 16u << 20;                          ///< longer requests are refused
  std::size_t max_depth = 256;  ///< groups, sub-selects, parentheses and lists nested deeper are refused
};

/// Throws InputError with line, column, caret, what was expected and, for a slip in a keyword or prefix, what was
/// probably meant. Never crashes on any bytes. Cost O(length).
ast::Query parseQuery(std::string_view text, const SparqlParseOptions& options = {});
ast::Update parseUpdate(std::string_view text, const SparqlParseOptions& options = {});

}  // namespace cluxel
