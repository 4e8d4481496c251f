// SPDX-License-Identifier: Apache-2.0
// Finds range tests in FILTER conditions: bounds on numbers, distances and spatial relations between two sides.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "sparql/exec/spatial/range_test.hpp"

namespace cluxel::sparql {

/// The slots that are bound in every row of the two sides of a join.
struct JoinSides {
  SlotSet probe, build;
};

/// Tests on slots of the build side that every row that passes the condition passes too. Comparisons may contain sums,
/// differences, ABS and sums of squares.
std::vector<RangeTest> rangeTestsOf(const Expr& condition, const JoinSides& sides, const QueryTerms& terms);

/// The two geometries of a call of geof:distance in metres, or of a relation that implies a distance of zero; null for
/// other expressions.
struct GeometryPair {
  const Expr* first = nullptr;
  const Expr* second = nullptr;
};
GeometryPair distanceArguments(const Expr& expression, const QueryTerms& terms);
GeometryPair contactArguments(const Expr& expression);

/// The expressions of BIND, by slot.
using BoundExpressions = std::map<Slot, const Expr*>;
/// The condition with these slots replaced by their expressions.
Expr expanded(const Expr& condition, const BoundExpressions& binds);

/// True for the same computation; not for expressions with patterns.
bool isSame(const Expr& a, const Expr& b);
/// True when the expression reads only these slots, and no clock, random number or pattern.
bool readsOnly(const Expr& expression, const SlotSet& slots);

}  // namespace cluxel::sparql
