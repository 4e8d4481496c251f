// SPDX-License-Identifier: Apache-2.0
// SELECT with its modifiers to algebra, by sections 18.2.4 and 18.2.5.
#include "sparql/algebra_builder.hpp"

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
  group->children = {std::move(node)};
  group->aggregates = std::move(aggregates);
  group->annotate();
  return group;
}

NodePtr AlgebraBuilder::select(const ast::Select& select, Scope& scope, bool outermost) {
  NodePtr node = group(select.where, scope);
  const ast::SolutionModifiers& modifiers = select.modifiers;

  std::vector<AggregateSpec> aggregates;
  std::vector<Expr> having;
  std::vector<std::pair<const ast::Projection*, Expr>> columns;
  std::vector<SortKey> sort_keys;
  const Aggregation outer = aggregation_;
  aggregation_ = {};
  SlotSet inner_visible = node->possible;
  SlotSet visible = node->possible;
  if (select.grouped) {
    aggregation_ = {&aggregates, &inner_visible, &scope};
    visible = {};
    for (const ast::GroupCondition& condition : modifiers.group_by) {
      if (condition.as) {
        visible.add(slotOf(*condition.as, scope));
        inner_visible.add(slotOf(*condition.as, scope));
      }
      if (condition.expression.kind == ast::Expression::Kind::Variable) {
        visible.add(slotOf(condition.expression.variable, scope));
      }
    }
  }
  for (const ast::Expression& condition : modifiers.having) having.push_back(expression(condition, scope, visible));
  if (select.values) {
    for (const ast::VariableIndex variable : select.values->variables) visible.add(slotOf(variable, scope));
  }
  for (const ast::Projection& column : select.projection) {
    if (!column.expression) continue;
    columns.emplace_back(&column, expression(*column.expression, scope, visible));
    visible.add(slotOf(column.variable, scope));
  }
  for (const ast::OrderCondition& condition : modifiers.order_by) {
    sort_keys.push_back({expression(condition.expression, scope, visible), condition.descending});
  }
  aggregation_ = outer;

  if (select.grouped) node = grouped(node, select, scope, aggregates);
  if (!having.empty()) {
    NodePtr filter = makeNode(Node::Kind::Filter, modifiers.having.front().at);
    filter->children = {node};
    filter->conditions = std::move(having);
    filter->annotate();
    node = filter;
  }
  if (select.values) node = join(node, values(*select.values, scope), scope);
  for (auto& [column, value] : columns) {
    node = extend(node, slotOf(column->variable, scope), std::move(value), column->at);
  }
  const bool sliced = modifiers.limit || modifiers.offset;
  if (!sort_keys.empty() && (outermost || sliced)) {
    NodePtr order = makeNode(Node::Kind::OrderBy, select.where.at);
    order->children = {node};
    order->sort_keys = std::move(sort_keys);
    order->annotate();
    node = order;
  }
  NodePtr project = makeNode(Node::Kind::Project, select.where.at);
  for (const ast::Projection& column : select.projection) project->slots.push_back(slotOf(column.variable, scope));
  if (!select.projection.empty() || !outermost) {
    project->children = {node};
    project->annotate();
    node = project;
  }
  if (select.duplicates == ast::Duplicates::Distinct) {
    NodePtr distinct = makeNode(Node::Kind::Distinct, select.where.at);
    distinct->children = {node};
    distinct->slots = project->slots;
    distinct->annotate();
    node = distinct;
  }
  if (sliced) {
    NodePtr slice = makeNode(Node::Kind::Slice, select.where.at);
    slice->children = {node};
    slice->offset = modifiers.offset.value_or(0);
    slice->limit = modifiers.limit;
    slice->annotate();
    node = slice;
  }
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
  // Templates and DESCRIBE may name variables that the pattern does not have.
  for (ast::VariableIndex i = 0; i < query.variables.size(); ++i) builder.slotOf(i, scope);
  AlgebraQuery result = builder.finish(std::move(root), scope);
  result.projection = std::move(projection);
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
