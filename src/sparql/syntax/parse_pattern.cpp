// SPDX-License-Identifier: Apache-2.0
// Parses group graph patterns and determines the variables in scope.
#include "sparql/syntax/sparql_parser.hpp"

namespace cluxel::sparql {

void SparqlParser::addVisible(const ast::PatternTerm& term, VariableSet& visible) const {
  if (term.isVariable()) visible.add(term.variable());
}

void SparqlParser::addVisible(const ast::InlineData& data, VariableSet& visible) const {
  for (const ast::VariableIndex index : data.variables) visible.add(index);
}

/// Adds the in-scope variables of the group to `visible`.
ast::GroupPattern SparqlParser::group(VariableSet& visible) {
  const Nested nested(*this);
  const std::uint32_t block_around = block_;
  const NodeMode mode_around = mode_;
  ast::GroupPattern result;
  result.at = here();
  expect(Kind::LeftBrace, {});
  mode_ = NodeMode::Pattern;
  block_ = ++last_block_;
  VariableSet own;
  if (is(Keyword::Select))
    result.elements.push_back(subSelect(own));
  else
    groupElements(result, own);
  if (!is(Kind::RightBrace)) unexpected("'}' after the sub-select");
  block_ = block_around;
  mode_ = mode_around;
  advance();
  visible.addAll(own);
  return result;
}

void SparqlParser::groupElements(ast::GroupPattern& group, VariableSet& visible) {
  constexpr std::size_t none = SIZE_MAX;
  std::size_t triples_at = none;  // the block to which following triples are added
  while (!is(Kind::RightBrace)) {
    if (isNodeStart()) {
      if (triples_at == none) {
        triples_at = group.elements.size();
        group.elements.push_back({ast::TriplesBlock{}, here()});
      }
      groupTriples(std::get<ast::TriplesBlock>(group.elements[triples_at].value), visible);
      continue;
    }
    if (!is(Keyword::Filter)) {
      triples_at = none;
      block_ = ++last_block_;
    }
    group.elements.push_back(element(visible));
    take(Kind::Dot);
  }
}

void SparqlParser::groupTriples(ast::TriplesBlock& block, VariableSet& visible) {
  const std::size_t before = block.triples.size();
  triples(block.triples);
  for (std::size_t i = before; i < block.triples.size(); ++i) {
    const ast::TriplePattern& triple = block.triples[i];
    addVisible(triple.subject, visible);
    if (!triple.isPath()) addVisible(triple.predicate, visible);
    addVisible(triple.object, visible);
  }
}

ast::PatternElement SparqlParser::element(VariableSet& visible) {
  const ast::SourceOffset at = here();
  if (is(Kind::LeftBrace)) return groupOrUnion(visible);
  if (take(Keyword::Optional)) return {ast::OptionalPattern{group(visible)}, at};
  if (take(Keyword::Graph)) return graph(visible);
  if (take(Keyword::Service)) return service(visible);
  if (take(Keyword::Minus)) return minus();
  if (take(Keyword::Filter)) return filter();
  if (take(Keyword::Bind)) return bind(visible);
  if (take(Keyword::Values)) {
    ast::InlineData data = inlineData();
    addVisible(data, visible);
    return {std::move(data), at};
  }
  unexpected("a triple, a keyword such as OPTIONAL or FILTER, or '}'",
             {Keyword::Optional, Keyword::Filter, Keyword::Graph, Keyword::Minus, Keyword::Bind, Keyword::Values,
              Keyword::Service, Keyword::Union, Keyword::Select, Keyword::Where});
}

ast::PatternElement SparqlParser::groupOrUnion(VariableSet& visible) {
  const ast::SourceOffset at = here();
  ast::GroupPattern first = group(visible);
  if (!is(Keyword::Union)) return {std::move(first), at};
  ast::UnionPattern branches;
  branches.branches.push_back(std::move(first));
  while (take(Keyword::Union)) branches.branches.push_back(group(visible));
  return {std::move(branches), at};
}

ast::PatternElement SparqlParser::graph(VariableSet& visible) {
  ast::GraphPattern result;
  result.graph = varOrIri("a graph's IRI or a variable");
  addVisible(result.graph, visible);
  result.group = group(visible);
  const ast::SourceOffset at = result.graph.at;
  return {std::move(result), at};
}

ast::PatternElement SparqlParser::service(VariableSet& visible) {
  ast::ServicePattern result;
  result.silent = take(Keyword::Silent);
  result.endpoint = varOrIri("a service's IRI or a variable");
  addVisible(result.endpoint, visible);
  result.group = group(visible);
  const ast::SourceOffset at = result.endpoint.at;
  return {std::move(result), at};
}

ast::PatternElement SparqlParser::minus() {
  const ast::SourceOffset at = here();
  VariableSet not_visible;
  return {ast::MinusPattern{group(not_visible)}, at};
}

ast::PatternElement SparqlParser::filter() {
  const ast::SourceOffset at = here();
  const AggregateUse use = std::exchange(aggregate_use_, AggregateUse::Refused);
  ast::Filter result{constraint("a condition: '(', a built-in or a function")};
  aggregate_use_ = use;
  return {std::move(result), at};
}

ast::PatternElement SparqlParser::bind(VariableSet& visible) {
  const AggregateUse use = std::exchange(aggregate_use_, AggregateUse::Refused);
  ast::Bind result;
  expect(Kind::LeftParen, "'(' after BIND");
  result.expression = expression();
  expect(Keyword::As);
  const ast::SourceOffset at = here();
  result.variable = variable("a variable after AS");
  if (visible.contains(result.variable))
    fail(at, "?" + variables_[result.variable].name + " already has a value in this group",
         "BIND makes a new variable; to compare use FILTER");
  visible.add(result.variable);
  expect(Kind::RightParen, "')' after the variable");
  aggregate_use_ = use;
  return {std::move(result), at};
}

ast::InlineData SparqlParser::inlineData() {
  ast::InlineData data;
  const bool several = !is(Kind::Var);
  if (several)
    data.variables = inlineVariables();
  else
    data.variables.push_back(variable());
  expect(Kind::LeftBrace, "'{' and the values");
  while (!is(Kind::RightBrace)) {
    if (several)
      inlineRow(data);
    else
      data.cells.push_back(inlineValue());
    ++data.row_count;
  }
  advance();
  return data;
}

std::vector<ast::VariableIndex> SparqlParser::inlineVariables() {
  std::vector<ast::VariableIndex> variables;
  VariableSet seen;
  if (take(Kind::Nil)) return variables;
  expect(Kind::LeftParen, "a variable, or variables in ( )");
  while (!is(Kind::RightParen)) {
    const ast::SourceOffset at = here();
    variables.push_back(variable("a variable or ')'"));
    if (seen.contains(variables.back()))
      fail(at, "?" + variables_[variables.back()].name + " stands twice in this VALUES");
    seen.add(variables.back());
  }
  advance();
  return variables;
}

void SparqlParser::inlineRow(ast::InlineData& data) {
  const std::size_t width = data.variables.size(), first = data.cells.size();
  const ast::SourceOffset at = here();
  if (!take(Kind::Nil)) {
    expect(Kind::LeftParen, "'(' and a row of values, or '}'");
    while (!is(Kind::RightParen)) data.cells.push_back(inlineValue());
    advance();
  }
  const std::size_t count = data.cells.size() - first;
  if (count != width)
    fail(at, "this row has " + std::to_string(count) + " values for " + std::to_string(width) + " variables",
         "write UNDEF where a row has no value");
}

std::optional<Term> SparqlParser::inlineValue() {
  if (take(Keyword::Undef)) return std::nullopt;
  const bool wrong = is(Kind::Var) || is(Kind::BlankLabel) || is(Kind::Anon) || is(Kind::Nil);
  if (wrong || !isTermStart()) unexpected("an IRI, a literal or UNDEF", {Keyword::Undef});
  return graphTerm();
}

}  // namespace cluxel::sparql
