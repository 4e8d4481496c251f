// SPDX-License-Identifier: Apache-2.0
// Translates SELECT and solution modifiers (sections 18.2.4 and 18.2.5).
#include "sparql/algebra/algebra_builder.hpp"

namespace cluxel::sparql {

NodePtr AlgebraBuilder::grouped(NodePtr node, const ast::Select& select, Scope& scope,
                                std::vector<AggregateSpec>& aggregates) {
  NodePtr group = makeNode(Node::Kind::Group, select.where.at);
  group->grouped_by_keys = !select.modifiers.group_by.empty();
  for (const ast::GroupCondition& condition : select.modifiers.group_by) {
    Expr key = expression(condition.expression, scope, node->possible);
    if (key.kind == Expr::Kind::Slot && !condition.as) {
      group->slots.push_back(key.slot);
      continue;
    }
    const Slot slot = condition.as ? slotOf(*condition.as, scope) : freshSlot(".key");
    node = extend(node, slot, std::move(key), condition.expression.at);
    group->slots.push_back(slot);
  }
  for (AggregateSpec& aggregate : aggregates) {
    if (aggregate.argument || !aggregate.distinct) continue;
    // Blank nodes and intermediate path nodes are not variables.
    for (const Slot slot : node->possible.list()) {
      if (!slot_names_[slot].starts_with('.')) aggregate.row_slots.push_back(slot);
    }
  }
  group->children = {std::move(node)};
  group->aggregates = std::move(aggregates);
  group->annotate();
  return group;
}

struct AlgebraBuilder::SelectParts {
  std::vector<AggregateSpec> aggregates;
  std::vector<Expr> having;
  std::vector<std::pair<const ast::Projection*, Expr>> columns;
  std::vector<SortKey> sort_keys;
};

/// Adds the variables that GROUP BY exposes to `visible`; variables it defines may be used inside aggregates.
void AlgebraBuilder::addGroupKeys(const ast::Select& select, Scope& scope, SlotSet& visible, SlotSet& inner_visible) {
  for (const ast::GroupCondition& condition : select.modifiers.group_by) {
    if (condition.as) {
      visible.add(slotOf(*condition.as, scope));
      inner_visible.add(slotOf(*condition.as, scope));
    }
    if (condition.expression.kind == ast::Expression::Kind::Variable) {
      visible.add(slotOf(condition.expression.variable, scope));
    }
  }
}

/// Translates the expressions of HAVING, SELECT and ORDER BY and extracts their aggregates.
AlgebraBuilder::SelectParts AlgebraBuilder::selectParts(const ast::Select& select, Scope& scope, const SlotSet& bound) {
  SelectParts parts;
  SlotSet inner_visible = bound, visible = bound;
  const Aggregation outer = aggregation_;
  aggregation_ = {};
  if (select.grouped) {
    aggregation_ = {&parts.aggregates, &inner_visible, &scope};
    visible = {};
    addGroupKeys(select, scope, visible, inner_visible);
  }
  for (const ast::Expression& condition : select.modifiers.having) {
    parts.having.push_back(expression(condition, scope, visible));
  }
  if (select.values) {
    for (const ast::VariableIndex variable : select.values->variables) visible.add(slotOf(variable, scope));
  }
  for (const ast::Projection& column : select.projection) {
    if (!column.expression) continue;
    parts.columns.emplace_back(&column, expression(*column.expression, scope, visible));
    visible.add(slotOf(column.variable, scope));
  }
  for (const ast::OrderCondition& condition : select.modifiers.order_by) {
    parts.sort_keys.push_back({expression(condition.expression, scope, visible), condition.descending});
  }
  aggregation_ = outer;
  return parts;
}

NodePtr AlgebraBuilder::select(const ast::Select& select, Scope& scope, bool outermost) {
  NodePtr node = group(select.where, scope);
  SelectParts parts = selectParts(select, scope, node->possible);
  if (select.grouped) node = grouped(node, select, scope, parts.aggregates);
  if (!parts.having.empty()) {
    NodePtr filter = above(Node::Kind::Filter, node, select.modifiers.having.front().at);
    filter->conditions = std::move(parts.having);
    filter->annotate();
    node = filter;
  }
  if (select.values) node = join(node, values(*select.values, scope), scope);
  for (auto& [column, value] : parts.columns) {
    node = extend(node, slotOf(column->variable, scope), std::move(value), column->at);
  }
  return modified(std::move(node), select, std::move(parts.sort_keys), scope, outermost);
}

/// ORDER BY, projection, DISTINCT, OFFSET and LIMIT. The order of a sub-select matters only with LIMIT or OFFSET.
NodePtr AlgebraBuilder::modified(NodePtr node, const ast::Select& select, std::vector<SortKey> sort_keys, Scope& scope,
                                 bool outermost) {
  const ast::SolutionModifiers& modifiers = select.modifiers;
  const bool sliced = modifiers.limit || modifiers.offset;
  if (sliced && options_.refuse_volatile) requireOneCut(select, outermost);
  if (!sort_keys.empty() && (outermost || sliced)) {
    node = above(Node::Kind::OrderBy, std::move(node), select.where.at);
    node->sort_keys = std::move(sort_keys);
    node->annotate();
  }
  std::vector<Slot> columns;
  for (const ast::Projection& column : select.projection) columns.push_back(slotOf(column.variable, scope));
  if (!columns.empty() || !outermost) {
    node = above(Node::Kind::Project, std::move(node), select.where.at);
    node->slots = columns;
    node->annotate();
  }
  if (select.duplicates == ast::Duplicates::Distinct) {
    node = above(Node::Kind::Distinct, std::move(node), select.where.at);
    node->slots = columns;
    node->annotate();
  }
  if (sliced) {
    node = above(Node::Kind::Slice, std::move(node), select.where.at);
    node->offset = modifiers.offset.value_or(0);
    node->limit = modifiers.limit;
    node->annotate();
  }
  return node;
}

/// Refuses LIMIT and OFFSET whose result would depend on storage order. ORDER BY breaks ties by the terms of all
/// columns, so its order is total.
void AlgebraBuilder::requireOneCut(const ast::Select& select, bool outermost) const {
  const bool has_columns = !outermost || !select.projection.empty();
  if (has_columns && !select.modifiers.order_by.empty()) return;
  fail(select.where.at,
       "LIMIT and OFFSET are refused here without the ORDER BY of a SELECT: which rows they keep would follow "
       "from how the map is stored, not from what it says",
       "sort and cut in a sub-select: { SELECT ... WHERE { ... } ORDER BY ... LIMIT ... }");
}

NodePtr AlgebraBuilder::above(Node::Kind kind, NodePtr child, ast::SourceOffset at) {
  NodePtr node = makeNode(kind, at);
  node->children = {std::move(child)};
  return node;
}

AlgebraQuery buildAlgebra(const ast::Query& query, QueryTerms& terms, const AlgebraOptions& options) {
  AlgebraBuilder builder(query.variables, query.text, terms, options);
  Scope scope = builder.outermostScope();
  NodePtr root = builder.select(query.select, scope, true);
  std::vector<Slot> projection;
  for (const ast::Projection& column : query.select.projection) {
    projection.push_back(builder.slotOf(column.variable, scope));
  }
  // Templates and DESCRIBE may use variables that do not occur in the pattern.
  for (ast::VariableIndex i = 0; i < query.variables.size(); ++i) builder.slotOf(i, scope);
  AlgebraQuery result = builder.finish(std::move(root), scope);
  result.projection = std::move(projection);
  result.wants_one = query.form == ast::QueryForm::Ask;
  return result;
}

AlgebraQuery buildAlgebra(const ast::GroupPattern& where, const ast::VariableTable& variables, const std::string& text,
                          QueryTerms& terms, const AlgebraOptions& options) {
  AlgebraBuilder builder(variables, text, terms, options);
  Scope scope = builder.outermostScope();
  NodePtr root = builder.group(where, scope);
  for (ast::VariableIndex i = 0; i < variables.size(); ++i) builder.slotOf(i, scope);
  return builder.finish(std::move(root), scope);
}

}  // namespace cluxel::sparql
