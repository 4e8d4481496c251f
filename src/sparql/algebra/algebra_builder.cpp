// SPDX-License-Identifier: Apache-2.0
// Translates group graph patterns to algebra (SPARQL 1.1 section 18.2.2; step numbers refer to it).
#include "sparql/algebra/algebra_builder.hpp"

#include <algorithm>

#include "base/shown_line.hpp"
#include "cluxel/error.hpp"
#include "sparql/exec/guard.hpp"
#include "sparql/syntax/mentions.hpp"
#include "sparql/syntax/source_text.hpp"

namespace cluxel::sparql {
namespace {

bool isSameGraph(const GraphPlace& a, const GraphPlace& b) {
  return a.kind == b.kind && a.slot == b.slot && a.constant == b.constant;
}

/// True when every solution of the node comes from a quad of that graph, so that the graph exists.
bool readsGraph(const Node& node, const GraphPlace& graph) {
  const auto reads = [&graph](const NodePtr& child) { return readsGraph(*child, graph); };
  switch (node.kind) {
    case Node::Kind::Triple:
      return !node.triple.path && isSameGraph(node.triple.graph, graph);
    case Node::Kind::GraphNames:
      return isSameGraph(node.graph, graph);
    case Node::Kind::Join:
      return std::any_of(node.children.begin(), node.children.end(), reads);
    case Node::Kind::Union:
      return std::all_of(node.children.begin(), node.children.end(), reads);
    case Node::Kind::LeftJoin:
    case Node::Kind::Filter:
    case Node::Kind::Minus:
    case Node::Kind::Extend:
      return reads(node.children[0]);
    default:
      return false;
  }
}

/// Splits a condition into conjuncts. Equivalent under three-valued logic: an error in one makes the conjunction an
/// error or false.
void splitConjuncts(Expr condition, std::vector<Expr>& out) {
  if (condition.kind != Expr::Kind::And) {
    out.push_back(std::move(condition));
    return;
  }
  for (Expr& argument : condition.arguments) splitConjuncts(std::move(argument), out);
}

}  // namespace

struct AlgebraBuilder::GroupParts {
  NodePtr pattern;
  std::vector<const ast::Expression*> filters;
};

AlgebraBuilder::AlgebraBuilder(const ast::VariableTable& variables, std::string_view text, QueryTerms& terms,
                               const AlgebraOptions& options)
    : variables_(variables), text_(text), terms_(terms), options_(options) {}

Scope AlgebraBuilder::outermostScope() {
  Scope scope;
  scope.slot_of.assign(variables_.size(), kNoSlot);
  for (ast::VariableIndex i = 0; i < variables_.size(); ++i) {
    const auto& names = options_.parameters;
    if (variables_[i].hidden || std::find(names.begin(), names.end(), variables_[i].name) == names.end()) continue;
    const Slot slot = slotOf(i, scope);
    parameters_.add(slot);
    parameter_list_.push_back(slot);
  }
  return scope;
}

AlgebraQuery AlgebraBuilder::finish(NodePtr root, const Scope& scope) {
  AlgebraQuery query;
  query.root = std::move(root);
  query.slot_names = std::move(slot_names_);
  query.slot_of_variable = scope.slot_of;
  query.parameters = parameter_list_;
  query.exists_count = exists_count_;
  query.is_volatile = is_volatile_;
  query.warnings = std::move(warnings_);
  return query;
}

void AlgebraBuilder::warn(ast::SourceOffset at, std::string message, std::string hint) {
  if (warnings_.size() >= kMaxFaults) return;
  const auto same = [&message](const ExpressionWarning& warning) { return warning.message == message; };
  if (std::none_of(warnings_.begin(), warnings_.end(), same))
    warnings_.push_back({at, std::move(message), std::move(hint)});
}

void AlgebraBuilder::fail(ast::SourceOffset at, std::string message, std::string hint, Remedy remedy) const {
  failAt(options_.source_name, text_, at, std::move(message), std::move(hint), remedy);
}

/// Limits the number of parts: planning is quadratic in it, and the algebra is as deep as a group is long.
void AlgebraBuilder::countPart(ast::SourceOffset at) {
  constexpr std::size_t kMaxParts = 2000;
  if (++parts_ > kMaxParts) {
    fail(at, "the query has more than " + std::to_string(kMaxParts) + " patterns, filters and binds",
         "ask it in parts; a long list of terms goes into VALUES or IN");
  }
}

Slot AlgebraBuilder::freshSlot(std::string name) {
  slot_names_.push_back(std::move(name));
  return static_cast<Slot>(slot_names_.size() - 1);
}

Slot AlgebraBuilder::slotOf(ast::VariableIndex variable, Scope& scope) {
  Slot& slot = scope.slot_of[variable];
  if (slot == kNoSlot) {
    slot = freshSlot(variables_[variable].hidden ? "." + variables_[variable].name : variables_[variable].name);
  }
  return slot;
}

PatternPlace AlgebraBuilder::place(const ast::PatternTerm& term, Scope& scope) {
  if (term.isVariable()) return {slotOf(term.variable(), scope), kUnbound};
  return {kNoSlot, terms_.intern(term.term())};
}

NodePtr AlgebraBuilder::unit(const Scope& scope) {
  NodePtr node = makeNode(scope.graph.kind == GraphPlace::Kind::Default ? Node::Kind::Unit : Node::Kind::GraphNames);
  node->graph = scope.graph;
  node->annotate();
  return node;
}

NodePtr AlgebraBuilder::join(NodePtr a, NodePtr b, const Scope&) {
  if (a->kind == Node::Kind::Unit) return b;
  if (b->kind == Node::Kind::Unit) return a;
  if (a->kind == Node::Kind::GraphNames && readsGraph(*b, a->graph)) return b;
  if (b->kind == Node::Kind::GraphNames && readsGraph(*a, b->graph)) return a;
  NodePtr node = makeNode(Node::Kind::Join, a->at);
  for (const NodePtr& side : {a, b}) {
    if (side->kind == Node::Kind::Join) {
      node->children.insert(node->children.end(), side->children.begin(), side->children.end());
    } else {
      node->children.push_back(side);
    }
  }
  node->annotate();
  return node;
}

NodePtr AlgebraBuilder::group(const ast::GroupPattern& pattern, Scope& scope) {
  GroupParts parts = groupParts(pattern, scope);
  return filtered(std::move(parts.pattern), parts.filters, scope);
}

AlgebraBuilder::GroupParts AlgebraBuilder::groupParts(const ast::GroupPattern& pattern, Scope& scope) {
  GroupParts parts;
  parts.pattern = unit(scope);
  for (const ast::PatternElement& part : pattern.elements) {
    countPart(part.at);
    if (const auto* filter = std::get_if<ast::Filter>(&part.value)) {
      parts.filters.push_back(&filter->condition);
    } else if (const auto* optional = std::get_if<ast::OptionalPattern>(&part.value)) {
      parts.pattern = leftJoin(parts.pattern, optional->group, scope);
    } else if (const auto* minus = std::get_if<ast::MinusPattern>(&part.value)) {
      NodePtr node = makeNode(Node::Kind::Minus, part.at);
      node->children = {parts.pattern, group(minus->group, scope)};
      if (scope.graph.kind == GraphPlace::Kind::Slot) node->minus_ignores = scope.graph.slot;
      node->annotate();
      parts.pattern = node;
    } else if (const auto* bind = std::get_if<ast::Bind>(&part.value)) {
      SlotSet visible = parts.pattern->possible;
      Expr value = expression(bind->expression, scope, visible);
      parts.pattern = extend(parts.pattern, slotOf(bind->variable, scope), std::move(value), part.at);
    } else {
      parts.pattern = join(parts.pattern, element(part, scope), scope);
    }
  }
  return parts;
}

NodePtr AlgebraBuilder::leftJoin(NodePtr node, const ast::GroupPattern& pattern, Scope& scope) {
  GroupParts optional = groupParts(pattern, scope);
  NodePtr joined = makeNode(Node::Kind::LeftJoin, pattern.at);
  joined->children = {std::move(node), optional.pattern};
  joined->annotate();
  for (const ast::Expression* filter : optional.filters) {
    splitConjuncts(expression(*filter, scope, joined->possible), joined->conditions);
  }
  return joined;
}

NodePtr AlgebraBuilder::filtered(NodePtr node, const std::vector<const ast::Expression*>& filters, Scope& scope) {
  if (filters.empty()) return node;
  NodePtr filter = makeNode(Node::Kind::Filter, filters.front()->at);
  for (const ast::Expression* condition : filters) {
    splitConjuncts(expression(*condition, scope, node->possible), filter->conditions);
  }
  for (const Expr& condition : filter->conditions) countPart(condition.at);
  filter->children = {std::move(node)};
  filter->annotate();
  return filter;
}

NodePtr AlgebraBuilder::extend(NodePtr node, Slot slot, Expr value, ast::SourceOffset at) {
  countPart(at);
  NodePtr extended = makeNode(Node::Kind::Extend, at);
  extended->children = {std::move(node)};
  extended->slot = slot;
  extended->expression = std::move(value);
  extended->annotate();
  return extended;
}

NodePtr AlgebraBuilder::element(const ast::PatternElement& part, Scope& scope) {
  if (const auto* block = std::get_if<ast::TriplesBlock>(&part.value)) return triples(*block, scope);
  if (const auto* inner = std::get_if<ast::GroupPattern>(&part.value)) return group(*inner, scope);
  if (const auto* graph = std::get_if<ast::GraphPattern>(&part.value)) return graphPattern(*graph, scope);
  if (const auto* data = std::get_if<ast::InlineData>(&part.value)) return values(*data, scope);
  if (const auto* both = std::get_if<ast::UnionPattern>(&part.value)) {
    NodePtr node = makeNode(Node::Kind::Union, part.at);
    for (const ast::GroupPattern& branch : both->branches) node->children.push_back(group(branch, scope));
    node->annotate();
    return node;
  }
  if (const auto* sub = std::get_if<ast::SubSelect>(&part.value)) return subSelect(*sub, scope);
  return service(std::get<ast::ServicePattern>(part.value), part.at, scope);
}

NodePtr AlgebraBuilder::subSelect(const ast::SubSelect& sub, Scope& scope) {
  Scope inner = scope;
  inner.slot_of.assign(variables_.size(), kNoSlot);
  for (const ast::Projection& column : sub.select->projection) {
    inner.slot_of[column.variable] = slotOf(column.variable, scope);
  }
  for (ast::VariableIndex i = 0; i < variables_.size(); ++i) {
    if (scope.slot_of[i] != kNoSlot && isParameter(scope.slot_of[i])) inner.slot_of[i] = scope.slot_of[i];
  }
  return select(*sub.select, inner, false);
}

NodePtr AlgebraBuilder::graphPattern(const ast::GraphPattern& pattern, Scope& scope) {
  const GraphPlace outer = scope.graph;
  const PatternPlace name = place(pattern.graph, scope);
  // The graph variable is not in scope inside; if its name is used there too, both are joined afterwards.
  const bool hidden = name.isSlot() && mentions(pattern.group, pattern.graph.variable());
  scope.graph = name.isSlot() ? GraphPlace{GraphPlace::Kind::Slot, hidden ? freshSlot(".graph") : name.slot, kUnbound}
                              : GraphPlace{GraphPlace::Kind::Constant, kNoSlot, name.constant};
  NodePtr node = group(pattern.group, scope);
  if (name.isSlot() && hasSubSelect(pattern.group)) {
    NodePtr loop = makeNode(Node::Kind::GraphLoop, pattern.graph.at);
    loop->children = {node};
    loop->graph = scope.graph;
    loop->annotate();
    node = loop;
  }
  if (hidden) {
    Expr graph;
    graph.kind = Expr::Kind::Slot;
    graph.slot = scope.graph.slot;
    node = extend(node, name.slot, std::move(graph), pattern.graph.at);
  }
  scope.graph = outer;
  return node;
}

NodePtr AlgebraBuilder::values(const ast::InlineData& data, Scope& scope) {
  NodePtr node = makeNode(Node::Kind::Values);
  for (const ast::VariableIndex variable : data.variables) node->slots.push_back(slotOf(variable, scope));
  node->rows.count = data.row_count;
  node->rows.cells.reserve(data.cells.size());
  for (const std::optional<Term>& term : data.cells) {
    node->rows.cells.push_back(term ? terms_.intern(*term) : kUnbound);
    if (options_.guard != nullptr) options_.guard->spend(sizeof(Term));
  }
  node->annotate();
  return node;
}

}  // namespace cluxel::sparql
