// SPDX-License-Identifier: Apache-2.0
// The range join: pairs each row with the rows of the build side that pass tests on numbers and distances.
#include <algorithm>
#include <limits>
#include <unordered_set>

#include "sparql/exec/spatial/nearest_others.hpp"
#include "sparql/exec/spatial/range_build.hpp"

namespace cluxel::sparql {
namespace {

class RangeJoinOperator : public UnaryOperator {
 public:
  RangeJoinOperator(OperatorPtr child, OperatorPtr build, std::vector<RangeTest> tests,
                    std::optional<NearestTest> nearest)
      : UnaryOperator(std::move(child)), tests_(std::move(tests)), build_(std::move(build), axes(nearest), !nearest) {
    if (nearest) nearest_.emplace(std::move(*nearest));
    const auto& built = build_.table().slots();
    for (std::size_t column = 0; column < built.size(); ++column) {
      const bool is_shared = std::find(slots_.begin(), slots_.end(), built[column]) != slots_.end();
      (is_shared ? shared_ : added_).emplace_back(built[column], column);
    }
    slots_ = mergedSlots(slots_, built);
  }
  std::string label(const PlanNames& names) const override {
    std::string text = "range join";
    for (const RangeTest& test : tests_)
      text += (text.size() > 10 ? " && " : "  ") + describe(test, names.query, names.terms);
    if (nearest_)
      text += "  ?" + names.query.slot_names[nearest_->test().slot] + " nearest to " +
              describe(nearest_->test().place, names.query, names.terms);
    if (enough_) text += ", the nearest " + std::to_string(enough_->count);
    return text;
  }
  void stopAfter(EnoughRows enough) override {
    const auto isAdded = [this](Slot slot) {
      return std::any_of(added_.begin(), added_.end(), [slot](const auto& added) { return added.first == slot; });
    };
    // Each row of the child must belong to one group, and each pair with it must be counted.
    if (nearest_ || std::any_of(enough.keys.begin(), enough.keys.end(), isAdded)) return;
    if (enough.counted != kNoSlot && !isAdded(enough.counted)) return;
    for (std::size_t i = 0; i < tests_.size(); ++i) {
      if (tests_[i].kind != RangeTest::Kind::Near || !tests_[i].place || !build_.isNearestBy(tests_[i].slot)) continue;
      enough_ = std::move(enough);
      near_ = i;
      return;
    }
  }

 protected:
  void reopen(bool fresh) override {
    UnaryOperator::reopen(fresh);
    build_.reopen(runtime(), fresh);
    if (nearest_) nearest_->reopen(runtime(), fresh);
    in_.columns.resize(runtime().slot_count);
    pair_ = Batch(runtime().slot_count);
    in_.rows = row_ = next_ = 0;
    found_.clear();
  }
  void listInputs(std::vector<const Operator*>& inputs) const override {
    UnaryOperator::listInputs(inputs);
    inputs.push_back(&build_.source());
    if (nearest_) inputs.push_back(nearest_->test().others.get());
  }
  bool produce(Batch& out) override {
    build_.make(runtime());
    if (nearest_) nearest_->make(runtime());
    if (build_.table().rows() == 0) return false;
    while (out.rows < target()) {
      if (next_ < found_.size()) {
        take(out);
        continue;
      }
      if (row_ >= in_.rows) {
        finishSegment(out);
        if (!child_->next(in_)) break;
        row_ = 0;
      }
      current_ = row_++;
      search();
    }
    finishSegment(out);
    return out.rows > 0;
  }

 private:
  /// The tests and the nearest geometry, which needs axes too.
  std::vector<RangeTest> axes(const std::optional<NearestTest>& nearest) const {
    std::vector<RangeTest> all = tests_;
    if (nearest) all.push_back({RangeTest::Kind::Near, nearest->slot, {}, nearest->place});
    return all;
  }

  /// Fills found_ with the candidates of the current row.
  void search() {
    found_.clear();
    next_ = 0;
    RangeBuild::Search search;
    place_.reset();
    if (!limit(search)) return;
    if (place_) return searchNearest();
    build_.find(search, found_, runtime().functions);
    runtime().guard.work(1 + found_.size() / 8);
  }

  /// Fills found_ with as many rows that pass the conditions as are needed, the nearest first.
  void searchNearest() {
    Evaluator evaluator(runtime());
    std::uint64_t counted = 0;
    counted_.clear();
    const auto isEnough = [&](std::uint32_t row) {
      runtime().guard.work(1);
      if (!isNeeded(row, evaluator)) return false;
      found_.push_back(row);
      // COUNT of a variable passes over rows that do not bind it.
      const ValueId value = enough_->counted == kNoSlot ? kUnbound : pair_.at(enough_->counted, 0);
      const bool counts = enough_->counted == kNoSlot || value != kUnbound;
      const bool is_new = !enough_->distinct || counted_.insert(value).second;
      counted += counts && is_new ? 1 : 0;
      return counted >= enough_->count;
    };
    if (!std::any_of(build_.loose().begin(), build_.loose().end(), isEnough)) {
      BoxTree::Box from;
      from[0] = {place_->box.min_x, place_->box.max_x};
      from[1] = {place_->box.min_y, place_->box.max_y};
      const double farthest = farthestOf(place_->box, reach_);
      build_.treeOf(place_->system, runtime().functions).nearest(from, [&](std::uint32_t row, double min_distance) {
        return min_distance <= farthest && !isEnough(row);
      });
    }
    std::sort(found_.begin(), found_.end());
  }

  bool isNeeded(std::uint32_t row, Evaluator& evaluator) {
    const ValueId* built = build_.table().row(row);
    for (const auto& [slot, column] : shared_) {
      if (in_.at(slot, current_) != built[column]) return false;
    }
    pair_.rows = 1;
    for (const Slot slot : child_->slots()) pair_.columns[slot].assign(1, in_.at(slot, current_));
    for (const auto& [slot, column] : added_) pair_.columns[slot].assign(1, built[column]);
    return std::all_of(enough_->conditions.begin(), enough_->conditions.end(),
                       [&](const Expr& condition) { return evaluator.truth(condition, pair_, 0).value_or(false); });
  }

  /// False when no row passes the tests.
  bool limit(RangeBuild::Search& search) {
    Evaluator evaluator(runtime());
    for (const RangeTest& test : tests_) {
      const KnownNumber bound = evaluated(test.bound, in_, current_, evaluator);
      if (bound.known == Known::Error) return false;
      KnownBox place{Known::Value, {}};
      if (test.place) place = boxOf(evaluator.value(*test.place, in_, current_), runtime().functions);
      if (place.known == Known::Error) return false;
      if (bound.known == Known::Value && place.known == Known::Value) build_.narrow(test, bound, place, search);
      if (!enough_ || &test != &tests_[near_] || place.known != Known::Value) continue;
      place_ = place;
      constexpr double kFar = std::numeric_limits<double>::infinity();
      reach_ = bound.known == Known::Value ? bound.number + bound.error : kFar;
    }
    if (nearest_) limitToNearest(search, evaluator);
    return true;
  }

  void limitToNearest(RangeBuild::Search& search, Evaluator& evaluator) {
    const NearestTest& test = nearest_->test();
    const Value place = evaluator.value(test.place, in_, current_);
    const KnownBox box = boxOf(place, runtime().functions);
    if (box.known != Known::Value) return;
    const RangeTest near{RangeTest::Kind::Near, test.slot, {}, test.place};
    build_.narrow(near, {Known::Value, nearest_->reach(place, box, runtime())}, box, search);
  }

  void take(Batch& out) {
    const std::uint32_t row = found_[next_++];
    const ValueId* built = build_.table().row(row);
    for (const auto& [slot, column] : shared_) {
      if (in_.at(slot, current_) != built[column]) return;
    }
    from_.push_back(static_cast<std::uint32_t>(current_));
    matched_.push_back(row);
    ++out.rows;
  }

  void finishSegment(Batch& out) {
    if (from_.empty()) return;
    const std::size_t before = out.rows - from_.size();
    appendRows(in_, from_, child_->slots(), before, out);
    for (const auto& [slot, column] : added_) {
      auto& target = out.columns[slot];
      target.resize(out.rows, kUnbound);
      for (std::size_t i = 0; i < matched_.size(); ++i) target[before + i] = build_.table().row(matched_[i])[column];
    }
    from_.clear();
    matched_.clear();
  }

  std::vector<RangeTest> tests_;
  RangeBuild build_;
  std::optional<NearestOthers> nearest_;
  std::vector<std::pair<Slot, std::size_t>> shared_, added_;
  Batch in_;
  std::size_t row_ = 0, current_ = 0, next_ = 0;
  std::vector<std::uint32_t> found_, from_, matched_;
  std::optional<EnoughRows> enough_;
  std::size_t near_ = 0;           ///< the test by which rows come nearest first
  std::optional<KnownBox> place_;  ///< the current row's box for that test, if it has one
  double reach_ = 0;               ///< the largest distance that still counts for that test
  Batch pair_;                     ///< one row, for the conditions
  std::unordered_set<ValueId> counted_;
};

}  // namespace

OperatorPtr makeRangeJoin(OperatorPtr child, OperatorPtr build, std::vector<RangeTest> tests,
                          std::optional<NearestTest> nearest) {
  return std::make_unique<RangeJoinOperator>(std::move(child), std::move(build), std::move(tests), std::move(nearest));
}

}  // namespace cluxel::sparql
