// SPDX-License-Identifier: Apache-2.0
// Parses the query forms.
#include "sparql/syntax/sparql_parser.hpp"

namespace cluxel::sparql {

ast::Query SparqlParser::query() {
  ast::Query query;
  prologue();
  if (is(Keyword::Select))
    selectQuery(query);
  else if (take(Keyword::Construct))
    constructQuery(query);
  else if (take(Keyword::Describe))
    describeQuery(query);
  else if (take(Keyword::Ask))
    askQuery(query);
  else if (is(Keyword::Insert) || is(Keyword::Delete) || is(Keyword::Load) || is(Keyword::Clear) || is(Keyword::Drop))
    fail(here(), "this is an update, not a query", "run it as an update");
  else
    unexpected("SELECT, CONSTRUCT, DESCRIBE or ASK",
               {Keyword::Select, Keyword::Construct, Keyword::Describe, Keyword::Ask, Keyword::Prefix, Keyword::Base});
  if (!is(Kind::End))
    unexpected("the end of the query",
               {Keyword::Group, Keyword::Having, Keyword::Order, Keyword::Limit, Keyword::Offset, Keyword::Values});
  query.text = source_.text();
  query.base_iri = base_iri_;
  query.variables = std::move(variables_);
  return query;
}

void SparqlParser::selectQuery(ast::Query& query) {
  query.form = ast::QueryForm::Select;
  selectClause(query.select);
  query.dataset = datasetClause(Keyword::From);
  VariableSet visible;
  whereClause(query.select, visible);
  solutionModifiers(query.select, visible);
  finishSelect(query.select, visible);
}

void SparqlParser::constructQuery(ast::Query& query) {
  query.form = ast::QueryForm::Construct;
  VariableSet visible;
  if (is(Kind::LeftBrace)) {
    query.construct_template = constructTemplate();
    query.dataset = datasetClause(Keyword::From);
    whereClause(query.select, visible);
  } else {
    query.dataset = datasetClause(Keyword::From);
    if (!take(Keyword::Where)) unexpected("'{' and a template, or WHERE", {Keyword::Where, Keyword::From});
    const Token begin = token_;
    query.construct_template = constructTemplate();
    token_ = begin;  // parsed again as the pattern, in which blank nodes are variables
    query.select.where = group(visible);
  }
  solutionModifiers(query.select, visible);
  finishSelect(query.select, visible);
}

SparqlParser::Triples SparqlParser::constructTemplate() {
  Triples triples_read;
  mode_ = NodeMode::Template;
  expect(Kind::LeftBrace, {});
  if (isNodeStart()) triples(triples_read);
  expect(Kind::RightBrace, "a triple or '}'");
  mode_ = NodeMode::Pattern;
  return triples_read;
}

void SparqlParser::describeQuery(ast::Query& query) {
  query.form = ast::QueryForm::Describe;
  query.describe_all = take(Kind::Star);
  if (!query.describe_all) {
    do query.describe.push_back(varOrIri("what to describe: an IRI, a variable or '*'"));
    while (is(Kind::Var) || isIri());
  }
  query.dataset = datasetClause(Keyword::From);
  VariableSet visible;
  if (is(Keyword::Where) || is(Kind::LeftBrace)) whereClause(query.select, visible);
  solutionModifiers(query.select, visible);
  finishSelect(query.select, visible);
  if (!query.describe_all) return;
  for (const ast::VariableIndex index : visible.items())
    if (!variables_[index].hidden) query.describe.emplace_back().value = index;
}

void SparqlParser::askQuery(ast::Query& query) {
  query.form = ast::QueryForm::Ask;
  query.dataset = datasetClause(Keyword::From);
  VariableSet visible;
  whereClause(query.select, visible);
  solutionModifiers(query.select, visible);
  finishSelect(query.select, visible);
}

ast::PatternElement SparqlParser::subSelect(VariableSet& visible) {
  const ast::SourceOffset at = here();
  const AggregateUse use = aggregate_use_;
  const bool saw_aggregate = std::exchange(saw_aggregate_, false);
  ast::Select select;
  VariableSet inside;
  selectClause(select);
  whereClause(select, inside);
  solutionModifiers(select, inside);
  finishSelect(select, inside);
  aggregate_use_ = use;
  saw_aggregate_ = saw_aggregate;
  for (const ast::Projection& column : select.projection) visible.add(column.variable);
  return {ast::SubSelect{std::make_shared<const ast::Select>(std::move(select))}, at};
}

/// FROM [NAMED] or USING [NAMED].
ast::DatasetClause SparqlParser::datasetClause(Keyword keyword) {
  ast::DatasetClause clause;
  clause.at = here();
  while (take(keyword)) {
    std::vector<Term>& graphs = take(Keyword::Named) ? clause.named_graphs : clause.default_graphs;
    graphs.push_back(iri("a graph's IRI"));
  }
  return clause;
}

void SparqlParser::whereClause(ast::Select& select, VariableSet& visible) {
  const bool where = take(Keyword::Where);
  if (!is(Kind::LeftBrace)) {
    if (where) unexpected("'{'");
    unexpected("WHERE or '{'", {Keyword::Where, Keyword::From});
  }
  const AggregateUse use = std::exchange(aggregate_use_, AggregateUse::Refused);
  select.where = group(visible);
  aggregate_use_ = use;
}

}  // namespace cluxel::sparql
