// SPDX-License-Identifier: Apache-2.0
// Places the rows of a build side in a box tree.
#include "sparql/exec/spatial/range_build.hpp"

#include <algorithm>
#include <cmath>

namespace cluxel::sparql {

RangeBuild::RangeBuild(OperatorPtr source, const std::vector<RangeTest>& tests, bool strict)
    : source_(std::move(source)), table_(source_->slots()), strict_(strict) {
  std::size_t axes = 0;
  const auto& slots = table_.slots();
  for (const RangeTest& test : tests) {
    const bool is_geometry = test.kind == RangeTest::Kind::Near;
    const std::size_t more = is_geometry ? 2 : 1;
    if (axisOf(test.slot, is_geometry) < axes || axes + more > BoxTree::kMaxDimensions) continue;
    const auto column = static_cast<std::size_t>(std::find(slots.begin(), slots.end(), test.slot) - slots.begin());
    // The nearest rows are found by the first two axes.
    keys_.push_back({test.slot, is_geometry, axes, column});
    axes += more;
    tree_ = BoxTree(axes);
  }
}

std::size_t RangeBuild::axisOf(Slot slot, bool is_geometry) const {
  for (const Key& key : keys_) {
    if (key.slot == slot && key.is_geometry == is_geometry) return key.axis;
  }
  return BoxTree::kMaxDimensions;
}

void RangeBuild::reopen(Runtime& runtime, bool fresh) {
  if (!fresh && is_made_) return;
  table_.clear(runtime.guard);
  runtime.guard.release(charged_);
  charged_ = 0;
  tree_.clear();
  loose_.clear();
  is_made_ = has_floats_ = false;
  source_->open(runtime, fresh);
}

void RangeBuild::make(Runtime& runtime) {
  if (is_made_) return;
  is_made_ = true;
  constexpr std::uint32_t kRowsOfCheck = 4096;
  Batch batch(runtime.slot_count);
  while (source_->next(batch)) table_.append(batch, runtime.guard);
  for (std::uint32_t row = 0; row < table_.rows(); ++row) {
    BoxTree::Box box;
    const Known known = place(table_.row(row), runtime, box);
    if (known == Known::Value) tree_.add(box, row);
    if (known == Known::Nothing || (known == Known::Error && !strict_)) loose_.push_back(row);
    runtime.guard.work(1);
    if (row % kRowsOfCheck == 0) runtime.guard.requireRoomFor(2 * tree_.bytes());
  }
  tree_.pack(runtime.guard);
  charged_ = tree_.bytes() + loose_.capacity() * sizeof(std::uint32_t);
  runtime.guard.charge(charged_);
}

Known RangeBuild::place(const ValueId* row, Runtime& runtime, BoxTree::Box& box) {
  Known known = Known::Value;
  for (const Key& key : keys_) {
    const Value value = runtime.terms.valueOf(row[key.column]);
    if (key.is_geometry) {
      const KnownBox found = boxOf(value, runtime.functions);
      if (found.known == Known::Error) return Known::Error;
      if (found.known == Known::Nothing) known = Known::Nothing;
      box[key.axis] = {found.box.min_x, found.box.max_x};
      box[key.axis + 1] = {found.box.min_y, found.box.max_y};
    } else if (value.isNumeric() && !std::isnan(value.number)) {
      has_floats_ = has_floats_ || value.type == Value::Type::Float;
      box[key.axis] = {value.number, value.number};
    } else {
      known = Known::Nothing;
    }
  }
  return known;
}

void RangeBuild::narrow(const RangeTest& test, const KnownNumber& bound, const Box2& place,
                        BoxTree::Box& query_box) const {
  const bool is_geometry = test.kind == RangeTest::Kind::Near;
  const std::size_t axis = axisOf(test.slot, is_geometry);
  if (axis == BoxTree::kMaxDimensions) return;
  const auto cut = [&query_box](std::size_t at, double low, double high) {
    query_box[at] = {std::max(query_box[at].low, low), std::min(query_box[at].high, high)};
  };
  constexpr double kFar = std::numeric_limits<double>::infinity();
  if (is_geometry) {
    const Box2 box = widened(place, bound.number + bound.error);
    cut(axis, box.min_x, box.max_x);
    cut(axis + 1, box.min_y, box.max_y);
    return;
  }
  const double rounding = has_floats_ ? kFloatRounding : kRounding;
  const double margin = bound.error + (bound.size + std::abs(bound.number)) * rounding;
  if (!std::isfinite(margin)) return;
  if (test.kind == RangeTest::Kind::AtMost) cut(axis, -kFar, bound.number + margin);
  if (test.kind == RangeTest::Kind::AtLeast) cut(axis, bound.number - margin, kFar);
}

}  // namespace cluxel::sparql
