// SPDX-License-Identifier: Apache-2.0
// Conditions of a FILTER that limit a number or a geometry of one side of a join by values of the other side. They
// only exclude rows that the FILTER would reject; the FILTER itself is evaluated on the rest.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sparql/algebra/algebra.hpp"
#include "sparql/exec/runtime.hpp"
#include "sparql/geometry/geometry.hpp"

namespace cluxel::sparql {

/// The sum of expressions over the slots of one row.
struct RowSum {
  struct Part {
    Expr expression;
    bool is_negative = false;
    bool is_root = false;  ///< the square root of the expression
  };
  std::vector<Part> parts;
};

/// A condition on the slot of the other side.
struct RangeTest {
  enum class Kind {
    AtMost,   ///< the number in `slot` is at most `bound`
    AtLeast,  ///< the number in `slot` is at least `bound`
    Near      ///< the geometry in `slot` is at most `bound` metres from `place`
  };
  Kind kind = Kind::AtMost;
  Slot slot = kNoSlot;
  RowSum bound;
  std::optional<Expr> place;
};

/// What is known about a value before the FILTER is evaluated.
enum class Known {
  Value,    ///< a number, or a geometry with a box
  Nothing,  ///< another value: any comparison is possible
  Error     ///< the FILTER fails
};

struct KnownNumber {
  Known known = Known::Nothing;
  double number = 0;
  double size = 0;   ///< the sum of the magnitudes of the parts
  double error = 0;  ///< the true value differs by less
};
/// The numeric value of a sum for one row.
KnownNumber evaluated(const RowSum& sum, const Batch& batch, std::size_t row, Evaluator& evaluator);

struct KnownBox {
  Known known = Known::Nothing;
  Box2 box;
  std::uint32_t system = SearchBox::kMapFrame;  ///< boxes of different systems say nothing about each other
};
/// The box of a geometry. Nothing for geometries that are empty or have no SearchBox. Error for values that are not
/// geometries.
KnownBox boxOf(const Value& value, FunctionContext& functions);
/// For the stored index, which holds boxes of the map frame: Nothing for geometries of other systems.
KnownBox mapBoxOf(const Value& value, FunctionContext& functions);

/// The box of all that is at most `by_m` metres away; grows by more than the rounding of the functions.
Box2 widened(const Box2& box, double by_m);
/// `by_m` with a margin for rounding: boxes beyond it are farther than `by_m` from `box`.
double farthestOf(const Box2& box, double by_m);

/// The relative rounding of xsd:float arithmetic, and of all other arithmetic, with a margin.
inline constexpr double kFloatRounding = 1e-6, kRounding = 1e-12;

/// The test in query plans.
std::string describe(const RangeTest& test, const AlgebraQuery& query, const QueryTerms& terms);

}  // namespace cluxel::sparql
