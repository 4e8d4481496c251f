// SPDX-License-Identifier: Apache-2.0
// Plans BIND, and evaluates filters on its result before it, so that no term is created for a rejected row.
#include <algorithm>
#include <span>

#include "sparql/plan/planner.hpp"

namespace cluxel::sparql {
namespace {

using Kind = Expr::Kind;

/// Inlining an expression more often than this may cost more than the avoided terms.
constexpr std::size_t kMaxMentions = 2;

std::size_t mentionsOf(const Expr& condition, Slot slot) {
  std::size_t count = condition.kind == Kind::Slot && condition.slot == slot ? 1 : 0;
  for (const Expr& argument : condition.arguments) count += mentionsOf(argument, slot);
  return count;
}

/// True when the expression may be inlined in place of `slot`.
bool looksOnlyAtValue(const Expr& condition, Slot slot) {
  if (condition.kind == Kind::Bound && condition.slot == slot) return false;
  if (condition.pattern) return false;
  return std::all_of(condition.arguments.begin(), condition.arguments.end(),
                     [slot](const Expr& argument) { return looksOnlyAtValue(argument, slot); });
}

bool hasExists(const Expr& expression) {
  return expression.pattern || std::any_of(expression.arguments.begin(), expression.arguments.end(), hasExists);
}

Expr withExpression(const Expr& condition, Slot slot, const Expr& expression) {
  if (condition.kind == Kind::Slot && condition.slot == slot) return expression;
  Expr result = condition;
  for (Expr& argument : result.arguments) argument = withExpression(argument, slot, expression);
  return result;
}

/// The condition with the expressions of the BINDs inlined. None where that would change its meaning: when a BIND
/// fails, its variable may still be bound by an earlier or later part (`bound`).
std::optional<Expr> beforeBinds(const Expr& condition, const std::vector<const Node*>& binds, const SlotSet& bound) {
  Expr result = condition;
  SlotSet given;
  for (const Node* bind : binds) given.add(bind->slot);
  bool changed = false;
  for (const Node* bind : binds) {
    const Expr& expression = *bind->expression;
    if (!condition.slots().has(bind->slot)) continue;
    if (bound.has(bind->slot) || expression.isVolatile() || hasExists(expression)) return std::nullopt;
    if (!looksOnlyAtValue(condition, bind->slot) || given.intersects(expression.slots())) return std::nullopt;
    if (mentionsOf(condition, bind->slot) > kMaxMentions) return std::nullopt;
    result = withExpression(result, bind->slot, expression);
    changed = true;
  }
  return changed ? std::optional(result) : std::nullopt;
}

}  // namespace

/// Consecutive BINDs share one operator, so that BNODE("x") gives one node per solution. An EXISTS is evaluated before
/// its operator's expressions, so a BIND whose EXISTS uses an earlier BIND starts a new operator.
std::vector<const Node*> Planner::neighbouringBinds(std::span<const Postponed> steps) {
  std::vector<const Node*> binds;
  SlotSet given;
  for (const Postponed& step : steps) {
    if (step.kind != Postponed::Kind::Extend) break;
    const Expr& expression = *step.node->expression;
    if (hasExists(expression) && given.intersects(expression.slots())) break;
    binds.push_back(step.node);
    given.add(step.node->slot);
  }
  return binds;
}

Planner::State Planner::extend(State state, const std::vector<const Node*>& nodes) {
  std::vector<std::pair<Slot, Expr>> columns;
  std::vector<const Expr*> expressions;
  for (const Node* node : nodes) columns.emplace_back(node->slot, *node->expression);
  for (const auto& [slot, expression] : columns) expressions.push_back(&expression);
  auto exists = planExists(state, expressions);
  const double rows = state.rows;
  state.top = makeExtend(std::move(state.top), std::move(columns), std::move(exists));
  for (const Node* node : nodes) {
    state.possible.add(node->slot);
    if (node->certain.has(node->slot)) state.certain.add(node->slot);
  }
  state.is_unit = false;
  setRows(state, rows);
  return state;
}

/// Extracts the filters that depend only on these BINDs.
Planner::State Planner::filterBeforeBinds(State state, const std::vector<const Node*>& binds, Parts& parts,
                                          std::span<const Postponed> later, std::vector<bool>& used) {
  SlotSet still_to_come;
  for (const Postponed& step : later) {
    if (step.kind == Postponed::Kind::LeftJoin) still_to_come.add(step.node->children[1]->possible);
    if (step.kind == Postponed::Kind::Extend) still_to_come.add(step.node->slot);
  }
  SlotSet bound = state.possible;
  bound.add(still_to_come);
  std::vector<Expr> ready;
  for (std::size_t i = 0; i < parts.filters.size(); ++i) {
    if (used[i]) continue;
    auto condition = beforeBinds(parts.filters[i], binds, bound);
    if (!condition || !state.certain.contains(condition->slots() & still_to_come)) continue;
    used[i] = true;
    ready.push_back(std::move(*condition));
  }
  if (ready.empty()) return state;
  return filter(std::move(state), std::move(ready));
}

}  // namespace cluxel::sparql
