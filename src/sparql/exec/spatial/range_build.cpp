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
  }
  dimensions_ = axes;
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
  trees_.clear();
  noted_.clear();
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
    Search placed;
    const Known known = place(table_.row(row), runtime, placed);
    if (known == Known::Value)
      sparql::treeOf(placed.system.value_or(SearchBox::kMapFrame), trees_, dimensions_).add(placed.box, row);
    if (known == Known::Nothing || (known == Known::Error && !strict_)) loose_.push_back(row);
    runtime.guard.work(1);
    if (row % kRowsOfCheck == 0) runtime.guard.requireRoomFor(2 * bytesOf(trees_));
  }
  for (BoxTree& tree : trees_) tree.pack(runtime.guard);
  charged_ = bytesOf(trees_) + loose_.capacity() * sizeof(std::uint32_t);
  runtime.guard.charge(charged_);
}

Known RangeBuild::place(const ValueId* row, Runtime& runtime, Search& placed) {
  Known known = Known::Value;
  for (const Key& key : keys_) {
    const Value value = runtime.terms.valueOf(row[key.column]);
    if (key.is_geometry) {
      const KnownBox found = boxOf(value, runtime.functions);
      if (found.known == Known::Error) return Known::Error;
      if (!placed.system) placed.system = found.system;
      if (found.known == Known::Nothing || found.system != *placed.system) known = Known::Nothing;
      placed.box[key.axis] = {found.box.min_x, found.box.max_x};
      placed.box[key.axis + 1] = {found.box.min_y, found.box.max_y};
    } else if (value.isNumeric() && !std::isnan(value.number)) {
      has_floats_ = has_floats_ || value.type == Value::Type::Float;
      placed.box[key.axis] = {value.number, value.number};
    } else {
      known = Known::Nothing;
    }
  }
  return known;
}

void RangeBuild::narrow(const RangeTest& test, const KnownNumber& bound, const KnownBox& place, Search& search) const {
  const bool is_geometry = test.kind == RangeTest::Kind::Near;
  const std::size_t axis = axisOf(test.slot, is_geometry);
  if (axis == BoxTree::kMaxDimensions) return;
  const auto cut = [&box = search.box](std::size_t at, double low, double high) {
    box[at] = {std::max(box[at].low, low), std::min(box[at].high, high)};
  };
  constexpr double kFar = std::numeric_limits<double>::infinity();
  if (is_geometry) {
    const auto first = std::find_if(keys_.begin(), keys_.end(), [](const Key& key) { return key.is_geometry; });
    if (!search.system && first->axis == axis) search.system = place.system;
    if (search.system != place.system) return;
    const Box2 box = widened(place.box, bound.number + bound.error);
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

void RangeBuild::find(const Search& search, std::vector<std::uint32_t>& found, FunctionContext& functions) {
  found.clear();
  const auto take = [&found](std::uint32_t row) { found.push_back(row); };
  for (std::uint32_t system = 0; system < trees_.size(); ++system) {
    if (!search.system || *search.system == system)
      trees_[system].search(search.box, take);
    else if (!strict_)
      trees_[system].search({}, take);
  }
  if (strict_ && search.system) noteOthers(*search.system, functions);
  std::sort(found.begin(), found.end());
  const auto middle = static_cast<std::ptrdiff_t>(found.size());
  found.insert(found.end(), loose_.begin(), loose_.end());
  std::inplace_merge(found.begin(), found.begin() + middle, found.end());
}

const BoxTree& RangeBuild::treeOf(std::uint32_t system, FunctionContext& functions) {
  noteOthers(system, functions);
  return sparql::treeOf(system, trees_, dimensions_);
}

/// Warns of geometries in different reference systems. A spatial function would warn when it is called, but a range
/// join does not call it for such pairs.
void RangeBuild::noteOthers(std::uint32_t system, FunctionContext& functions) {
  if (noted_.size() <= system) noted_.resize(system + 1, false);
  if (noted_[system]) return;
  noted_[system] = true;
  const GeometryCache& geometries = *functions.geometries;
  for (std::uint32_t other = 0; other < trees_.size(); ++other)
    if (other != system && trees_[other].size() > 0)
      noteDifferentSystems(geometries.systemName(system), geometries.systemName(other), functions);
}

}  // namespace cluxel::sparql
