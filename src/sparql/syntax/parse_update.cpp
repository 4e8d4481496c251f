// SPDX-License-Identifier: Apache-2.0
// Parses update requests.
#include "sparql/syntax/sparql_parser.hpp"

namespace cluxel::sparql {

ast::Update SparqlParser::update() {
  ast::Update update;
  update.text = source_.text();
  for (;;) {
    prologue();
    if (is(Kind::End)) break;
    ast::UpdateOperation operation = updateOperation();
    operation.variables = std::exchange(variables_, {});
    operation.base_iri = base_iri_;
    update.operations.push_back(std::move(operation));
    variable_of_name_.clear();
    blank_nodes_.clear();
    if (!take(Kind::Semicolon)) break;
  }
  if (!is(Kind::End)) unexpected("';' and another operation, or the end of the request");
  return update;
}

ast::UpdateOperation SparqlParser::updateOperation() {
  ast::UpdateOperation operation;
  operation.at = here();
  const Keyword second = peek().keyword;
  const bool modifies = is(Keyword::Insert) || is(Keyword::Delete);
  if (is(Keyword::With) || (modifies && second != Keyword::Data && second != Keyword::Where))
    operation.value = modify();
  else if (is(Keyword::Delete) && second == Keyword::Where)
    operation.value = deleteWhere();
  else if (is(Keyword::Insert) && second == Keyword::Where) {
    advance();
    unexpected("DATA or '{'");
  } else if (modifies)
    operation.value = dataUpdate(is(Keyword::Insert));
  else if (take(Keyword::Load))
    operation.value = load();
  else if (take(Keyword::Clear))
    operation.value = ast::Clear{take(Keyword::Silent), graphRefAll()};
  else if (take(Keyword::Drop))
    operation.value = ast::Drop{take(Keyword::Silent), graphRefAll()};
  else if (take(Keyword::Create))
    operation.value = ast::Create{take(Keyword::Silent), graphRef()};
  else if (take(Keyword::Add))
    operation.value = transfer(ast::Transfer::Kind::Add);
  else if (take(Keyword::Move))
    operation.value = transfer(ast::Transfer::Kind::Move);
  else if (take(Keyword::Copy))
    operation.value = transfer(ast::Transfer::Kind::Copy);
  else if (is(Keyword::Select) || is(Keyword::Construct) || is(Keyword::Describe) || is(Keyword::Ask))
    fail(here(), "this is a query, not an update", "run it as a query");
  else
    unexpected("an update: INSERT, DELETE, WITH, LOAD, CLEAR, CREATE, DROP, COPY, MOVE or ADD",
               {Keyword::Insert, Keyword::Delete, Keyword::With, Keyword::Load, Keyword::Clear, Keyword::Create,
                Keyword::Drop, Keyword::Copy, Keyword::Move, Keyword::Add, Keyword::Prefix, Keyword::Base});
  return operation;
}

ast::Load SparqlParser::load() {
  ast::Load load;
  load.silent = take(Keyword::Silent);
  load.source = iri("the IRI of what to load");
  if (take(Keyword::Into)) load.into = graphRef();
  return load;
}

Term SparqlParser::graphRef() {
  expect(Keyword::Graph);
  return iri("a graph's IRI");
}

ast::GraphTarget SparqlParser::graphRefAll() {
  if (take(Keyword::Default)) return {ast::GraphTarget::Kind::Default, {}};
  if (take(Keyword::Named)) return {ast::GraphTarget::Kind::Named, {}};
  if (take(Keyword::All)) return {ast::GraphTarget::Kind::All, {}};
  if (!is(Keyword::Graph))
    unexpected("GRAPH and an IRI, DEFAULT, NAMED or ALL",
               {Keyword::Graph, Keyword::Default, Keyword::Named, Keyword::All});
  return {ast::GraphTarget::Kind::Graph, graphRef()};
}

ast::GraphTarget SparqlParser::graphOrDefault() {
  if (take(Keyword::Default)) return {ast::GraphTarget::Kind::Default, {}};
  take(Keyword::Graph);
  return {ast::GraphTarget::Kind::Graph, iri("a graph's IRI or DEFAULT")};
}

ast::Transfer SparqlParser::transfer(ast::Transfer::Kind kind) {
  ast::Transfer transfer;
  transfer.kind = kind;
  transfer.silent = take(Keyword::Silent);
  transfer.from = graphOrDefault();
  expect(Keyword::To);
  transfer.to = graphOrDefault();
  return transfer;
}

ast::DataUpdate SparqlParser::dataUpdate(bool insert) {
  advance();
  expect(Keyword::Data);
  ast::DataUpdate data;
  data.insert = insert;
  operation_labels_.clear();
  for (ast::QuadTemplate& quad : quadBlock(insert ? NodeMode::InsertData : NodeMode::DeleteData))
    data.quads.push_back(groundQuad(std::move(quad)));
  data_labels_.insert(operation_labels_.begin(), operation_labels_.end());
  return data;
}

Quad SparqlParser::groundQuad(ast::QuadTemplate quad) const {
  const auto term = [](ast::PatternTerm& part) { return std::move(std::get<Term>(part.value)); };
  if (quad.subject.term().kind == TermKind::Literal)
    fail(quad.subject.at, "a literal cannot be the subject of a triple", "use an IRI or a blank node");
  return {term(quad.subject), term(quad.predicate), term(quad.object), quad.graph ? term(*quad.graph) : Term{}};
}

ast::Modify SparqlParser::deleteWhere() {
  advance();
  advance();
  ast::Modify modify;
  const Token begin = token_;
  modify.remove = quadBlock(NodeMode::DeleteWhere);
  token_ = begin;  // parsed again as the pattern
  VariableSet visible;
  modify.where = group(visible);
  return modify;
}

ast::Modify SparqlParser::modify() {
  ast::Modify modify;
  if (take(Keyword::With)) modify.with = iri("a graph's IRI");
  const bool removes = take(Keyword::Delete);
  if (removes) modify.remove = quadBlock(NodeMode::DeleteTemplate);
  if (take(Keyword::Insert))
    modify.insert = quadBlock(NodeMode::Template);
  else if (!removes)
    unexpected("DELETE or INSERT", {Keyword::Delete, Keyword::Insert});
  modify.using_clause = datasetClause(Keyword::Using);
  if (!take(Keyword::Where)) unexpected("WHERE", {Keyword::Where, Keyword::Using, Keyword::Insert});
  VariableSet visible;
  modify.where = group(visible);
  return modify;
}

/// { triples  GRAPH g { triples } … }
std::vector<ast::QuadTemplate> SparqlParser::quadBlock(NodeMode mode) {
  mode_ = mode;
  std::vector<ast::QuadTemplate> quads;
  expect(Kind::LeftBrace, {});
  while (!is(Kind::RightBrace)) {
    if (isNodeStart()) {
      quadTriples(quads, std::nullopt);
      continue;
    }
    if (!take(Keyword::Graph)) unexpected("a triple, GRAPH or '}'", {Keyword::Graph});
    const ast::PatternTerm graph = varOrIri("a graph's IRI or a variable");
    expect(Kind::LeftBrace, {});
    if (isNodeStart()) quadTriples(quads, graph);
    expect(Kind::RightBrace, "a triple or '}'");
    take(Kind::Dot);
  }
  advance();
  mode_ = NodeMode::Pattern;
  return quads;
}

void SparqlParser::quadTriples(std::vector<ast::QuadTemplate>& out, const std::optional<ast::PatternTerm>& graph) {
  Triples read;
  triples(read);
  for (ast::TriplePattern& triple : read)
    out.push_back({std::move(triple.subject), std::move(triple.predicate), std::move(triple.object), graph});
}

}  // namespace cluxel::sparql
