// SPDX-License-Identifier: Apache-2.0
// Searches the syntax tree.
#include "sparql/syntax/mentions.hpp"

#include <algorithm>

namespace cluxel::sparql {
namespace {

/// Searches all kinds of elements for a variable.
class Search {
 public:
  explicit Search(ast::VariableIndex variable) : variable_(variable) {}

  bool in(const ast::GroupPattern& group) const {
    return std::any_of(group.elements.begin(), group.elements.end(), [this](const ast::PatternElement& element) {
      return std::visit([this](const auto& part) { return inPart(part); }, element.value);
    });
  }

 private:
  bool is(const ast::PatternTerm& place) const { return place.isVariable() && place.variable() == variable_; }
  bool in(const ast::Expression& expression) const {
    if (expression.kind == ast::Expression::Kind::Variable && expression.variable == variable_) return true;
    if (expression.pattern && in(*expression.pattern)) return true;
    return std::any_of(expression.arguments.begin(), expression.arguments.end(),
                       [this](const ast::Expression& argument) { return in(argument); });
  }
  bool inPart(const ast::TriplesBlock& block) const {
    return std::any_of(block.triples.begin(), block.triples.end(), [this](const ast::TriplePattern& triple) {
      return is(triple.subject) || (!triple.isPath() && is(triple.predicate)) || is(triple.object);
    });
  }
  bool inPart(const ast::GroupPattern& group) const { return in(group); }
  bool inPart(const ast::OptionalPattern& optional) const { return in(optional.group); }
  bool inPart(const ast::MinusPattern& minus) const { return in(minus.group); }
  bool inPart(const ast::ServicePattern& service) const { return in(service.group); }
  bool inPart(const ast::GraphPattern& graph) const { return is(graph.graph) || in(graph.group); }
  bool inPart(const ast::Filter& filter) const { return in(filter.condition); }
  bool inPart(const ast::Bind& bind) const { return bind.variable == variable_ || in(bind.expression); }
  bool inPart(const ast::UnionPattern& both) const {
    return std::any_of(both.branches.begin(), both.branches.end(),
                       [this](const ast::GroupPattern& branch) { return in(branch); });
  }
  bool inPart(const ast::InlineData& data) const {
    return std::find(data.variables.begin(), data.variables.end(), variable_) != data.variables.end();
  }
  /// Checks the projection of a sub-select only; its other variables are local.
  bool inPart(const ast::SubSelect& sub) const {
    const auto& columns = sub.select->projection;
    return std::any_of(columns.begin(), columns.end(),
                       [this](const ast::Projection& column) { return column.variable == variable_; });
  }

  ast::VariableIndex variable_;
};

bool isOrHasSubSelect(const ast::PatternElement& element) {
  if (std::holds_alternative<ast::SubSelect>(element.value)) return true;
  if (const auto* group = std::get_if<ast::GroupPattern>(&element.value)) return hasSubSelect(*group);
  if (const auto* optional = std::get_if<ast::OptionalPattern>(&element.value)) return hasSubSelect(optional->group);
  if (const auto* minus = std::get_if<ast::MinusPattern>(&element.value)) return hasSubSelect(minus->group);
  if (const auto* both = std::get_if<ast::UnionPattern>(&element.value)) {
    return std::any_of(both->branches.begin(), both->branches.end(), hasSubSelect);
  }
  return false;
}

}  // namespace

bool mentions(const ast::GroupPattern& group, ast::VariableIndex variable) {
  return Search(variable).in(group);
}

bool hasSubSelect(const ast::GroupPattern& group) {
  return std::any_of(group.elements.begin(), group.elements.end(), isOrHasSubSelect);
}

}  // namespace cluxel::sparql
