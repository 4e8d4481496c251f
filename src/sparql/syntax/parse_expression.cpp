// SPDX-License-Identifier: Apache-2.0
// Parses expressions: operator precedence, calls of built-ins, functions and aggregates.
#include <algorithm>
#include <array>

#include "sparql/syntax/sparql_parser.hpp"

namespace cluxel::sparql {

using ast::Expression;
using ExpressionKind = ast::Expression::Kind;

namespace {

enum Rank : int { kNoOperator = 0, kOrRank, kAndRank, kCompareRank, kAddRank, kMultiplyRank };

struct Operator {
  int rank = kNoOperator;
  ExpressionKind kind = ExpressionKind::Or;
};

/// The binary operator that a token denotes after an operand.
Operator operatorOf(const Token& token) {
  switch (token.kind) {
    case TokenKind::OrOr:
      return {kOrRank, ExpressionKind::Or};
    case TokenKind::AndAnd:
      return {kAndRank, ExpressionKind::And};
    case TokenKind::Equal:
      return {kCompareRank, ExpressionKind::Equal};
    case TokenKind::NotEqual:
      return {kCompareRank, ExpressionKind::NotEqual};
    case TokenKind::Less:
      return {kCompareRank, ExpressionKind::Less};
    case TokenKind::Greater:
      return {kCompareRank, ExpressionKind::Greater};
    case TokenKind::LessEqual:
      return {kCompareRank, ExpressionKind::LessEqual};
    case TokenKind::GreaterEqual:
      return {kCompareRank, ExpressionKind::GreaterEqual};
    case TokenKind::Plus:
      return {kAddRank, ExpressionKind::Add};
    case TokenKind::Minus:
      return {kAddRank, ExpressionKind::Subtract};
    case TokenKind::Star:
      return {kMultiplyRank, ExpressionKind::Multiply};
    case TokenKind::Slash:
      return {kMultiplyRank, ExpressionKind::Divide};
    case TokenKind::Word:
      if (token.keyword == Keyword::In) return {kCompareRank, ExpressionKind::In};
      if (token.keyword == Keyword::Not) return {kCompareRank, ExpressionKind::NotIn};
      return {};
    default:
      return {};
  }
}

struct Arity {
  std::uint8_t min = 1, max = 1;
};
constexpr std::uint8_t kAnyNumber = 255;

/// The permitted number of arguments of a built-in.
Arity arityOf(ast::Builtin builtin) {
  using B = ast::Builtin;
  switch (builtin) {
    case B::Rand:
    case B::Now:
    case B::Uuid:
    case B::StrUuid:
      return {0, 0};
    case B::Bnode:
      return {0, 1};
    case B::Concat:
    case B::Coalesce:
      return {0, kAnyNumber};
    case B::LangMatches:
    case B::Contains:
    case B::StrStarts:
    case B::StrEnds:
    case B::StrBefore:
    case B::StrAfter:
    case B::StrLang:
    case B::StrDt:
    case B::SameTerm:
      return {2, 2};
    case B::Regex:
    case B::Substr:
      return {2, 3};
    case B::If:
      return {3, 3};
    case B::Replace:
      return {3, 4};
    default:
      return {1, 1};
  }
}

std::string arityText(Arity arity) {
  const auto counted = [](int n) {
    return n == 0 ? "no argument" : std::to_string(n) + (n == 1 ? " argument" : " arguments");
  };
  if (arity.min == arity.max) return counted(arity.min);
  return std::to_string(arity.min) + " or " + counted(arity.max);
}

}  // namespace

Expression SparqlParser::expression() {
  const Nested nested(*this);
  return binary(kOrRank);
}

/// Adds an argument and checks the height of the tree.
void SparqlParser::addArgument(Expression& parent, Expression argument) const {
  parent.height = std::max(parent.height, argument.height + 1);
  if (parent.height > options_.max_depth)
    fail(parent.at, "the expression is nested deeper than " + std::to_string(options_.max_depth) + " operators",
         "write it in parts with BIND");
  parent.arguments.push_back(std::move(argument));
}

/// Flattens runs of || and of && into one node.
Expression SparqlParser::joined(ExpressionKind kind, Expression left, Expression right) {
  Expression parent;
  parent.kind = kind;
  parent.at = left.at;
  parent.arguments.reserve(2);
  addArgument(parent, std::move(left));
  addArgument(parent, std::move(right));
  return parent;
}

Expression SparqlParser::binary(int min_rank) {
  Expression left = unary();
  int max_rank = kMultiplyRank;  // comparisons are not associative
  int run_rank = kNoOperator;    // rank of the || or && node in `left`
  for (;;) {
    const Operator found = operatorOf(token_);
    if (found.rank < min_rank || found.rank > max_rank || found.rank == kNoOperator) return left;
    const ast::SourceOffset at = here();
    advance();
    max_rank = found.rank == kCompareRank ? kAndRank : found.rank;
    if (found.kind == ExpressionKind::In || found.kind == ExpressionKind::NotIn) {
      left = membership(std::move(left), found.kind == ExpressionKind::NotIn, at);
      continue;
    }
    Expression right = binary(found.rank + 1);
    if (run_rank == found.rank && found.rank <= kAndRank) {
      addArgument(left, std::move(right));
    } else {
      left = joined(found.kind, std::move(left), std::move(right));
    }
    run_rank = found.rank;
  }
}

Expression SparqlParser::membership(Expression value, bool negated, ast::SourceOffset at) {
  if (negated) expect(Keyword::In);
  Expression test;
  test.kind = negated ? ExpressionKind::NotIn : ExpressionKind::In;
  test.at = at;
  addArgument(test, std::move(value));
  expressionList(test);
  return test;
}

Expression SparqlParser::unary() {
  const ast::SourceOffset at = here();
  const bool sign = is(Kind::Plus) || is(Kind::Minus);
  if ((!sign || token_.number_follows) && !is(Kind::Bang)) return primary();
  Expression result;
  result.kind = is(Kind::Bang) ? ExpressionKind::Not : is(Kind::Minus) ? ExpressionKind::Negate : ExpressionKind::Plus;
  result.at = at;
  advance();
  addArgument(result, primary());
  return result;
}

Expression SparqlParser::primary() {
  if (is(Kind::LeftParen)) return bracketted();
  if (isCallStart()) return call();
  if (isIri()) return iriOrFunction();
  Expression leaf;
  leaf.at = here();
  if (is(Kind::Var)) {
    leaf.kind = ExpressionKind::Variable;
    leaf.variable = variable();
    return leaf;
  }
  if (is(Kind::String) || is(Kind::LongString))
    leaf.term = literal();
  else if (isNumberStart())
    leaf.term = number();
  else if (is(Keyword::True) || is(Keyword::False))
    leaf.term = boolean();
  else
    unexpected("an expression", {Keyword::FirstBuiltin, Keyword::Exists, Keyword::Not, Keyword::True, Keyword::False});
  return leaf;
}

Expression SparqlParser::bracketted() {
  expect(Kind::LeftParen, {});
  Expression inner = expression();
  expect(Kind::RightParen, "')' or an operator");
  return inner;
}

bool SparqlParser::isCallStart() const {
  return token_.kind == Kind::Word &&
         (token_.keyword >= Keyword::FirstBuiltin || is(Keyword::Exists) || is(Keyword::Not));
}

bool SparqlParser::isConstraintStart() const {
  return is(Kind::LeftParen) || isCallStart() || isIri();
}

Expression SparqlParser::constraint(std::string_view expected) {
  if (is(Kind::LeftParen)) return bracketted();
  if (isCallStart()) return call();
  if (!isIri()) unexpected(expected, {Keyword::FirstBuiltin, Keyword::Exists, Keyword::Not});
  Expression function = iriOrFunction();
  if (function.kind != ExpressionKind::Function) unexpected("'(' and the function's arguments");
  return function;
}

Expression SparqlParser::call() {
  const Nested nested(*this);
  if (const auto aggregate = aggregateOf(token_.keyword)) return aggregateCall(*aggregate);
  if (const auto builtin = builtinOf(token_.keyword)) return builtinCall(*builtin);
  return existsCall();
}

Expression SparqlParser::builtinCall(ast::Builtin builtin) {
  Expression result;
  result.kind = ExpressionKind::Call;
  result.builtin = builtin;
  result.at = here();
  advance();
  const ast::SourceOffset arguments_at = here();
  if (builtin == ast::Builtin::Bound && !(is(Kind::LeftParen) && peek().kind == Kind::Var))
    unexpected("'(' and a variable after BOUND");
  if (!is(Kind::LeftParen) && !is(Kind::Nil)) unexpected("'(' after " + std::string(ast::nameOf(builtin)));
  expressionList(result);
  const Arity arity = arityOf(builtin);
  const std::size_t count = result.arguments.size();
  if (count < arity.min || (count > arity.max && arity.max != kAnyNumber))
    fail(arguments_at,
         std::string(ast::nameOf(builtin)) + " takes " + arityText(arity) + ", not " + std::to_string(count));
  if (builtin == ast::Builtin::Bound && result.arguments[0].kind != ExpressionKind::Variable)
    fail(arguments_at, "BOUND takes a variable, not an expression");
  return result;
}

void SparqlParser::requireAggregateAllowed(ast::SourceOffset at) const {
  if (aggregate_use_ == AggregateUse::Inside)
    fail(at, "an aggregate cannot stand inside an aggregate", "compute the inner one in a sub-select");
  if (aggregate_use_ == AggregateUse::Refused)
    fail(at, "an aggregate can stand only in SELECT, HAVING and ORDER BY", "compute it in a sub-select");
}

Expression SparqlParser::aggregateCall(ast::AggregateFunction function) {
  Expression aggregate;
  aggregate.kind = ExpressionKind::Aggregate;
  aggregate.aggregate = function;
  aggregate.at = here();
  requireAggregateAllowed(aggregate.at);
  advance();
  if (!take(Kind::LeftParen)) unexpected("'(' after " + std::string(ast::nameOf(function)));
  aggregate_use_ = AggregateUse::Inside;
  aggregateArguments(aggregate);
  aggregate_use_ = AggregateUse::Allowed;
  saw_aggregate_ = true;
  expect(Kind::RightParen, "')' or an operator");
  return aggregate;
}

void SparqlParser::aggregateArguments(Expression& aggregate) {
  aggregate.distinct = take(Keyword::Distinct);
  if (aggregate.aggregate == ast::AggregateFunction::Count && take(Kind::Star)) return;
  addArgument(aggregate, expression());
  if (aggregate.aggregate != ast::AggregateFunction::GroupConcat) return;
  aggregate.separator = " ";
  if (take(Kind::Semicolon)) separator(aggregate);
}

void SparqlParser::separator(Expression& aggregate) {
  expect(Keyword::Separator);
  expect(Kind::Equal, "'='");
  aggregate.separator = stringValue();
}

Expression SparqlParser::existsCall() {
  Expression test;
  test.at = here();
  test.kind = take(Keyword::Not) ? ExpressionKind::NotExists : ExpressionKind::Exists;
  expect(Keyword::Exists);
  const AggregateUse use = aggregate_use_;
  const bool saw_aggregate = saw_aggregate_;
  aggregate_use_ = AggregateUse::Refused;
  VariableSet visible;
  test.pattern = std::make_shared<const ast::GroupPattern>(group(visible));
  aggregate_use_ = use;
  saw_aggregate_ = saw_aggregate;
  return test;
}

Expression SparqlParser::iriOrFunction() {
  Expression result;
  result.at = here();
  result.term = iri();
  if (!is(Kind::LeftParen) && !is(Kind::Nil)) return result;
  const Nested nested(*this);
  result.kind = ExpressionKind::Function;
  if (is(Kind::LeftParen) && peek().keyword == Keyword::Distinct) requireAggregateAllowed(result.at);
  expressionList(result);
  return result;
}

/// ( ) or ( [DISTINCT] a, b, … ); DISTINCT is for aggregates named by an IRI.
void SparqlParser::expressionList(Expression& parent) {
  if (take(Kind::Nil)) return;
  expect(Kind::LeftParen, "'(' and a list of expressions");
  if (parent.kind == ExpressionKind::Function) parent.distinct = take(Keyword::Distinct);
  do addArgument(parent, expression());
  while (take(Kind::Comma));
  expect(Kind::RightParen, "',', ')' or an operator");
}

bool ast::hasAggregate(const Expression& expression) {
  if (expression.kind == ExpressionKind::Aggregate) return true;
  return std::any_of(expression.arguments.begin(), expression.arguments.end(), hasAggregate);
}

}  // namespace cluxel::sparql
