// SPDX-License-Identifier: Apache-2.0
// ABS, CEIL, FLOOR, ROUND, RAND.
#include <cmath>

#include "sparql/functions/function_bodies.hpp"

namespace cluxel::sparql {
namespace {

using Type = Value::Type;

/// fn:round: rounds half towards plus infinity and preserves the sign of zero.
double roundHalfUp(double value) {
  const double down = std::floor(value);
  const double result = value - down >= 0.5 ? down + 1 : down;
  return result == 0 ? std::copysign(0.0, value) : result;
}

/// Applies a rounding function to any numeric type.
template <typename Real, typename Exact>
Value rounded(const Value& value, FunctionContext& context, Real real, Exact exact) {
  switch (value.type) {
    case Type::Integer:
      return Value::ofInteger(context.terms.exactOf(value));  // drops a derived type
    case Type::Decimal:
      return Value::ofDecimal(exact(context.terms.exactOf(value)));
    case Type::Float:
      return Value::ofFloat(static_cast<float>(real(value.number)));
    case Type::Double:
      return Value::ofDouble(real(value.number));
    default:
      return {};
  }
}

}  // namespace

Value absFunction(Arguments arguments, FunctionContext& context) {
  const Value& value = arguments[0];
  if (!value.isNumeric()) return {};
  if (value.type == Type::Float) return Value::ofFloat(std::abs(static_cast<float>(value.number)));
  if (value.type == Type::Double) return Value::ofDouble(std::abs(value.number));
  const Decimal exact = context.terms.exactOf(value), size = exact.isNegative() ? -exact : exact;
  return value.type == Type::Integer ? Value::ofInteger(size) : Value::ofDecimal(size);
}

Value ceilFunction(Arguments arguments, FunctionContext& context) {
  return rounded(
      arguments[0], context, [](double x) { return std::ceil(x); }, [](const Decimal& x) { return x.ceiling(); });
}

Value floorFunction(Arguments arguments, FunctionContext& context) {
  return rounded(
      arguments[0], context, [](double x) { return std::floor(x); }, [](const Decimal& x) { return x.floor(); });
}

Value roundFunction(Arguments arguments, FunctionContext& context) {
  return rounded(arguments[0], context, roundHalfUp, [](const Decimal& x) { return x.round(); });
}

Value randFunction(Arguments, FunctionContext& context) {
  return Value::ofDouble(static_cast<double>(context.random() >> 11) * 0x1.0p-53);
}

}  // namespace cluxel::sparql
