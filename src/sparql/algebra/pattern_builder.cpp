// SPDX-License-Identifier: Apache-2.0
// Translates triple patterns and property paths: sequences, alternatives and inverses become joins and unions
// (section 18.2.2.3).
#include "sparql/algebra/algebra_builder.hpp"

namespace cluxel::sparql {

NodePtr AlgebraBuilder::triples(const ast::TriplesBlock& block, Scope& scope) {
  NodePtr node = unit(scope);
  for (const ast::TriplePattern& pattern : block.triples) {
    const PatternPlace subject = place(pattern.subject, scope), object = place(pattern.object, scope);
    NodePtr next;
    if (pattern.isPath()) {
      next = path(subject, *pattern.path, object, scope);
    } else {
      next = triple(subject, place(pattern.predicate, scope), object, scope, pattern.subject.at);
      next->triple.predicate_at = pattern.predicate.at;
      next->triple.object_at = pattern.object.at;
    }
    node = join(node, next, scope);
  }
  return node;
}

NodePtr AlgebraBuilder::triple(const PatternPlace& subject, const PatternPlace& predicate, const PatternPlace& object,
                               Scope& scope, ast::SourceOffset at) {
  countPart(at);
  NodePtr node = makeNode(Node::Kind::Triple, at);
  node->triple.subject = subject;
  node->triple.predicate = predicate;
  node->triple.object = object;
  node->triple.graph = scope.graph;
  node->triple.at = node->triple.predicate_at = node->triple.object_at = at;
  node->annotate();
  return node;
}

NodePtr AlgebraBuilder::path(const PatternPlace& subject, const ast::Path& path, const PatternPlace& object,
                             Scope& scope) {
  using Kind = ast::Path::Kind;
  switch (path.kind) {
    case Kind::Link:
      return triple(subject, {kNoSlot, terms_.intern(path.iri)}, object, scope, path.at);
    case Kind::Inverse:
      return this->path(object, path.parts[0], subject, scope);
    case Kind::Sequence: {
      NodePtr node = unit(scope);
      PatternPlace from = subject;
      for (std::size_t i = 0; i < path.parts.size(); ++i) {
        const bool last = i + 1 == path.parts.size();
        const PatternPlace to = last ? object : PatternPlace{freshSlot(".step"), kUnbound};
        node = join(node, this->path(from, path.parts[i], to, scope), scope);
        from = to;
      }
      return node;
    }
    case Kind::Alternative: {
      NodePtr node = makeNode(Node::Kind::Union, path.at);
      for (const ast::Path& part : path.parts) node->children.push_back(this->path(subject, part, object, scope));
      node->annotate();
      return node;
    }
    case Kind::NegatedSet:
      return negatedSet(subject, path, object, scope);
    case Kind::ZeroOrMore:
    case Kind::OneOrMore:
    case Kind::ZeroOrOne:
      break;
  }
  NodePtr node = triple(subject, {}, object, scope, path.at);
  node->triple.path = std::make_shared<const CompiledPath>(compile(path));
  node->annotate();
  return node;
}

NodePtr AlgebraBuilder::negatedSet(const PatternPlace& subject, const ast::Path& path, const PatternPlace& object,
                                   Scope& scope) {
  const auto direction = [&](const std::vector<Term>& excluded, const PatternPlace& from, const PatternPlace& to) {
    NodePtr node = triple(from, {freshSlot(".predicate"), kUnbound}, to, scope, path.at);
    for (const Term& iri : excluded) node->triple.not_predicates.push_back(terms_.intern(iri));
    return node;
  };
  if (path.backward.empty()) return direction(path.forward, subject, object);
  if (path.forward.empty()) return direction(path.backward, object, subject);
  NodePtr node = makeNode(Node::Kind::Union, path.at);
  node->children = {direction(path.forward, subject, object), direction(path.backward, object, subject)};
  node->annotate();
  return node;
}

CompiledPath AlgebraBuilder::compile(const ast::Path& path) {
  CompiledPath compiled;
  compiled.kind = path.kind;
  compiled.at = path.at;
  if (path.kind == ast::Path::Kind::Link) compiled.iri = terms_.intern(path.iri);
  for (const ast::Path& part : path.parts) compiled.parts.push_back(compile(part));
  for (const Term& iri : path.forward) compiled.forward.push_back(terms_.intern(iri));
  for (const Term& iri : path.backward) compiled.backward.push_back(terms_.intern(iri));
  compiled.has_backward = !path.backward.empty();
  // !() has two empty lists and is a forward path.
  compiled.has_forward = !path.forward.empty() || path.backward.empty();
  return compiled;
}

}  // namespace cluxel::sparql
