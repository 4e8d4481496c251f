// SPDX-License-Identifier: Apache-2.0
// Collects variables from the elements of groups.
#include "mapping/inference/bound_variables.hpp"

#include <algorithm>

#include "mapping/inference/rule_limits.hpp"

namespace cluxel::mapping {

namespace ast = sparql::ast;

namespace {

using PathKind = ast::Path::Kind;

void addEnds(const ast::TriplePattern& triple, Variables& bound) {
  for (const ast::PatternTerm* end : {&triple.subject, &triple.object})
    if (end->isVariable()) bound.insert(end->variable());
}

/// Other expressions may fail for some values, and then bind nothing.
bool cannotFail(const ast::Expression& expression, const Variables& bound) {
  return expression.kind == ast::Expression::Kind::Constant ||
         (expression.kind == ast::Expression::Kind::Variable && bound.contains(expression.variable));
}

Variables boundByValues(const ast::InlineData& data) {
  Variables bound;
  const std::size_t columns = data.variables.size();
  for (std::size_t column = 0; column < columns; ++column) {
    bool is_full = true;
    for (std::size_t row = 0; row < data.row_count; ++row)
      is_full = is_full && data.cells[row * columns + column].has_value();
    if (is_full) bound.insert(data.variables[column]);
  }
  return bound;
}

Variables boundBySelect(const ast::Select& select) {
  Variables inside = boundIn(select.where);
  if (select.values) inside.merge(boundByValues(*select.values));
  for (const ast::GroupCondition& group : select.modifiers.group_by)
    if (group.as && cannotFail(group.expression, inside)) inside.insert(*group.as);
  Variables bound;
  for (const ast::Projection& column : select.projection) {
    const bool has_value =
        column.expression ? cannotFail(*column.expression, inside) : inside.contains(column.variable);
    if (has_value) bound.insert(column.variable);
  }
  return bound;
}

Variables boundByUnion(const ast::UnionPattern& either) {
  Variables bound = boundIn(either.branches.front());
  for (const ast::GroupPattern& branch : either.branches)
    std::erase_if(bound, [in_branch = boundIn(branch)](auto variable) { return !in_branch.contains(variable); });
  return bound;
}

/// What a triple or a path binds when one of its ends is bound.
void addOtherEnds(const ast::GroupPattern& group, Variables& bound) {
  for (const ast::PatternElement& element : group.elements)
    if (const auto* block = std::get_if<ast::TriplesBlock>(&element.value))
      for (const ast::TriplePattern& triple : block->triples)
        if (isBound(triple.subject, bound) || isBound(triple.object, bound)) addEnds(triple, bound);
}

}  // namespace

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

bool isBound(const ast::PatternTerm& term, const Variables& bound) {
  return !term.isVariable() || bound.contains(term.variable());
}

Variables boundIn(const ast::PatternElement& element) {
  Variables bound;
  if (const auto* block = std::get_if<ast::TriplesBlock>(&element.value))
    for (const ast::TriplePattern& triple : block->triples)
      if (!triple.isPath() || !mayBeEmpty(*triple.path)) addEnds(triple, bound);
  if (const auto* inner = std::get_if<ast::GroupPattern>(&element.value)) return boundIn(*inner);
  if (const auto* graph = std::get_if<ast::GraphPattern>(&element.value)) return boundIn(graph->group);
  if (const auto* data = std::get_if<ast::InlineData>(&element.value)) return boundByValues(*data);
  if (const auto* inner = std::get_if<ast::SubSelect>(&element.value)) return boundBySelect(*inner->select);
  if (const auto* either = std::get_if<ast::UnionPattern>(&element.value)) return boundByUnion(*either);
  return bound;
}

Variables boundIn(const ast::GroupPattern& group) {
  Variables bound;
  for (const ast::PatternElement& element : group.elements) {
    const auto* bind = std::get_if<ast::Bind>(&element.value);
    if (bind != nullptr && cannotFail(bind->expression, bound)) bound.insert(bind->variable);
    bound.merge(boundIn(element));
  }
  for (std::size_t before = bound.size() + 1; before != bound.size();) {
    before = bound.size();
    addOtherEnds(group, bound);
  }
  return bound;
}

namespace {

/// OPTIONAL, MINUS and BIND see what stands before them in their group, and EXISTS what its group binds. So the key has
/// to be bound there.
class KeyBinding {
 public:
  explicit KeyBinding(ast::VariableIndex key) : key_(key) {}

  /// `is_bound`: what is around the group binds the key.
  bool isLocal(const ast::GroupPattern& group, bool is_bound = false) const {
    const bool is_bound_by_all = is_bound || boundIn(group).contains(key_);
    bool is_local = true;
    for (const ast::PatternElement& element : group.elements) {
      const auto* filter = std::get_if<ast::Filter>(&element.value);
      is_local =
          is_local && (filter != nullptr ? isLocal(filter->condition, is_bound_by_all) : isLocal(element, is_bound));
      is_bound = is_bound || boundIn(element).contains(key_);
    }
    return is_local;
  }

 private:
  bool mentions(const ast::Expression& expression) const {
    return (expression.kind == ast::Expression::Kind::Variable && expression.variable == key_) ||
           std::any_of(expression.arguments.begin(), expression.arguments.end(),
                       [this](const ast::Expression& argument) { return mentions(argument); });
  }

  /// `is_bound`: what stands before the element binds the key.
  bool isLocal(const ast::PatternElement& element, bool is_bound) const {
    if (const auto* bind = std::get_if<ast::Bind>(&element.value))
      return is_bound || !(bind->variable == key_ || mentions(bind->expression));
    const bool asks_row = std::holds_alternative<ast::OptionalPattern>(element.value) ||
                          std::holds_alternative<ast::MinusPattern>(element.value);
    bool is_local = is_bound || !asks_row;
    forEachGroup(element, [&](const ast::GroupPattern& inner) { is_local = is_local && isLocal(inner); });
    return is_local;
  }

  /// EXISTS sees what its group binds.
  bool isLocal(const ast::Expression& expression, bool is_bound) const {
    return (!expression.pattern || (is_bound && isLocal(*expression.pattern, is_bound))) &&
           std::all_of(expression.arguments.begin(), expression.arguments.end(),
                       [&](const ast::Expression& argument) { return isLocal(argument, is_bound); });
  }

  ast::VariableIndex key_;
};

}  // namespace

bool isLocalTo(ast::VariableIndex key, const ast::GroupPattern& body) {
  return KeyBinding(key).isLocal(body);
}

}  // namespace cluxel::mapping
