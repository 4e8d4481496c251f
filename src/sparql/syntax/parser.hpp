// SPDX-License-Identifier: Apache-2.0
// Parses SPARQL 1.1 Query and Update (and 1.0) into a syntax tree.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sparql/syntax/ast.hpp"

namespace cluxel::sparql {

struct SparqlParseOptions {
  std::string file = "query";  ///< the name of the text in messages
  std::string base_iri;        ///< for relative IRIs before any BASE; if empty, a relative IRI is an error
  std::vector<std::pair<std::string, std::string>> prefixes;  ///< predefined prefixes: {"clx", "https://…#"}
  /// Called after every few thousand tokens with their number; what it throws ends the parsing.
  std::function<void(std::size_t)> count = {};
  std::size_t max_bytes = 16u << 20;  ///< longer requests are refused
  std::size_t max_depth = 256;        ///< groups, sub-selects, parentheses and lists nested deeper are refused
};

/// Throws InputError with line, column, caret, the expected token and, for a misspelt keyword or prefix, a suggestion.
/// Accepts arbitrary bytes. Cost O(length).
ast::Query parseQuery(std::string_view text, const SparqlParseOptions& options = {});
ast::Update parseUpdate(std::string_view text, const SparqlParseOptions& options = {});

}  // namespace cluxel::sparql
