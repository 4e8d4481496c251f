// SPDX-License-Identifier: Apache-2.0
// Restricted copies of the syntax tree of a rule.
#include "mapping/inference/rule_queries.hpp"

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <vector>

#include "mapping/inference/rule_limits.hpp"

namespace cluxel::mapping {

namespace {

ast::InlineData inlineData(const ValuesOf& values) {
  ast::InlineData data;
  data.variables = {values.variable};
  data.row_count = values.terms.size();
  data.cells.assign(values.terms.begin(), values.terms.end());
  return data;
}

void restrictTo(ast::GroupPattern& group, const ValuesOf& values) {
  group.elements.insert(group.elements.begin(), {inlineData(values), group.at});
}

/// Leaves out what can only remove solutions, or what they may lack.
void relax(ast::GroupPattern& group) {
  const auto is_restriction = [](const ast::PatternElement& element) {
    return std::holds_alternative<ast::Filter>(element.value) ||
           std::holds_alternative<ast::OptionalPattern>(element.value) ||
           std::holds_alternative<ast::MinusPattern>(element.value) || std::holds_alternative<ast::Bind>(element.value);
  };
  std::erase_if(group.elements, is_restriction);
  for (ast::PatternElement& element : group.elements) {
    if (auto* inner = std::get_if<ast::GroupPattern>(&element.value)) relax(*inner);
    if (auto* either = std::get_if<ast::UnionPattern>(&element.value))
      for (ast::GroupPattern& branch : either->branches) relax(branch);
  }
}

bool mentions(const ast::GroupPattern& group, ast::VariableIndex variable);

bool mentions(const ast::PatternElement& element, ast::VariableIndex variable) {
  const auto is_it = [&](const ast::PatternTerm& end) { return end.isVariable() && end.variable() == variable; };
  bool found = false;
  if (const auto* block = std::get_if<ast::TriplesBlock>(&element.value))
    for (const ast::TriplePattern& triple : block->triples)
      found = found || is_it(triple.subject) || is_it(triple.object);
  if (const auto* data = std::get_if<ast::InlineData>(&element.value))
    found = std::find(data->variables.begin(), data->variables.end(), variable) != data->variables.end();
  forEachGroup(element, [&](const ast::GroupPattern& inner) { found = found || mentions(inner, variable); });
  return found;
}

bool mentions(const ast::GroupPattern& group, ast::VariableIndex variable) {
  return std::any_of(group.elements.begin(), group.elements.end(),
                     [&](const ast::PatternElement& element) { return mentions(element, variable); });
}

/// Leaves out the branches of a UNION without the variable, when nothing else has it: they go with each of its values.
void keepBranchesOf(ast::GroupPattern& group, ast::VariableIndex variable) {
  const auto has_it = [&](const ast::PatternElement& element) { return mentions(element, variable); };
  const auto only = std::find_if(group.elements.begin(), group.elements.end(), has_it);
  if (only == group.elements.end() || std::find_if(only + 1, group.elements.end(), has_it) != group.elements.end())
    return;
  auto* either = std::get_if<ast::UnionPattern>(&only->value);
  if (either == nullptr) return;
  std::erase_if(either->branches, [&](const ast::GroupPattern& branch) { return !mentions(branch, variable); });
  if (either->branches.size() > 1) return;
  const std::vector<ast::PatternElement> elements = std::move(either->branches.front().elements);
  group.elements.insert(group.elements.erase(only), elements.begin(), elements.end());
}

/// The sub-select with the patterns, to be changed in place.
ast::Select& groupedSelect(ast::GroupPattern& where) {
  for (ast::PatternElement& element : where.elements) {
    if (auto* group = std::get_if<ast::GroupPattern>(&element.value)) return groupedSelect(*group);
    if (auto* inner = std::get_if<ast::SubSelect>(&element.value)) {
      auto copy = std::make_shared<ast::Select>(*inner->select);
      ast::Select& select = *copy;
      inner->select = std::move(copy);
      return select;
    }
  }
  throw std::logic_error("a rule that groups has no sub-select");
}

void project(ast::Select& select, ast::VariableIndex variable) {
  const auto is_there = [&](const ast::Projection& column) { return column.variable == variable; };
  if (std::none_of(select.projection.begin(), select.projection.end(), is_there))
    select.projection.push_back({variable, std::nullopt, select.where.at});
}

ast::Query selectFrom(const RuleShape& shape) {
  ast::Query query = shape.query;
  query.form = ast::QueryForm::Select;
  query.construct_template.clear();
  query.select.duplicates = ast::Duplicates::Distinct;
  query.select.projection.clear();
  query.select.all = false;
  return query;
}

}  // namespace

ast::Query solutionsOf(const RuleShape& shape, const std::optional<ValuesOf>& keys, bool all) {
  ast::Query query = selectFrom(shape);
  const bool is_keyed = shape.following == RuleShape::Following::ByKey;
  if (is_keyed) project(query.select, shape.key);
  if (is_keyed && shape.is_grouped) project(groupedSelect(query.select.where), shape.key);
  for (const ast::TriplePattern& triple : shape.query.construct_template)
    for (const ast::PatternTerm* part : {&triple.subject, &triple.predicate, &triple.object})
      if (part->isVariable()) project(query.select, part->variable());
  if (all)
    for (const ReadPattern& read : shape.reads)
      for (const ast::PatternTerm* part : {&read.triple.subject, &read.triple.object})
        if (part->isVariable()) project(query.select, part->variable());
  if (keys) restrictTo(shape.is_grouped ? groupedSelect(query.select.where).where : query.select.where, *keys);
  return query;
}

ast::Query keysOf(const RuleShape& shape, const ValuesOf& values) {
  ast::Query query = selectFrom(shape);
  if (shape.is_grouped) {
    ast::GroupPattern body = groupedSelect(query.select.where).where;
    query.select.where = std::move(body);
  }
  if (!shape.is_plain) relax(query.select.where);
  keepBranchesOf(query.select.where, values.variable);
  project(query.select, shape.key);
  restrictTo(query.select.where, values);
  return query;
}

}  // namespace cluxel::mapping
