// SPDX-License-Identifier: Apache-2.0
// Walks the groups of a rule.
#include "mapping/inference/rule_limits.hpp"

#include <algorithm>
#include <memory>

#include "cluxel/error.hpp"
#include "mapping/inference/bound_variables.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::mapping {

namespace ast = sparql::ast;

namespace {

bool walksAny(const ast::Path& path) {
  return path.kind == ast::Path::Kind::NegatedSet || std::any_of(path.parts.begin(), path.parts.end(), walksAny);
}

/// Calls `visit` with the expressions of a select outside of its patterns.
template <typename Select, typename Visit>
void forEachExpression(Select& select, const Visit& visit) {
  for (auto& column : select.projection)
    if (column.expression) visit(*column.expression);
  for (auto& group : select.modifiers.group_by) visit(group.expression);
  for (auto& having : select.modifiers.having) visit(having);
  for (auto& order : select.modifiers.order_by) visit(order.expression);
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
    Variables bound = select.values ? boundIn(ast::PatternElement{*select.values}) : Variables{};
    group(select.where, bound);
    bound.merge(boundIn(select.where));
    forEachExpression(select, [&](const ast::Expression& one) { expression(one, bound); });
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

void hideIn(ast::Select& select);
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
      hideIn(*select);
      inner->select = std::move(select);
    }
    forEachGroup(element, [](ast::GroupPattern& inner) { hideIn(inner); });
  }
  for (ast::PatternElement& filter : filters) group.elements.push_back(std::move(filter));
}

void hideIn(ast::Select& select) {
  hideIn(select.where);
  forEachExpression(select, [](ast::Expression& one) { hideIn(one); });
}

}  // namespace

bool hasExists(const ast::Expression& expression) {
  return expression.pattern != nullptr ||
         std::any_of(expression.arguments.begin(), expression.arguments.end(), hasExists);
}

bool asksExists(const ast::Select& select) {
  bool asks = patternsAskExists(select.where);
  forEachExpression(select, [&](const ast::Expression& one) { asks = asks || hasExists(one); });
  return asks;
}

void refuseUnboundPaths(const ast::Query& query, const NamedText& rule) {
  PathCheck(rule).select(query.select);
}

void hideDerivations(ast::Query& query) {
  hideIn(query.select);
}

}  // namespace cluxel::mapping
