// SPDX-License-Identifier: Apache-2.0
// Evaluates expressions on solutions: three-valued logic, comparison, arithmetic, function calls.
#include <array>

#include "sparql/exec/runtime.hpp"
#include "sparql/functions/functions.hpp"
#include "sparql/values/comparison.hpp"

namespace cluxel::sparql {
namespace {

using Kind = Expr::Kind;

Value ofTruth(std::optional<bool> truth) {
  return truth ? Value::boolean(*truth) : Value();
}

std::optional<bool> decide(Kind kind, std::optional<std::partial_ordering> order) {
  if (!order) return std::nullopt;
  switch (kind) {
    case Kind::Less:
      return *order < 0;
    case Kind::Greater:
      return *order > 0;
    case Kind::LessEqual:
      return *order <= 0;
    default:
      return *order >= 0;
  }
}

}  // namespace

std::optional<bool> Evaluator::truth(const Expr& expression, const Batch& batch, std::size_t row) {
  switch (expression.kind) {
    case Kind::Not: {
      const auto inner = truth(expression.arguments[0], batch, row);
      if (!inner) return std::nullopt;
      return !*inner;
    }
    case Kind::And:
    case Kind::Or: {
      // The deciding value (false for AND, true for OR) takes precedence over an error.
      const bool decisive = expression.kind == Kind::Or;
      bool error = false;
      for (const Expr& argument : expression.arguments) {
        const auto inner = truth(argument, batch, row);
        if (inner && *inner == decisive) return decisive;
        error = error || !inner;
      }
      if (error) return std::nullopt;
      return !decisive;
    }
    case Kind::Bound:
      return batch.at(expression.slot, row) != kUnbound;
    case Kind::Exists:
      return runtime_.exists_results[expression.exists][row] != 0;
    case Kind::NotExists:
      return runtime_.exists_results[expression.exists][row] == 0;
    default:
      return effectiveBoolean(value(expression, batch, row), runtime_.terms);
  }
}

Value Evaluator::value(const Expr& expression, const Batch& batch, std::size_t row) {
  switch (expression.kind) {
    case Kind::Slot:
      return runtime_.terms.valueOf(batch.at(expression.slot, row));
    case Kind::Constant:
      return expression.constant;
    case Kind::Unbound:
      return {};
    case Kind::Or:
    case Kind::And:
    case Kind::Not:
    case Kind::Bound:
    case Kind::Exists:
    case Kind::NotExists:
      return ofTruth(truth(expression, batch, row));
    case Kind::Equal:
    case Kind::NotEqual:
    case Kind::Less:
    case Kind::Greater:
    case Kind::LessEqual:
    case Kind::GreaterEqual:
      return compared(expression, batch, row);
    case Kind::In:
    case Kind::NotIn:
      return membership(expression, batch, row);
    case Kind::Add:
    case Kind::Subtract:
    case Kind::Multiply:
    case Kind::Divide:
    case Kind::Negate:
    case Kind::Plus:
      return arithmetic(expression, batch, row);
    case Kind::Coalesce:
      for (const Expr& argument : expression.arguments) {
        if (Value found = value(argument, batch, row)) return found;
      }
      return {};
    case Kind::If: {
      const auto condition = truth(expression.arguments[0], batch, row);
      if (!condition) return {};
      return value(expression.arguments[*condition ? 1 : 2], batch, row);
    }
    case Kind::Call:
      return called(expression, batch, row);
  }
  return {};
}

Value Evaluator::compared(const Expr& expression, const Batch& batch, std::size_t row) {
  const Value a = value(expression.arguments[0], batch, row);
  if (!a) return {};
  const Value b = value(expression.arguments[1], batch, row);
  if (!b) return {};
  if (expression.kind == Kind::Equal) return ofTruth(equals(a, b, runtime_.terms));
  if (expression.kind == Kind::NotEqual) {
    const auto same = equals(a, b, runtime_.terms);
    return same ? Value::boolean(!*same) : Value();
  }
  return ofTruth(decide(expression.kind, compare(a, b, runtime_.terms)));
}

Value Evaluator::membership(const Expr& expression, const Batch& batch, std::size_t row) {
  const bool negated = expression.kind == Kind::NotIn;
  const Value item = value(expression.arguments[0], batch, row);
  bool error = false;
  for (std::size_t i = 1; i < expression.arguments.size(); ++i) {
    const auto same = equals(item, value(expression.arguments[i], batch, row), runtime_.terms);
    if (same && *same) return Value::boolean(!negated);
    error = error || !same;
  }
  if (error) return {};
  return Value::boolean(negated);
}

Value Evaluator::arithmetic(const Expr& expression, const Batch& batch, std::size_t row) {
  const Value a = value(expression.arguments[0], batch, row);
  if (!a) return {};
  if (expression.kind == Kind::Negate) return negateValue(a, runtime_.terms);
  if (expression.kind == Kind::Plus) {
    if (a.type == Value::Type::Integer) return Value::ofInteger(runtime_.terms.exactOf(a));  // drops a derived type
    return a.isNumeric() ? a : Value();
  }
  const Value b = value(expression.arguments[1], batch, row);
  if (!b) return {};
  switch (expression.kind) {
    case Kind::Add:
      return addValues(a, b, runtime_.terms);
    case Kind::Subtract:
      return subtractValues(a, b, runtime_.terms);
    case Kind::Multiply:
      return multiplyValues(a, b, runtime_.terms);
    default:
      return divideValues(a, b, runtime_.terms);
  }
}

Value Evaluator::called(const Expr& expression, const Batch& batch, std::size_t row) {
  std::array<Value, 4> few;
  std::vector<Value> many;
  const std::size_t count = expression.arguments.size();
  if (count > few.size()) many.resize(count);
  Value* arguments = count > few.size() ? many.data() : few.data();
  for (std::size_t i = 0; i < count; ++i) {
    arguments[i] = value(expression.arguments[i], batch, row);
    if (!arguments[i]) return {};
  }
  Value result = expression.function->body({arguments, count}, runtime_.functions);
  if (result.isStringLike() && result.payload) countText(std::get<TextPayload>(*result.payload).text.size());
  return result;
}

/// A text is held several times while it becomes a term, and batches are charged only when they are complete.
void Evaluator::countText(std::size_t bytes) {
  constexpr std::size_t kLong = 4096, kCopies = 3;
  requireTextSize(bytes);
  if (bytes < kLong) return;
  runtime_.chargeForTerms();
  runtime_.guard.requireRoomFor(kCopies * bytes);
  runtime_.guard.spend(bytes);
}

}  // namespace cluxel::sparql
