// SPDX-License-Identifier: Apache-2.0
// Walks the groups of a rule.
#include "mapping/inference/rule_limits.hpp"

#include <algorithm>
#include <memory>
#include <set>

#include "cluxel/error.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::mapping {

namespace ast = sparql::ast;

namespace {

using PathKind = ast::Path::Kind;
using Variables = std::set<ast::VariableIndex>;

/// Whether the path as a whole holds between a term and itself without a step.
bool mayBeEmpty(const ast::Path& path) {
  switch (path.kind) {
    case PathKind::ZeroOrMore:
    case PathKind::ZeroOrOne:
      return true;
    case PathKind::Alternative:
      return std::any_of(path.parts.begin(), path.parts.end(), mayBeEmpty);
    case PathKind::Link:
    case PathKind::NegatedSet:
      return false;
    default:
      return std::all_of(path.parts.begin(), path.parts.end(), mayBeEmpty);
  }
}

bool walksAny(const ast::Path& path) {
  return path.kind == PathKind::NegatedSet || std::any_of(path.parts.begin(), path.parts.end(), walksAny);
}

/// The expressions of a select outside of its patterns.
std::vector<const ast::Expression*> expressionsOf(const ast::Select& select) {
  std::vector<const ast::Expression*> all;
  for (const ast::Projection& column : select.projection)
    if (column.expression) all.push_back(&*column.expression);
  for (const ast::GroupCondition& group : select.modifiers.group_by) all.push_back(&group.expression);
  for (const ast::Expression& having : select.modifiers.having) all.push_back(&having);
  for (const ast::OrderCondition& order : select.modifiers.order_by) all.push_back(&order.expression);
  return all;
}

bool patternsAskExists(const ast::GroupPattern& group) {
  return std::any_of(group.elements.begin(), group.elements.end(), [](const ast::PatternElement& element) {
    bool asks = false;
    if (const auto* inner = std::get_if<ast::SubSelect>(&element.value)) asks = asksExists(*inner->select);
    forEachGroup(element, [&](const ast::GroupPattern& inner) { asks = asks || patternsAskExists(inner); });
    return asks;
  });
}

class PathCheck {
 public:
  explicit PathCheck(const NamedText& rule) : rule_(rule) {}

  void select(const ast::Select& select) const {
    Variables bound;
    if (select.values) bound.insert(select.values->variables.begin(), select.values->variables.end());
    group(select.where, bound);
    bound.merge(boundIn(select.where));
    for (const ast::Expression* one : expressionsOf(select)) expression(*one, bound);
  }

 private:
  /// `bound`: variables that patterns around the group bind.
  void group(const ast::GroupPattern& group, Variables bound) const {
    bound.merge(boundIn(group));
    for (const ast::PatternElement& element : group.elements) {
      if (const auto* block = std::get_if<ast::TriplesBlock>(&element.value))
        for (const ast::TriplePattern& triple : block->triples)
          if (triple.isPath() && mayBeEmpty(*triple.path) && !isBound(triple.subject, bound)) refuse();
      if (const auto* filter = std::get_if<ast::Filter>(&element.value)) expression(filter->condition, bound);
      if (const auto* bind = std::get_if<ast::Bind>(&element.value)) expression(bind->expression, bound);
      if (const auto* inner = std::get_if<ast::SubSelect>(&element.value)) select(*inner->select);
      forEachGroup(element, [&](const ast::GroupPattern& inner) { this->group(inner, bound); });
    }
  }

  [[noreturn]] void refuse() const {
    throw InputError({.file = rule_.name},
                     "a path that may have no step (* or ?) stands between two variables that nothing else binds: it "
                     "holds for every term of the map, also for those that rules make",
                     "bind one of its ends by another pattern");
  }

  void expression(const ast::Expression& expression, const Variables& bound) const {
    for (const ast::Expression& argument : expression.arguments) this->expression(argument, bound);
    if (expression.pattern) group(*expression.pattern, bound);
  }

  static bool isBound(const ast::PatternTerm& term, const Variables& bound) {
    return !term.isVariable() || bound.contains(term.variable());
  }

  /// What each solution of the group binds, paths that may have no step from one bound end to the other.
  static Variables boundIn(const ast::GroupPattern& group) {
    Variables bound;
    for (const ast::PatternElement& element : group.elements) bound.merge(boundIn(element));
    for (std::size_t before = bound.size() + 1; before != bound.size();) {
      before = bound.size();
      for (const ast::PatternElement& element : group.elements)
        if (const auto* block = std::get_if<ast::TriplesBlock>(&element.value))
          for (const ast::TriplePattern& triple : block->triples)
            if (isBound(triple.subject, bound) || isBound(triple.object, bound)) addEnds(triple, bound);
    }
    return bound;
  }

  static void addEnds(const ast::TriplePattern& triple, Variables& bound) {
    for (const ast::PatternTerm* end : {&triple.subject, &triple.object})
      if (end->isVariable()) bound.insert(end->variable());
  }

  static Variables boundIn(const ast::PatternElement& element) {
    Variables bound;
    if (const auto* block = std::get_if<ast::TriplesBlock>(&element.value))
      for (const ast::TriplePattern& triple : block->triples)
        if (!triple.isPath() || !mayBeEmpty(*triple.path)) addEnds(triple, bound);
    if (const auto* inner = std::get_if<ast::GroupPattern>(&element.value)) bound = boundIn(*inner);
    if (const auto* graph = std::get_if<ast::GraphPattern>(&element.value)) bound = boundIn(graph->group);
    if (const auto* bind = std::get_if<ast::Bind>(&element.value)) bound.insert(bind->variable);
    if (const auto* data = std::get_if<ast::InlineData>(&element.value))
      bound.insert(data->variables.begin(), data->variables.end());
    if (const auto* inner = std::get_if<ast::SubSelect>(&element.value))
      for (const ast::Projection& column : inner->select->projection) bound.insert(column.variable);
    if (const auto* either = std::get_if<ast::UnionPattern>(&element.value)) {
      bound = boundIn(either->branches.front());
      for (const ast::GroupPattern& branch : either->branches)
        std::erase_if(bound, [in_branch = boundIn(branch)](auto variable) { return !in_branch.contains(variable); });
    }
    return bound;
  }

  const NamedText& rule_;
};

/// FILTER NOT EXISTS { term a clx:Derivation }.
ast::PatternElement noDerivation(const ast::PatternTerm& term, ast::SourceOffset at) {
  const ast::PatternTerm type{Term::iri(rdf::vocabulary::rdf("type")), at};
  const ast::PatternTerm derivation{Term::iri(rdf::vocabulary::clx("Derivation")), at};
  ast::GroupPattern group;
  group.elements.push_back({ast::TriplesBlock{{{term, type, nullptr, derivation}}}, at});
  ast::Expression condition;
  condition.kind = ast::Expression::Kind::NotExists;
  condition.at = at;
  condition.pattern = std::make_shared<const ast::GroupPattern>(std::move(group));
  return {ast::Filter{std::move(condition)}, at};
}

/// ?thing a ?class.
bool isTypeOfAny(const ast::TriplePattern& triple) {
  return !triple.isPath() && !triple.predicate.isVariable() &&
         triple.predicate.term().text == rdf::vocabulary::rdf("type") && triple.object.isVariable();
}

/// FILTER(?class NOT IN (clx:Derivation, rdf:Statement)): the class of derivations and its superclass.
ast::PatternElement isNoDerivation(const ast::PatternTerm& type, ast::SourceOffset at) {
  ast::Expression condition;
  condition.kind = ast::Expression::Kind::NotIn;
  condition.height = 2;
  condition.arguments.resize(3);
  condition.arguments[0].kind = ast::Expression::Kind::Variable;
  condition.arguments[0].variable = type.variable();
  condition.arguments[1].term = Term::iri(rdf::vocabulary::clx("Derivation"));
  condition.arguments[2].term = Term::iri(rdf::vocabulary::rdf("Statement"));
  condition.at = at;
  for (ast::Expression& argument : condition.arguments) argument.at = at;
  return {ast::Filter{std::move(condition)}, at};
}

void hideIn(ast::GroupPattern& group);

void hideIn(ast::Expression& expression) {
  for (ast::Expression& argument : expression.arguments) hideIn(argument);
  if (!expression.pattern) return;
  auto pattern = std::make_shared<ast::GroupPattern>(*expression.pattern);
  hideIn(*pattern);
  expression.pattern = std::move(pattern);
}

void hideIn(ast::GroupPattern& group) {
  std::vector<ast::PatternElement> filters;
  for (ast::PatternElement& element : group.elements) {
    if (const auto* block = std::get_if<ast::TriplesBlock>(&element.value))
      for (const ast::TriplePattern& triple : block->triples) {
        const bool is_any = triple.isPath() ? walksAny(*triple.path) : triple.predicate.isVariable();
        if (isTypeOfAny(triple)) filters.push_back(isNoDerivation(triple.object, element.at));
        if (is_any && triple.subject.isVariable()) filters.push_back(noDerivation(triple.subject, element.at));
        if (is_any && triple.isPath() && triple.object.isVariable())
          filters.push_back(noDerivation(triple.object, element.at));
      }
    if (auto* filter = std::get_if<ast::Filter>(&element.value)) hideIn(filter->condition);
    if (auto* bind = std::get_if<ast::Bind>(&element.value)) hideIn(bind->expression);
    if (auto* inner = std::get_if<ast::SubSelect>(&element.value)) {
      auto select = std::make_shared<ast::Select>(*inner->select);
      hideIn(select->where);
      inner->select = std::move(select);
    }
    forEachGroup(element, [](ast::GroupPattern& inner) { hideIn(inner); });
  }
  for (ast::PatternElement& filter : filters) group.elements.push_back(std::move(filter));
}

}  // namespace

bool hasExists(const ast::Expression& expression) {
  return expression.pattern != nullptr ||
         std::any_of(expression.arguments.begin(), expression.arguments.end(), hasExists);
}

bool asksExists(const ast::Select& select) {
  const auto expressions = expressionsOf(select);
  return std::any_of(expressions.begin(), expressions.end(), [](const auto* one) { return hasExists(*one); }) ||
         patternsAskExists(select.where);
}

void refuseUnboundPaths(const ast::Query& query, const NamedText& rule) {
  PathCheck(rule).select(query.select);
}

void hideDerivations(ast::Query& query) {
  hideIn(query.select.where);
}

}  // namespace cluxel::mapping
