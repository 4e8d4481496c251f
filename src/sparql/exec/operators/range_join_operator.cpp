// SPDX-License-Identifier: Apache-2.0
// The range join: pairs each row with the rows of the build side that pass tests on numbers and distances.
#include <algorithm>

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
    return text;
  }

 protected:
  void reopen(bool fresh) override {
    UnaryOperator::reopen(fresh);
    build_.reopen(runtime(), fresh);
    if (nearest_) nearest_->reopen(runtime(), fresh);
    in_.columns.resize(runtime().slot_count);
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
    BoxTree::Box query_box;
    if (!limit(query_box)) return;
    build_.tree().search(query_box, [this](std::uint32_t row) { found_.push_back(row); });
    std::sort(found_.begin(), found_.end());
    const auto middle = static_cast<std::ptrdiff_t>(found_.size());
    found_.insert(found_.end(), build_.loose().begin(), build_.loose().end());
    std::inplace_merge(found_.begin(), found_.begin() + middle, found_.end());
    runtime().guard.work(1 + found_.size() / 8);
  }

  /// False when no row passes the tests.
  bool limit(BoxTree::Box& query_box) {
    Evaluator evaluator(runtime());
    for (const RangeTest& test : tests_) {
      const KnownNumber bound = evaluated(test.bound, in_, current_, evaluator);
      if (bound.known == Known::Error) return false;
      KnownBox place{Known::Value, {}};
      if (test.place) place = boxOf(evaluator.value(*test.place, in_, current_), runtime().functions);
      if (place.known == Known::Error) return false;
      if (bound.known == Known::Value && place.known == Known::Value) build_.narrow(test, bound, place.box, query_box);
    }
    if (nearest_) limitToNearest(query_box, evaluator);
    return true;
  }

  void limitToNearest(BoxTree::Box& query_box, Evaluator& evaluator) {
    const NearestTest& test = nearest_->test();
    const Value place = evaluator.value(test.place, in_, current_);
    const KnownBox box = boxOf(place, runtime().functions);
    if (box.known != Known::Value) return;
    const RangeTest near{RangeTest::Kind::Near, test.slot, {}, test.place};
    build_.narrow(near, {Known::Value, nearest_->reach(place, box.box, runtime())}, box.box, query_box);
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
};

}  // namespace

OperatorPtr makeRangeJoin(OperatorPtr child, OperatorPtr build, std::vector<RangeTest> tests,
                          std::optional<NearestTest> nearest) {
  return std::make_unique<RangeJoinOperator>(std::move(child), std::move(build), std::move(tests), std::move(nearest));
}

}  // namespace cluxel::sparql
