// SPDX-License-Identifier: Apache-2.0
// Parses triples: property lists, object lists, collections, blank node property lists, and property paths.
#include "rdf/vocabulary.hpp"
#include "sparql/syntax/sparql_parser.hpp"

namespace cluxel::sparql {

bool SparqlParser::isNodeStart() const {
  return isTermStart() || is(Kind::LeftParen) || is(Kind::LeftBracket);
}

bool SparqlParser::isVerb() const {
  if (is(Kind::Var) || isIri() || is(Keyword::A)) return true;
  return is(Kind::Bang) || is(Kind::Caret) || is(Kind::LeftParen);
}

void SparqlParser::triples(Triples& out) {
  do triplesSameSubject(out);
  while (take(Kind::Dot) && isNodeStart());
  if (isNodeStart()) unexpected("'.' between triples, ';' or ',' before this");
}

void SparqlParser::triplesSameSubject(Triples& out) {
  const bool node_is_enough = is(Kind::LeftParen) || is(Kind::LeftBracket);
  const ast::PatternTerm subject = graphNode(out, "the subject of a triple");
  if (isVerb())
    propertyList(out, subject);
  else if (!node_is_enough)
    unexpected("a property, a path or a variable", {Keyword::A});
}

void SparqlParser::propertyList(Triples& out, const ast::PatternTerm& subject) {
  for (bool more = true; more && isVerb();) {
    ast::TriplePattern triple;
    triple.subject = subject;
    verb(triple);
    objectList(out, triple);
    for (more = false; take(Kind::Semicolon);) more = true;
  }
}

void SparqlParser::objectList(Triples& out, const ast::TriplePattern& begun) {
  do {
    ast::TriplePattern triple = begun;
    triple.object = graphNode(out, "the object of the triple");
    out.push_back(std::move(triple));
  } while (take(Kind::Comma));
}

void SparqlParser::verb(ast::TriplePattern& triple) {
  const std::uint32_t at = here();
  if (is(Kind::Var)) {
    triple.predicate = varOrTerm();
    return;
  }
  if (mode_ == NodeMode::Pattern) {
    ast::Path read = path();
    if (read.kind == ast::Path::Kind::Link)
      triple.predicate = {std::move(read.iri), at};
    else
      triple.path = std::make_shared<const ast::Path>(std::move(read));
    return;
  }
  if (take(Keyword::A))
    triple.predicate = {Term::iri(rdf::vocabulary::rdf("type")), at};
  else
    triple.predicate = {iri("a property"), at};
  const bool modifier = is(Kind::Star) || is(Kind::Question) || (is(Kind::Plus) && !token_.number_follows);
  if (modifier || is(Kind::Slash) || is(Kind::Bar))
    fail(here(), "a property path cannot stand here", "templates and DATA hold plain triples");
}

ast::PatternTerm SparqlParser::graphNode(Triples& out, std::string_view expected) {
  if (is(Kind::LeftParen)) return collection(out);
  if (is(Kind::LeftBracket)) return blankNodePropertyList(out);
  if (!isTermStart()) unexpected(expected);
  return varOrTerm();
}

/// Expands ( a b … ) to an rdf:first/rdf:rest list.
ast::PatternTerm SparqlParser::collection(Triples& out) {
  const Nested nested(*this);
  const std::uint32_t at = here();
  const auto link = [at](std::string_view local) {
    return ast::PatternTerm{Term::iri(rdf::vocabulary::rdf(local)), at};
  };
  expect(Kind::LeftParen, {});
  const ast::PatternTerm head = freshBlankNode(at);
  for (ast::PatternTerm cell = head;;) {
    out.push_back({cell, link("first"), nullptr, graphNode(out, "an entry of the list")});
    if (is(Kind::RightParen)) {
      out.push_back({cell, link("rest"), nullptr, link("nil")});
      break;
    }
    if (!isNodeStart()) unexpected("an entry of the list or ')'");
    ast::PatternTerm next = freshBlankNode(here());
    out.push_back({std::move(cell), link("rest"), nullptr, next});
    cell = std::move(next);
  }
  advance();
  return head;
}

ast::PatternTerm SparqlParser::blankNodePropertyList(Triples& out) {
  const Nested nested(*this);
  const std::uint32_t at = here();
  expect(Kind::LeftBracket, {});
  ast::PatternTerm node = freshBlankNode(at);
  if (!isVerb()) unexpected("a property");
  propertyList(out, node);
  expect(Kind::RightBracket, "']', ';' or ','");
  return node;
}

namespace {

ast::Path pathOver(ast::Path::Kind kind, ast::Path part) {
  ast::Path path;
  path.kind = kind;
  path.at = part.at;
  path.parts.push_back(std::move(part));
  return path;
}

}  // namespace

ast::Path SparqlParser::path() {
  ast::Path first = pathSequence();
  if (!is(Kind::Bar)) return first;
  ast::Path alternatives = pathOver(ast::Path::Kind::Alternative, std::move(first));
  while (take(Kind::Bar)) alternatives.parts.push_back(pathSequence());
  return alternatives;
}

ast::Path SparqlParser::pathSequence() {
  ast::Path first = pathElementOrInverse();
  if (!is(Kind::Slash)) return first;
  ast::Path sequence = pathOver(ast::Path::Kind::Sequence, std::move(first));
  while (take(Kind::Slash)) sequence.parts.push_back(pathElementOrInverse());
  return sequence;
}

ast::Path SparqlParser::pathElementOrInverse() {
  if (take(Kind::Caret)) return pathOver(ast::Path::Kind::Inverse, pathElement());
  return pathElement();
}

ast::Path SparqlParser::pathElement() {
  ast::Path element = pathPrimary();
  if (take(Kind::Star)) return pathOver(ast::Path::Kind::ZeroOrMore, std::move(element));
  if (take(Kind::Question)) return pathOver(ast::Path::Kind::ZeroOrOne, std::move(element));
  if (is(Kind::Plus) && !token_.number_follows) {
    advance();
    return pathOver(ast::Path::Kind::OneOrMore, std::move(element));
  }
  return element;
}

ast::Path SparqlParser::pathPrimary() {
  const Nested nested(*this);
  const std::uint32_t at = here();
  if (take(Kind::LeftParen)) {
    ast::Path inner = path();
    expect(Kind::RightParen, "')' or a path operator");
    return inner;
  }
  if (take(Kind::Bang)) return negatedSet();
  ast::Path link;
  link.at = at;
  if (take(Keyword::A))
    link.iri = Term::iri(rdf::vocabulary::rdf("type"));
  else
    link.iri = iri("a property or a path");
  return link;
}

ast::Path SparqlParser::negatedSet() {
  ast::Path set;
  set.kind = ast::Path::Kind::NegatedSet;
  set.at = here();
  if (take(Kind::Nil)) return set;
  if (!take(Kind::LeftParen)) {
    negatedSetMember(set);
    return set;
  }
  do negatedSetMember(set);
  while (take(Kind::Bar));
  expect(Kind::RightParen, "')' or '|'");
  return set;
}

void SparqlParser::negatedSetMember(ast::Path& set) {
  std::vector<Term>& side = take(Kind::Caret) ? set.backward : set.forward;
  if (take(Keyword::A))
    side.push_back(Term::iri(rdf::vocabulary::rdf("type")));
  else
    side.push_back(iri("a property, or ^ and a property"));
}

}  // namespace cluxel::sparql
