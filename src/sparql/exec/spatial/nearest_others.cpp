// SPDX-License-Identifier: Apache-2.0
// Best-first search for the nearest thing, with exact distances.
#include "sparql/exec/spatial/nearest_others.hpp"

#include <array>

#include "sparql/functions/function_bodies.hpp"

namespace cluxel::sparql {

void NearestOthers::reopen(Runtime& runtime, bool fresh) {
  if (!fresh && is_made_) return;
  runtime.guard.release(charged_);
  charged_ = 0;
  others_.clear();
  trees_.clear();
  is_made_ = false;
  test_.others->open(runtime, fresh);
}

void NearestOthers::make(Runtime& runtime) {
  if (is_made_) return;
  is_made_ = true;
  Batch batch(runtime.slot_count);
  while (test_.others->next(batch)) {
    runtime.guard.requireRoomFor(2 * (bytesOf(trees_) + others_.capacity() * sizeof(Other)));
    for (std::size_t row = 0; row < batch.rows; ++row) {
      const ValueId geometry = batch.at(test_.other, row);
      const KnownBox known = boxOf(runtime.terms.valueOf(geometry), runtime.functions);
      if (known.known != Known::Value) continue;
      BoxTree::Box box;
      box[0] = {known.box.min_x, known.box.max_x};
      box[1] = {known.box.min_y, known.box.max_y};
      treeOf(known.system, trees_, 2).add(box, static_cast<std::uint32_t>(others_.size()));
      others_.push_back({geometry, test_.distinguished == kNoSlot ? kUnbound : batch.at(test_.distinguished, row)});
    }
  }
  for (BoxTree& tree : trees_) tree.pack(runtime.guard);
  charged_ = bytesOf(trees_) + others_.capacity() * sizeof(Other);
  runtime.guard.charge(charged_);
}

double NearestOthers::reach(const Value& place, const KnownBox& known, Runtime& runtime) const {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  if (known.system >= trees_.size()) return kFar;
  const Box2& box = known.box;
  struct Best {
    double distance = kFar;
    ValueId thing = kUnbound;
  };
  Best best, second;  // of different things
  const bool needs_two = test_.distinguished != kNoSlot;
  BoxTree::Box from;
  from[0] = {box.min_x, box.max_x};
  from[1] = {box.min_y, box.max_y};
  trees_[known.system].nearest(from, [&](std::uint32_t row, double min_distance) {
    const double enough = needs_two ? second.distance : best.distance;
    if (min_distance > enough) return false;
    const Other& other = others_[row];
    runtime.guard.work(1);
    const std::array<Value, 2> arguments = {place, runtime.terms.valueOf(other.geometry)};
    const Value distance = geoDistanceFunction(arguments, runtime.functions);
    if (!distance.isNumeric()) return true;
    const Best found{distance.number, other.thing};
    if (found.distance < best.distance) {
      if (found.thing != best.thing) second = best;
      best = found;
    } else if (found.thing != best.thing && found.distance < second.distance) {
      second = found;
    }
    return true;
  });
  return needs_two ? second.distance : best.distance;
}

}  // namespace cluxel::sparql
