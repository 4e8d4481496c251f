// SPDX-License-Identifier: Apache-2.0
// Parses the SELECT clause and solution modifiers, and checks their scope rules.
#include <charconv>

#include "sparql/syntax/sparql_parser.hpp"

namespace cluxel::sparql {

void SparqlParser::selectClause(ast::Select& select) {
  expect(Keyword::Select);
  if (take(Keyword::Distinct))
    select.duplicates = ast::Duplicates::Distinct;
  else if (take(Keyword::Reduced))
    select.duplicates = ast::Duplicates::Reduced;
  select.all = take(Kind::Star);
  if (select.all) return;
  const AggregateUse use = std::exchange(aggregate_use_, AggregateUse::Allowed);
  do selectItem(select);
  while (is(Kind::Var) || is(Kind::LeftParen));
  aggregate_use_ = use;
}

void SparqlParser::selectItem(ast::Select& select) {
  ast::Projection item;
  item.at = here();
  if (take(Kind::LeftParen)) {
    item.expression = expression();
    expect(Keyword::As);
    item.at = here();
    item.variable = variable("a variable after AS");
    expect(Kind::RightParen, "')' after the variable");
  } else {
    item.variable = variable("a variable, (expression AS ?variable) or '*'");
  }
  select.projection.push_back(std::move(item));
}

void SparqlParser::solutionModifiers(ast::Select& select, const VariableSet& visible) {
  if (take(Keyword::Group)) groupClause(select, visible);
  const AggregateUse use = std::exchange(aggregate_use_, AggregateUse::Allowed);
  if (take(Keyword::Having)) {
    do select.modifiers.having.push_back(constraint("a condition after HAVING"));
    while (isConstraintStart());
  }
  if (take(Keyword::Order)) orderClause(select);
  aggregate_use_ = use;
  limitOffset(select.modifiers);
  if (take(Keyword::Values)) select.values = inlineData();
}

void SparqlParser::groupClause(ast::Select& select, const VariableSet& visible) {
  expect(Keyword::By);
  const AggregateUse use = std::exchange(aggregate_use_, AggregateUse::Refused);
  do select.modifiers.group_by.push_back(groupCondition(visible));
  while (is(Kind::Var) || isConstraintStart());
  aggregate_use_ = use;
}

ast::GroupCondition SparqlParser::groupCondition(const VariableSet& visible) {
  ast::GroupCondition condition;
  if (is(Kind::Var)) {
    condition.expression.kind = ast::Expression::Kind::Variable;
    condition.expression.at = here();
    condition.expression.variable = variable();
    return condition;
  }
  if (!take(Kind::LeftParen)) {
    condition.expression = constraint("a variable, a call or (expression AS ?variable)");
    return condition;
  }
  condition.expression = expression();
  if (take(Keyword::As)) {
    const ast::SourceOffset at = here();
    condition.as = variable("a variable after AS");
    if (visible.contains(*condition.as))
      fail(at, "?" + variables_[*condition.as].name + " already has a value in the pattern", "choose another name");
  }
  expect(Kind::RightParen, "')', AS or an operator");
  return condition;
}

void SparqlParser::orderClause(ast::Select& select) {
  expect(Keyword::By);
  do select.modifiers.order_by.push_back(orderCondition());
  while (is(Kind::Var) || is(Keyword::Asc) || is(Keyword::Desc) || isConstraintStart());
}

ast::OrderCondition SparqlParser::orderCondition() {
  ast::OrderCondition condition;
  if (is(Keyword::Asc) || is(Keyword::Desc)) {
    condition.descending = is(Keyword::Desc);
    advance();
    condition.expression = bracketted();
  } else if (is(Kind::Var)) {
    condition.expression.kind = ast::Expression::Kind::Variable;
    condition.expression.at = here();
    condition.expression.variable = variable();
  } else {
    condition.expression = constraint("a variable, a call, ( ), ASC( ) or DESC( )");
  }
  return condition;
}

void SparqlParser::limitOffset(ast::SolutionModifiers& modifiers) {
  for (;;) {
    if (!modifiers.limit && take(Keyword::Limit))
      modifiers.limit = count("a whole number after LIMIT");
    else if (!modifiers.offset && take(Keyword::Offset))
      modifiers.offset = count("a whole number after OFFSET");
    else
      return;
  }
}

std::uint64_t SparqlParser::count(std::string_view expected) {
  if (!is(Kind::Integer)) unexpected(expected);
  const std::string_view digits = slice(token_);
  std::uint64_t value = 0;
  if (std::from_chars(digits.data(), digits.data() + digits.size(), value).ec != std::errc()) value = UINT64_MAX;
  advance();
  return value;
}

/// Expands SELECT * and checks the grammar notes on the projection.
void SparqlParser::finishSelect(ast::Select& select, const VariableSet& where_visible) {
  VariableSet visible = where_visible;
  if (select.values) addVisible(*select.values, visible);
  select.grouped =
      !select.modifiers.group_by.empty() || !select.modifiers.having.empty() || std::exchange(saw_aggregate_, false);
  if (select.all) {
    if (select.grouped) fail(select.where.at, "SELECT * cannot be grouped", "name the variables to select");
    for (const ast::VariableIndex index : visible.items())
      if (!variables_[index].hidden) select.projection.push_back({index, std::nullopt, 0});
    return;
  }
  checkProjection(select, visible);
  if (select.grouped) checkGrouping(select);
}

void SparqlParser::checkProjection(const ast::Select& select, const VariableSet& visible) const {
  VariableSet earlier;
  for (const ast::Projection& item : select.projection) {
    const std::string& name = variables_[item.variable].name;
    if (item.expression && visible.contains(item.variable))
      fail(item.at, "?" + name + " already has a value in the pattern", "choose another name after AS");
    if (item.expression && earlier.contains(item.variable))
      fail(item.at, "?" + name + " is selected before", "choose another name after AS");
    earlier.add(item.variable);
  }
}

/// Every selected variable must be a group key or occur inside an aggregate.
void SparqlParser::checkGrouping(const ast::Select& select) const {
  VariableSet known;
  for (const ast::GroupCondition& condition : select.modifiers.group_by) {
    if (condition.as)
      known.add(*condition.as);
    else if (condition.expression.kind == ast::Expression::Kind::Variable)
      known.add(condition.expression.variable);
  }
  if (select.values) addVisible(*select.values, known);
  for (const ast::Projection& item : select.projection) {
    ast::Expression plain;
    plain.kind = ast::Expression::Kind::Variable;
    plain.variable = item.variable;
    plain.at = item.at;
    requireGrouped(item.expression ? *item.expression : plain, known);
    known.add(item.variable);
  }
}

void SparqlParser::requireGrouped(const ast::Expression& expression, const VariableSet& known) const {
  if (expression.kind == ast::Expression::Kind::Aggregate) return;
  if (expression.kind == ast::Expression::Kind::Function && expression.distinct) return;
  if (expression.kind == ast::Expression::Kind::Variable && !known.contains(expression.variable))
    fail(expression.at, "?" + variables_[expression.variable].name + " is neither grouped by nor inside an aggregate",
         "add it to GROUP BY, or use SAMPLE, MIN or MAX");
  for (const ast::Expression& argument : expression.arguments) requireGrouped(argument, known);
}

}  // namespace cluxel::sparql
