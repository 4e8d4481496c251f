// SPDX-License-Identifier: Apache-2.0
// Slot sets, and the slots that a pattern binds.
#include "sparql/algebra/algebra.hpp"

#include <algorithm>
#include <bit>

namespace cluxel::sparql {

void SlotSet::add(Slot slot) {
  if (slot / 64 >= words_.size()) words_.resize(slot / 64 + 1, 0);
  words_[slot / 64] |= 1ull << (slot % 64);
}

void SlotSet::add(const SlotSet& other) {
  if (words_.size() < other.words_.size()) words_.resize(other.words_.size(), 0);
  for (std::size_t i = 0; i < other.words_.size(); ++i) words_[i] |= other.words_[i];
}

void SlotSet::remove(Slot slot) {
  if (slot / 64 < words_.size()) words_[slot / 64] &= ~(1ull << (slot % 64));
}

bool SlotSet::intersects(const SlotSet& other) const {
  for (std::size_t i = 0; i < std::min(words_.size(), other.words_.size()); ++i) {
    if ((words_[i] & other.words_[i]) != 0) return true;
  }
  return false;
}

bool SlotSet::contains(const SlotSet& other) const {
  return (other - *this).empty();
}

bool SlotSet::empty() const {
  return std::all_of(words_.begin(), words_.end(), [](std::uint64_t word) { return word == 0; });
}

SlotSet SlotSet::operator&(const SlotSet& other) const {
  SlotSet result;
  result.words_.resize(std::min(words_.size(), other.words_.size()));
  for (std::size_t i = 0; i < result.words_.size(); ++i) result.words_[i] = words_[i] & other.words_[i];
  return result;
}

SlotSet SlotSet::operator-(const SlotSet& other) const {
  SlotSet result = *this;
  for (std::size_t i = 0; i < std::min(words_.size(), other.words_.size()); ++i) result.words_[i] &= ~other.words_[i];
  return result;
}

std::vector<Slot> SlotSet::list() const {
  std::vector<Slot> slots;
  for (std::size_t i = 0; i < words_.size(); ++i) {
    for (std::uint64_t word = words_[i]; word != 0; word &= word - 1) {
      slots.push_back(static_cast<Slot>(i * 64 + static_cast<std::size_t>(std::countr_zero(word))));
    }
  }
  return slots;
}

SlotSet Expr::slots() const {
  SlotSet result;
  if (kind == Kind::Slot || kind == Kind::Bound) result.add(slot);
  for (const Expr& argument : arguments) result.add(argument.slots());
  if (pattern) result.add(pattern->mentioned());
  return result;
}

bool Expr::isVolatile() const {
  if (function != nullptr && function->is_volatile) return true;
  return std::any_of(arguments.begin(), arguments.end(), [](const Expr& argument) { return argument.isVolatile(); });
}

NodePtr makeNode(Node::Kind kind, ast::SourceOffset at) {
  auto node = std::make_shared<Node>();
  node->kind = kind;
  node->at = at;
  return node;
}

SlotSet Node::mentioned() const {
  SlotSet result = possible;
  for (const NodePtr& child : children) result.add(child->mentioned());
  for (const Expr& condition : conditions) result.add(condition.slots());
  if (expression) result.add(expression->slots());
  for (const AggregateSpec& aggregate : aggregates) {
    if (aggregate.argument) result.add(aggregate.argument->slots());
  }
  for (const SortKey& key : sort_keys) result.add(key.expression.slots());
  for (const Slot key : slots) result.add(key);
  return result;
}

namespace {

void addPlace(const PatternPlace& place, SlotSet& slots) {
  if (place.isSlot()) slots.add(place.slot);
}

/// Slots that are bound in every solution that satisfies the condition: comparing an unbound variable is an error.
void addRequired(const Expr& condition, SlotSet& slots) {
  using Kind = Expr::Kind;
  if (condition.kind == Kind::Bound) slots.add(condition.slot);
  if (condition.kind == Kind::And) {
    for (const Expr& argument : condition.arguments) addRequired(argument, slots);
  }
  const bool comparison = condition.kind >= Kind::Equal && condition.kind <= Kind::GreaterEqual;
  const bool strict_call = condition.kind == Kind::Call;
  if (!comparison && !strict_call) return;
  for (const Expr& argument : condition.arguments) {
    if (argument.kind == Kind::Slot) slots.add(argument.slot);
    if (argument.kind == Kind::Call || (argument.kind >= Kind::Add && argument.kind <= Kind::Plus)) {
      for (const Expr& inner : argument.arguments) {
        if (inner.kind == Kind::Slot) slots.add(inner.slot);
      }
    }
  }
}

void annotateTriple(Node& node) {
  addPlace(node.triple.subject, node.possible);
  if (!node.triple.path) addPlace(node.triple.predicate, node.possible);
  addPlace(node.triple.object, node.possible);
  if (node.triple.graph.kind == GraphPlace::Kind::Slot) node.possible.add(node.triple.graph.slot);
  node.certain = node.possible;
}

void annotateValues(Node& node) {
  for (std::size_t column = 0; column < node.slots.size(); ++column) {
    bool all = true, any = false;
    for (std::size_t cell = column; cell < node.rows.cells.size(); cell += node.slots.size()) {
      all = all && node.rows.cells[cell] != kUnbound;
      any = any || node.rows.cells[cell] != kUnbound;
    }
    if (any) node.possible.add(node.slots[column]);
    if (any && all) node.certain.add(node.slots[column]);
  }
}

void annotateGroup(Node& node) {
  for (const Slot key : node.slots) {
    if (node.children[0]->possible.has(key)) node.possible.add(key);
    if (node.children[0]->certain.has(key)) node.certain.add(key);
  }
  for (const AggregateSpec& aggregate : node.aggregates) {
    node.possible.add(aggregate.result);
    if (aggregate.function == ast::AggregateFunction::Count) node.certain.add(aggregate.result);
  }
}

void annotateUnion(Node& node) {
  bool first = true;
  for (const NodePtr& child : node.children) {
    node.possible.add(child->possible);
    node.certain = first ? child->certain : node.certain & child->certain;
    first = false;
  }
}

void annotateProject(Node& node) {
  SlotSet kept;
  for (const Slot column : node.slots) kept.add(column);
  node.possible = node.possible & kept;
  node.certain = node.certain & kept;
}

void annotateExtend(Node& node) {
  const Expr& value = *node.expression;
  node.possible.add(node.slot);
  if (value.kind == Expr::Kind::Constant || (value.kind == Expr::Kind::Slot && node.certain.has(value.slot))) {
    node.certain.add(node.slot);
  }
}

void annotateJoin(Node& node) {
  for (const NodePtr& child : node.children) {
    node.possible.add(child->possible);
    node.certain.add(child->certain);
  }
}

}  // namespace

void Node::annotate() {
  possible = certain = {};
  if (!children.empty() && kind != Kind::Union) {
    possible = children[0]->possible;
    certain = children[0]->certain;
  }
  switch (kind) {
    case Kind::Unit:
    case Kind::Nothing:
      return;
    case Kind::Triple:
      return annotateTriple(*this);
    case Kind::GraphNames:
      if (graph.kind == GraphPlace::Kind::Slot) possible.add(graph.slot);
      certain = possible;
      return;
    case Kind::Join:
      return annotateJoin(*this);
    case Kind::LeftJoin:
      possible.add(children[1]->possible);
      return;
    case Kind::Filter:
      for (const Expr& condition : conditions) addRequired(condition, certain);
      certain = certain & possible;
      return;
    case Kind::Union:
      return annotateUnion(*this);
    case Kind::Extend:
      return annotateExtend(*this);
    case Kind::Values:
      return annotateValues(*this);
    case Kind::Group:
      possible = certain = {};
      return annotateGroup(*this);
    case Kind::Project:
      return annotateProject(*this);
    case Kind::GraphLoop:
      possible.add(graph.slot);
      certain.add(graph.slot);
      return;
    case Kind::Minus:
    case Kind::OrderBy:
    case Kind::Distinct:
    case Kind::Slice:
      return;
  }
}

}  // namespace cluxel::sparql
