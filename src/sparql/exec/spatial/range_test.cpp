// SPDX-License-Identifier: Apache-2.0
// Evaluates the bounds of range tests.
#include "sparql/exec/spatial/range_test.hpp"

#include <algorithm>
#include <cmath>

namespace cluxel::sparql {

KnownNumber evaluated(const RowSum& sum, const Batch& batch, std::size_t row, Evaluator& evaluator) {
  KnownNumber result{Known::Value};
  double rounding = kRounding;
  for (const RowSum::Part& part : sum.parts) {
    const Value value = evaluator.value(part.expression, batch, row);
    if (value.isError()) return {Known::Error};
    if (!value.isNumeric() || std::isnan(value.number)) return {Known::Nothing};
    if (value.type == Value::Type::Float) rounding = kFloatRounding;
    const double number = part.is_root ? std::sqrt(std::max(0.0, value.number)) : value.number;
    result.number += part.is_negative ? -number : number;
    result.size += std::abs(number);
  }
  result.error = result.size * rounding;
  if (std::isnan(result.number) || std::isnan(result.error)) return {Known::Nothing};
  return result;
}

KnownBox boxOf(const Value& value, FunctionContext& functions) {
  const auto geometry = geometryOf(value, functions);
  if (!geometry) return {Known::Error, {}};
  const auto found = functions.geometries->searchBox(*geometry);
  if (!found) return {Known::Nothing, {}};
  const Box2& box = found->box;
  // Distances of larger coordinates overflow.
  constexpr double kFarthest = 1e150;
  const bool has_box = std::max(-box.min_x, box.max_x) < kFarthest && std::max(-box.min_y, box.max_y) < kFarthest &&
                       box.min_x <= box.max_x;
  return {has_box ? Known::Value : Known::Nothing, box, found->system};
}

KnownBox mapBoxOf(const Value& value, FunctionContext& functions) {
  KnownBox found = boxOf(value, functions);
  if (found.known == Known::Value && found.system != SearchBox::kMapFrame) found.known = Known::Nothing;
  return found;
}

double farthestOf(const Box2& box, double by_m) {
  const double size = std::max({std::abs(box.min_x), std::abs(box.min_y), std::abs(box.max_x), std::abs(box.max_y)});
  return std::max(by_m, 0.0) * (1 + 1e-9) + 1e-6 + size * 1e-9;
}

Box2 widened(const Box2& box, double by_m) {
  const double margin = farthestOf(box, by_m);
  return {box.min_x - margin, box.min_y - margin, box.max_x + margin, box.max_y + margin};
}

std::string describe(const RangeTest& test, const AlgebraQuery& query, const QueryTerms& terms) {
  std::string bound;
  for (const RowSum::Part& part : test.bound.parts) {
    const std::string text = describe(part.expression, query, terms);
    bound += (part.is_negative ? " - " : bound.empty() ? "" : " + ") + (part.is_root ? "√" + text : text);
  }
  if (bound.empty()) bound = "0";
  const std::string slot = "?" + query.slot_names[test.slot];
  if (test.kind == RangeTest::Kind::Near)
    return slot + " within " + bound + " m of " + describe(*test.place, query, terms);
  return slot + (test.kind == RangeTest::Kind::AtMost ? " <= " : " >= ") + bound;
}

}  // namespace cluxel::sparql
