// SPDX-License-Identifier: Apache-2.0
// Prepares queries against an empty store.
#include "cluxel/mapping/ask_check.hpp"

#include <memory>

#include "cluxel/base/diagnostic.hpp"
#include "cluxel/knowledge/environment.hpp"
#include "cluxel/sparql/query_engine.hpp"

namespace cluxel {

namespace {

/// The byte at a line and column.
std::size_t offsetOf(const SourceLocation& place, const std::string& text) {
  std::size_t offset = 0;
  for (std::size_t line = 1; line < place.line; ++line) {
    const std::size_t end = text.find('\n', offset);
    if (end == std::string::npos) return text.size();
    offset = end + 1;
  }
  return std::min(text.size(), offset + (place.column > 0 ? place.column - 1 : 0));
}

std::optional<std::pair<std::size_t, std::string>> faultOf(const std::string& query, const QuadReader& nothing) {
  QueryOptions options;
  options.refuse_volatile = true;
  options.source_name = "ask";
  try {
    if (PreparedQuery(nothing, query, options).form() == ast::QueryForm::Ask) return std::nullopt;
    return std::pair{query.size(), std::string("it is no ASK query")};
  } catch (const InputError& error) {
    const Diagnostic& first = error.diagnostics().front();
    return std::pair{offsetOf(first.location, query), first.message};
  }
}

}  // namespace

RuleLoadOptions withCheckedQueries() {
  const std::shared_ptr<Environment> scratch = Environment::temporary();
  return {.check_query = [scratch](const std::string& query) { return faultOf(query, QuadReader(scratch->read())); }};
}

}  // namespace cluxel
