// SPDX-License-Identifier: Apache-2.0
// Facts are written only when a rule asks. Each query is planned once per set of objects.
#include "mapping/facts/map_oracle.hpp"

#include <algorithm>

#include "cluxel/error.hpp"
#include "mapping/facts/query_names.hpp"
#include "sparql/syntax/parser.hpp"

namespace cluxel::mapping {

namespace {

/// The answer must follow from the map alone: NOW, RAND and the like are refused.
sparql::QueryOptions askOptions() {
  sparql::QueryOptions options;
  options.refuse_volatile = true;
  options.source_name = "ask";
  return options;
}

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

std::optional<rules::QueryFault> faultOf(const std::string& query, const rdf::QuadReader& nothing) {
  try {
    if (sparql::PreparedQuery(nothing, query, askOptions()).form() == sparql::ast::QueryForm::Ask) return std::nullopt;
    return rules::QueryFault{query.size(), "it is no ASK query"};
  } catch (const InputError& error) {
    const Diagnostic& first = error.diagnostics().front();
    return rules::QueryFault{offsetOf(first.location, query), first.message};
  }
}

}  // namespace

rules::RuleLoadOptions withCheckedQueries() {
  const std::shared_ptr<rdf::Environment> scratch = rdf::Environment::temporary();
  return {.check_query = [scratch](const std::string& query, const std::vector<std::string>& /*bound*/) {
    return faultOf(query, rdf::QuadReader(scratch->read()));
  }};
}

rules::RuleLoadOptions withCheckedNewQueries() {
  const rules::QueryCheck form = withCheckedQueries().check_query;
  return {.check_query = [form](const std::string& query,
                                const std::vector<std::string>& bound) -> std::optional<rules::QueryFault> {
    if (auto fault = form(query, bound)) return fault;
    if (const auto fault = historyNamedIn(sparql::parseQuery(query)))
      return rules::QueryFault{fault->at, fault->message};
    return std::nullopt;
  }};
}

rules::RuleLoadOptions withCheckedQueries(const rdf::OntologyView& ontology) {
  const rules::QueryCheck form = withCheckedQueries().check_query;
  return {.check_query = [form, ontology](const std::string& query,
                                          const std::vector<std::string>& bound) -> std::optional<rules::QueryFault> {
            if (auto fault = form(query, bound)) return fault;
            const sparql::ast::Query parsed = sparql::parseQuery(query);
            const std::vector<QueryNameFault> faults = faultsOfNames(parsed, ontology, bound);
            if (faults.empty()) return std::nullopt;
            return rules::QueryFault{faults.front().at, faults.front().message};
          },
          .query_classes = [](const std::string& query) { return classesAskedFor(sparql::parseQuery(query)); }};
}

void MapOracle::objectsSoFar(std::span<const rules::SemanticObject> objects) {
  objects_.assign(objects.begin(), objects.end());
  prepared_.clear();
  reader_.reset();
}

void MapOracle::bringUpToDate() {
  if (reader_) return;
  publish_(objects_);
  reader_.emplace(static_cast<const rdf::ReadTransaction&>(transaction_));
}

bool MapOracle::ask(const std::string& query, const std::map<std::string, std::string>& bindings) {
  bringUpToDate();
  std::vector<std::string> names;
  std::vector<sparql::Binding> values;
  for (const auto& [name, iri] : bindings) {
    names.push_back(name);
    values.emplace_back(name, Term::iri(iri));
  }
  auto prepared = prepared_.find(query);
  if (prepared == prepared_.end())
    prepared = prepared_.emplace(query, sparql::PreparedQuery(*reader_, query, askOptions(), names)).first;
  return prepared->second.ask(values);
}

}  // namespace cluxel::mapping
