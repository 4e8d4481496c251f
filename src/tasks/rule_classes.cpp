// SPDX-License-Identifier: Apache-2.0
// Follows the variable that stands for the class to the constants that it can be.
#include "tasks/rule_classes.hpp"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "mapping/inference/rule_limits.hpp"
#include "mapping/inference/rule_shape.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::tasks {

namespace {

namespace ast = sparql::ast;
using ExpressionKind = ast::Expression::Kind;

bool is(const ast::PatternTerm& term, ast::VariableIndex variable) {
  return term.isVariable() && term.variable() == variable;
}

/// The column of a variable that is in each row; none when it is missing somewhere.
std::optional<std::size_t> wholeColumn(const ast::InlineData& data, ast::VariableIndex variable) {
  const auto place = std::find(data.variables.begin(), data.variables.end(), variable);
  if (place == data.variables.end()) return std::nullopt;
  const auto column = static_cast<std::size_t>(place - data.variables.begin());
  for (std::size_t row = 0; row < data.row_count; ++row)
    if (!data.cells[row * data.variables.size() + column]) return std::nullopt;
  return column;
}

class ClassSources {
 public:
  explicit ClassSources(const ast::Query& query) : query_(query) {}

  void takeVariable(ast::VariableIndex variable) {
    if (!taken_.insert(variable).second || takeListed(variable)) return;
    takeFrom(query_.select, variable);
  }
  GivenClasses given;

 private:
  /// Whether VALUES for the whole rule lists all that the variable can be.
  bool takeListed(ast::VariableIndex variable) {
    if (query_.select.values && wholeColumn(*query_.select.values, variable)) {
      takeData(*query_.select.values, variable);
      return true;
    }
    for (const ast::PatternElement& element : query_.select.where.elements)
      if (const auto* data = std::get_if<ast::InlineData>(&element.value); data && wholeColumn(*data, variable)) {
        takeData(*data, variable);
        return true;
      }
    return false;
  }

  void takeFrom(const ast::Select& select, ast::VariableIndex variable) {
    takeFrom(select.where, variable);
    if (select.values) takeData(*select.values, variable);
    for (const ast::Projection& column : select.projection)
      if (column.expression && column.variable == variable) take(*column.expression);
    for (const ast::GroupCondition& group : select.modifiers.group_by)
      if (group.as == variable) take(group.expression);
  }

  void takeFrom(const ast::GroupPattern& group, ast::VariableIndex variable) {
    for (const ast::PatternElement& element : group.elements) {
      if (const auto* block = std::get_if<ast::TriplesBlock>(&element.value))
        for (const ast::TriplePattern& triple : block->triples)
          given.is_open = given.is_open || is(triple.subject, variable) || is(triple.object, variable) ||
                          (!triple.isPath() && is(triple.predicate, variable));
      if (const auto* graph = std::get_if<ast::GraphPattern>(&element.value))
        given.is_open = given.is_open || is(graph->graph, variable);
      if (const auto* bind = std::get_if<ast::Bind>(&element.value); bind && bind->variable == variable)
        take(bind->expression);
      if (const auto* data = std::get_if<ast::InlineData>(&element.value)) takeData(*data, variable);
      if (const auto* inner = std::get_if<ast::SubSelect>(&element.value)) takeFrom(*inner->select, variable);
      mapping::forEachGroup(element, [&](const ast::GroupPattern& inner) { takeFrom(inner, variable); });
    }
  }

  void takeData(const ast::InlineData& data, ast::VariableIndex variable) {
    for (std::size_t cell = 0; cell < data.cells.size(); ++cell)
      if (data.variables[cell % data.variables.size()] == variable && data.cells[cell]) takeTerm(*data.cells[cell]);
  }

  void takeTerm(const Term& term) {
    if (term.kind == TermKind::Iri) given.named.insert(term.text);
  }

  void take(const ast::Expression& expression) {
    const std::vector<ast::Expression>& arguments = expression.arguments;
    if (expression.kind == ExpressionKind::Constant) return takeTerm(expression.term);
    if (expression.kind == ExpressionKind::Variable) return takeVariable(expression.variable);
    const bool is_choice = expression.kind == ExpressionKind::Call && expression.builtin == ast::Builtin::If;
    const bool is_first = expression.kind == ExpressionKind::Call && expression.builtin == ast::Builtin::Coalesce;
    if (!is_choice && !is_first) {
      given.is_open = true;
      return;
    }
    for (std::size_t i = is_choice ? 1 : 0; i < arguments.size(); ++i) take(arguments[i]);
  }

  const ast::Query& query_;
  std::set<ast::VariableIndex> taken_;
};

}  // namespace

GivenClasses classesGivenBy(const mapping::NamedText& rule) {
  const mapping::RuleShape shape = mapping::shapeOf(rule);
  const std::string type = rdf::vocabulary::rdf("type");
  ClassSources sources(shape.query);
  for (const ast::TriplePattern& made : shape.query.construct_template) {
    if (made.predicate.isVariable()) {
      sources.given.is_open = true;
    } else if (made.predicate.term().text == type) {
      if (made.object.isVariable())
        sources.takeVariable(made.object.variable());
      else
        sources.given.named.insert(made.object.term().text);
    }
  }
  return std::move(sources.given);
}

}  // namespace cluxel::tasks
