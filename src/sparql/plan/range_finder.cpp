// SPDX-License-Identifier: Apache-2.0
// Solves comparisons for the slot of one side.
#include "sparql/plan/range_finder.hpp"

#include <algorithm>

#include "sparql/functions/function_bodies.hpp"

namespace cluxel::sparql {
namespace {

using Kind = Expr::Kind;

bool isCallTo(const Expr& expression, FunctionBody body) {
  return expression.kind == Kind::Call && expression.function != nullptr && expression.function->body == body;
}

bool hasPattern(const Expr& expression) {
  return expression.pattern || std::any_of(expression.arguments.begin(), expression.arguments.end(), hasPattern);
}

/// A sum, split into what the probe row gives and what the build side gives.
struct SplitSum {
  struct Unknown {
    const Expr* expression;
    bool is_negative;
  };
  RowSum given;
  std::vector<Unknown> unknown;
};

class TestFinder {
 public:
  TestFinder(const JoinSides& sides, const QueryTerms& terms) : sides_(sides), terms_(terms) {}
  std::vector<RangeTest> take() { return std::move(tests_); }

  void find(const Expr& condition, bool is_negated) {
    if (condition.kind == Kind::Not) return find(condition.arguments[0], !is_negated);
    if (condition.kind == Kind::And && !is_negated) {
      for (const Expr& argument : condition.arguments) find(argument, false);
      return;
    }
    const bool is_contact = isCallTo(condition, sfDisjointFunction) ? is_negated : !is_negated;
    if (const GeometryPair pair = contactArguments(condition); pair.first != nullptr && is_contact)
      return near(*pair.first, *pair.second, {});
    compare(condition, is_negated);
  }

 private:
  void compare(const Expr& condition, bool is_negated) {
    switch (condition.kind) {
      case Kind::Equal:
        if (!is_negated) equal(condition.arguments[0], condition.arguments[1]);
        return;
      case Kind::Less:
      case Kind::LessEqual:
        return is_negated ? atMost(condition.arguments[1], condition.arguments[0])
                          : atMost(condition.arguments[0], condition.arguments[1]);
      case Kind::Greater:
      case Kind::GreaterEqual:
        return is_negated ? atMost(condition.arguments[0], condition.arguments[1])
                          : atMost(condition.arguments[1], condition.arguments[0]);
      default:
        return;
    }
  }
  void equal(const Expr& left, const Expr& right) {
    atMost(left, right);
    atMost(right, left);
  }
  /// lower <= upper
  void atMost(const Expr& lower, const Expr& upper) {
    SplitSum sum;
    if (split(lower, false, sum) && split(upper, true, sum)) solve(sum);
  }

  /// Adds the expression to a sum that is at most zero; false when it is no sum.
  bool split(const Expr& expression, bool is_negative, SplitSum& sum) const {
    if (readsOnly(expression, sides_.probe)) {
      sum.given.parts.push_back({expression, is_negative, false});
      return true;
    }
    const auto& arguments = expression.arguments;
    switch (expression.kind) {
      case Kind::Add:
        return split(arguments[0], is_negative, sum) && split(arguments[1], is_negative, sum);
      case Kind::Subtract:
        return split(arguments[0], is_negative, sum) && split(arguments[1], !is_negative, sum);
      case Kind::Negate:
        return split(arguments[0], !is_negative, sum);
      case Kind::Plus:
        return split(arguments[0], is_negative, sum);
      case Kind::Slot:
      case Kind::Call:
      case Kind::Multiply:
        sum.unknown.push_back({&expression, is_negative});
        return true;
      default:
        return false;
    }
  }

  static RowSum negated(RowSum sum) {
    for (RowSum::Part& part : sum.parts) part.is_negative = !part.is_negative;
    return sum;
  }

  /// Finds tests in: unknown + given <= 0.
  void solve(const SplitSum& sum) {
    if (sum.unknown.empty()) return;
    const bool is_one = sum.unknown.size() == 1;
    const Expr& first = *sum.unknown[0].expression;
    const bool is_negative = sum.unknown[0].is_negative;
    if (is_one && first.kind == Kind::Slot && sides_.build.has(first.slot)) {
      if (is_negative)
        tests_.push_back({RangeTest::Kind::AtLeast, first.slot, sum.given, std::nullopt});
      else
        tests_.push_back({RangeTest::Kind::AtMost, first.slot, negated(sum.given), std::nullopt});
      return;
    }
    if (is_one && !is_negative && isCallTo(first, absFunction)) return solveMagnitude(first.arguments[0], sum.given);
    if (const GeometryPair pair = distanceArguments(first, terms_); is_one && !is_negative && pair.first != nullptr)
      return near(*pair.first, *pair.second, negated(sum.given));
    solveSquares(sum);
  }

  /// |expression| + given <= 0
  void solveMagnitude(const Expr& expression, const RowSum& given) {
    for (const bool is_negative : {false, true}) {
      SplitSum sum;
      sum.given = given;
      if (split(expression, is_negative, sum)) solve(sum);
    }
  }

  /// a * a + b * b <= limit: neither |a| nor |b| exceeds the root of the limit.
  void solveSquares(const SplitSum& sum) {
    const auto is_square = [](const SplitSum::Unknown& unknown) {
      const Expr& product = *unknown.expression;
      return !unknown.is_negative && product.kind == Kind::Multiply &&
             isSame(product.arguments[0], product.arguments[1]);
    };
    if (!std::all_of(sum.unknown.begin(), sum.unknown.end(), is_square)) return;
    if (sum.given.parts.size() != 1 || !sum.given.parts[0].is_negative) return;
    RowSum root = sum.given;
    root.parts[0].is_root = true;
    for (const SplitSum::Unknown& unknown : sum.unknown) solveMagnitude(unknown.expression->arguments[0], root);
  }

  void near(const Expr& a, const Expr& b, RowSum bound) {
    for (const auto& [slot, place] : {std::pair(&a, &b), std::pair(&b, &a)}) {
      if (slot->kind != Kind::Slot || !sides_.build.has(slot->slot) || !readsOnly(*place, sides_.probe)) continue;
      tests_.push_back({RangeTest::Kind::Near, slot->slot, std::move(bound), *place});
      return;
    }
  }

  const JoinSides& sides_;
  const QueryTerms& terms_;
  std::vector<RangeTest> tests_;
};

}  // namespace

std::vector<RangeTest> rangeTestsOf(const Expr& condition, const JoinSides& sides, const QueryTerms& terms) {
  TestFinder finder(sides, terms);
  finder.find(condition, false);
  return finder.take();
}

GeometryPair distanceArguments(const Expr& expression, const QueryTerms& terms) {
  if (!isCallTo(expression, geoDistanceFunction)) return {};
  const auto& arguments = expression.arguments;
  // Only metres are comparable with coordinates.
  const bool in_metres = arguments.size() == 2 || (arguments[2].kind == Kind::Constant &&
                                                   terms.textOf(arguments[2].constant).ends_with("metre"));
  if (!in_metres) return {};
  return {&arguments[0], &arguments[1]};
}

GeometryPair contactArguments(const Expr& expression) {
  for (const FunctionBody body :
       {sfIntersectsFunction, sfWithinFunction, sfContainsFunction, sfTouchesFunction, sfDisjointFunction}) {
    if (isCallTo(expression, body)) return {&expression.arguments[0], &expression.arguments[1]};
  }
  return {};
}

Expr expanded(const Expr& condition, const BoundExpressions& binds) {
  if (condition.kind == Kind::Slot) {
    const auto bind = binds.find(condition.slot);
    return bind == binds.end() ? condition : expanded(*bind->second, binds);
  }
  Expr result = condition;
  for (Expr& argument : result.arguments) argument = expanded(argument, binds);
  return result;
}

bool isSame(const Expr& a, const Expr& b) {
  if (a.kind != b.kind || a.slot != b.slot || a.function != b.function || a.pattern || b.pattern) return false;
  if (a.kind == Kind::Constant && (a.constant.id == kUnbound || a.constant.id != b.constant.id)) return false;
  return std::equal(a.arguments.begin(), a.arguments.end(), b.arguments.begin(), b.arguments.end(), isSame);
}

bool readsOnly(const Expr& expression, const SlotSet& slots) {
  return !hasPattern(expression) && !expression.isVolatile() && slots.contains(expression.slots());
}

}  // namespace cluxel::sparql
