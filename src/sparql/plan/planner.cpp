// SPDX-License-Identifier: Apache-2.0
// Plans groups: flattening, join ordering, filter placement.
#include "sparql/plan/planner.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_set>
#include <utility>

namespace cluxel::sparql {
namespace {

void collectExists(const Expr& expression, std::vector<const Expr*>& found) {
  if (expression.kind == Expr::Kind::Exists || expression.kind == Expr::Kind::NotExists) found.push_back(&expression);
  for (const Expr& argument : expression.arguments) collectExists(argument, found);
}

/// True when no slot of `used` may be bound by `rest`, except slots that are certainly bound inside.
bool isUntouched(const SlotSet& rest, const SlotSet& used, const SlotSet& certain) {
  return certain.contains(rest & used);
}

}  // namespace

Planner::State Planner::unit() {
  State state;
  state.top = std::make_unique<UnitOperator>(parameters_);
  for (const Slot slot : parameters_) {
    if (!unsure_parameters_.has(slot)) state.certain.add(slot);
    state.possible.add(slot);
  }
  state.is_unit = parameters_.empty();
  setRows(state, 1);
  return state;
}

void Planner::setRows(State& state, double rows) {
  state.rows = std::max(rows, 0.0);
  state.top->estimated_rows = state.rows;
}

Slot Planner::freshSlot(const char* name) {
  query_.slot_names.emplace_back(name);
  return static_cast<Slot>(query_.slot_names.size() - 1);
}

/// Flattens nested joins, filters, optionals and binds into one group where that preserves the result. `rest` are the
/// slots that the surrounding group may bind; `after` those bound by later steps, which no filter inside may see.
void Planner::takeApart(const Node& node, const SlotSet& rest, const SlotSet& after, Parts& parts) {
  switch (node.kind) {
    case Node::Kind::Unit:
      return;
    case Node::Kind::Join:
      for (std::size_t i = 0; i < node.children.size(); ++i) {
        SlotSet others = rest;
        for (std::size_t k = 0; k < node.children.size(); ++k) {
          if (k != i) others.add(node.children[k]->possible);
        }
        takeApart(*node.children[i], others, after, parts);
      }
      return;
    case Node::Kind::Filter:
      return takeFilters(node, rest, after, parts);
    case Node::Kind::LeftJoin: {
      SlotSet used = node.children[1]->mentioned();
      for (const Expr& condition : node.conditions) used.add(condition.slots());
      if (!isUntouched(rest, used - parts.constant, node.children[0]->certain)) break;
      SlotSet added = after;
      added.add(node.children[1]->possible);
      takeApart(*node.children[0], rest, added, parts);
      parts.postponed.push_back({Postponed::Kind::LeftJoin, &node});
      return;
    }
    case Node::Kind::Minus:
      if (!isUntouched(rest, node.children[1]->possible - parts.constant, node.children[0]->certain)) break;
      takeApart(*node.children[0], rest, after, parts);
      parts.postponed.push_back({Postponed::Kind::Minus, &node});
      return;
    case Node::Kind::Extend: {
      const SlotSet used = node.expression->slots() - parts.constant;
      if (rest.has(node.slot) || !isUntouched(rest, used, node.children[0]->certain)) break;
      takeApart(*node.children[0], rest, after, parts);
      parts.postponed.push_back({Postponed::Kind::Extend, &node});
      return;
    }
    default:
      break;
  }
  parts.joined.push_back(&node);
}

void Planner::takeFilters(const Node& node, const SlotSet& rest, const SlotSet& after, Parts& parts) {
  const Node& child = *node.children[0];
  SlotSet others = rest;
  others.add(after);
  for (const Expr& condition : node.conditions) {
    if (isUntouched(others, condition.slots() - parts.constant, child.certain)) continue;
    parts.joined.push_back(&node);
    return;
  }
  if (child.kind == Node::Kind::Group) noteEnough(child, node.conditions);
  takeApart(child, rest, after, parts);
  for (const Expr& condition : node.conditions) {
    if (bindsByFilter(condition, child, parts)) continue;
    if (spatial_plans_) searchBySpace(condition, child, parts);
    parts.filters.push_back(condition);
  }
}

/// Rewrites FILTER(?x = <iri>) and FILTER(?x IN (<a>, <b>)) to VALUES.
bool Planner::bindsByFilter(const Expr& condition, const Node& child, Parts& parts) {
  const bool equal = condition.kind == Expr::Kind::Equal, in = condition.kind == Expr::Kind::In;
  if (!equal && !in) return false;
  std::size_t variable = 0;
  if (equal && condition.arguments[0].kind == Expr::Kind::Constant) variable = 1;
  const Expr& slot = condition.arguments[variable];
  if (slot.kind != Expr::Kind::Slot || !child.certain.has(slot.slot)) return false;
  NodePtr values = makeNode(Node::Kind::Values, condition.at);
  values->slots = {slot.slot};
  std::unordered_set<ValueId> known;
  for (std::size_t i = 0; i < condition.arguments.size(); ++i) {
    if (i == variable) continue;
    const Expr& constant = condition.arguments[i];
    if (constant.kind != Expr::Kind::Constant || constant.constant.type != Value::Type::Iri) return false;
    if (known.insert(constant.constant.id).second) values->rows.add({&constant.constant.id, 1});
  }
  if (values->rows.count == 0) return false;
  values->annotate();
  parts.joined.push_back(values.get());
  parts.made.push_back(std::move(values));
  return true;
}

Planner::State Planner::joinNode(State state, const Node& node, const std::vector<Expr>& extra_filters) {
  Parts parts;
  const double needed_rows = std::exchange(needed_rows_, kAllRows);
  parts.closest = std::exchange(closest_, std::nullopt);
  // Constants such as parameters are visible everywhere.
  SlotSet rest = state.possible - state.outer;
  parts.constant = state.outer & state.certain;
  for (const Slot slot : parameters_) {
    rest.remove(slot);
    if (!unsure_parameters_.has(slot)) parts.constant.add(slot);
  }
  takeApart(node, rest, {}, parts);
  parts.filters.insert(parts.filters.end(), extra_filters.begin(), extra_filters.end());
  const auto is_triple = [](const Node* part) { return part->kind == Node::Kind::Triple; };
  const bool keeps_rows = parts.filters.empty() && std::all_of(parts.joined.begin(), parts.joined.end(), is_triple) &&
                          std::none_of(parts.postponed.begin(), parts.postponed.end(),
                                       [](const Postponed& step) { return step.kind == Postponed::Kind::Minus; });
  if (keeps_rows) parts.needed_rows = needed_rows;
  return joinParts(std::move(state), parts);
}

Planner::State Planner::joinParts(State state, Parts& parts) {
  std::vector<const Node*> waiting = parts.joined;
  std::vector<bool> used(parts.filters.size(), false);
  while (true) {
    SlotSet to_come;
    for (const Node* part : waiting) to_come.add(part->possible);
    for (const Postponed& step : parts.postponed) to_come.add(step.node->possible);
    state = applyFilters(std::move(state), parts, to_come, used);
    if (waiting.empty()) break;
    if (auto by_range = joinByRange(state, waiting, parts, used)) {
      state = std::move(*by_range);
      continue;
    }
    const std::size_t next = choosePart(state, waiting);
    const Node* part = waiting[next];
    waiting.erase(waiting.begin() + static_cast<std::ptrdiff_t>(next));
    state = joinPart(std::move(state), *part, parts.needed_rows);
  }
  return applyPostponed(std::move(state), parts, used);
}

Planner::State Planner::applyPostponed(State state, Parts& parts, std::vector<bool>& used) {
  for (std::size_t i = 0; i < parts.postponed.size(); ++i) {
    const Postponed& step = parts.postponed[i];
    if (step.kind == Postponed::Kind::LeftJoin) state = leftJoin(std::move(state), *step.node);
    if (step.kind == Postponed::Kind::Minus) state = minus(std::move(state), *step.node);
    std::vector<const Node*> binds;
    if (step.kind == Postponed::Kind::Extend) {
      binds = neighbouringBinds(std::span(parts.postponed).subspan(i));
      i += binds.size() - 1;
    }
    SlotSet to_come;
    for (std::size_t k = i + 1; k < parts.postponed.size(); ++k) {
      const Node& later = *parts.postponed[k].node;
      to_come.add(later.kind == Node::Kind::Minus ? SlotSet() : later.possible);
    }
    if (!binds.empty()) {
      state = filterBeforeBinds(std::move(state), binds, parts, std::span(parts.postponed).subspan(i + 1), used);
      state = extend(std::move(state), binds);
    }
    state = applyFilters(std::move(state), parts, to_come, used);
  }
  return applyFilters(std::move(state), parts, {}, used);
}

/// Applies filters whose variables are bound, or cannot be bound by later parts.
Planner::State Planner::applyFilters(State state, Parts& parts, const SlotSet& still_to_come, std::vector<bool>& used) {
  std::vector<Expr> ready;
  for (std::size_t i = 0; i < parts.filters.size(); ++i) {
    if (used[i]) continue;
    const SlotSet needed = parts.filters[i].slots();
    if (!state.certain.contains(needed & still_to_come)) continue;
    used[i] = true;
    ready.push_back(parts.filters[i]);
  }
  if (ready.empty()) return state;
  return filter(std::move(state), std::move(ready));
}

Planner::State Planner::filter(State state, std::vector<Expr> conditions) {
  // Cheap tests first: EXISTS last.
  std::stable_partition(conditions.begin(), conditions.end(), [](const Expr& condition) {
    std::vector<const Expr*> found;
    collectExists(condition, found);
    return found.empty();
  });
  std::vector<Expr> cheap, costly;
  for (Expr& condition : conditions) {
    std::vector<const Expr*> found;
    collectExists(condition, found);
    (found.empty() ? cheap : costly).push_back(std::move(condition));
  }
  for (auto* group : {&cheap, &costly}) {
    if (group->empty()) continue;
    const double rows = state.rows * std::pow(0.33, static_cast<double>(group->size()));
    std::vector<const Expr*> expressions;
    for (const Expr& condition : *group) expressions.push_back(&condition);
    auto exists = planExists(state, expressions);
    for (const Expr& condition : *group) {
      if (condition.kind == Expr::Kind::Bound) state.certain.add(condition.slot);
    }
    const ast::SourceOffset at = group->front().at;
    state.top = makeFilter(std::move(state.top), std::move(*group), std::move(exists));
    state.top->at = at;
    state.is_unit = false;
    setRows(state, rows);
  }
  return state;
}

std::vector<ExistsPlan> Planner::planExists(const State& state, const std::vector<const Expr*>& expressions) {
  std::vector<const Expr*> found;
  for (const Expr* expression : expressions) collectExists(*expression, found);
  std::vector<ExistsPlan> plans;
  for (const Expr* expression : found) {
    const Node& pattern = *expression->pattern;
    plans.push_back({expression->exists, pipeline(state, state.possible, [&](State inner) {
                       return joinNode(std::move(inner), pattern, {});
                     })});
  }
  return plans;
}

Pipeline Planner::pipeline(const State& state, const SlotSet& outer, const std::function<State(State)>& body) {
  Pipeline result;
  result.origin = freshSlot(".row");
  auto input = std::make_unique<InputOperator>(state.top->slots(), result.origin);
  result.input = input.get();
  State inner;
  inner.top = std::move(input);
  inner.certain = state.certain;
  inner.possible = state.possible;
  inner.sorted_by = state.sorted_by;
  inner.is_unit = false;
  inner.is_input = true;
  inner.outer = outer;
  setRows(inner, state.rows);
  result.top = body(std::move(inner)).top;
  return result;
}

double Planner::rowsAfter(const State& state, const Node& part) {
  if (part.kind == Node::Kind::Triple) return state.rows * cardinality_.fanOut(part.triple, state.certain);
  const double own = cardinality_.rows(part);
  if (state.is_unit || !state.possible.intersects(part.possible)) return state.rows * own;
  if (part.kind == Node::Kind::Values) return state.rows * std::min(own * 0.05, 1.0);
  return std::max(state.rows, own);
}

/// The cost factor of a first part whose order no other part can use: lookups and term reads then access the store
/// randomly.
double Planner::disorder(const Node& part, const std::vector<const Node*>& parts) const {
  constexpr double kScattered = 1.5;
  if (parts.size() < 2 || part.kind != Node::Kind::Triple || part.triple.path) return 1;
  const Slot slot = scannedBy(part.triple);
  const bool used = slot != kNoSlot && std::any_of(parts.begin(), parts.end(), [&](const Node* other) {
                      return other != &part && other->possible.has(slot);
                    });
  return used ? 1 : kScattered;
}

std::size_t Planner::choosePart(const State& state, const std::vector<const Node*>& parts) {
  std::size_t best = 0;
  bool best_connected = false;
  double best_rows = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const double rows = rowsAfter(state, *parts[i]) * (state.is_unit ? disorder(*parts[i], parts) : 1);
    const bool connected = state.is_unit || state.possible.intersects(parts[i]->possible) || rows <= state.rows;
    const bool better = i == 0 || (connected && !best_connected) || (connected == best_connected && rows < best_rows);
    if (!better) continue;
    best = i;
    best_connected = connected;
    best_rows = rows;
  }
  return best;
}

}  // namespace cluxel::sparql
