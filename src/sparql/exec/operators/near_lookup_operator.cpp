// SPDX-License-Identifier: Apache-2.0
// Looks up, for each row, the stored geometries near one of its geometries.
#include <algorithm>

#include "rdf/store/geometry_index.hpp"
#include "sparql/exec/operators/operators.hpp"
#include "sparql/exec/spatial/range_test.hpp"

namespace cluxel::sparql {
namespace {

class NearLookupOperator : public UnaryOperator {
 public:
  NearLookupOperator(OperatorPtr child, RangeTest test) : UnaryOperator(std::move(child)), test_(std::move(test)) {
    slots_ = mergedSlots(slots_, {test_.slot});
  }
  std::string label(const PlanNames& names) const override {
    return "R-tree lookup  " + describe(test_, names.query, names.terms);
  }

 protected:
  void reopen(bool fresh) override {
    UnaryOperator::reopen(fresh);
    if (fresh || !index_) index_ = runtime().reader.geometries();
    in_.columns.resize(runtime().slot_count);
    in_.rows = row_ = next_ = 0;
    found_.clear();
  }
  bool produce(Batch& out) override {
    while (out.rows < target()) {
      if (next_ == found_.size()) {
        if (row_ >= in_.rows) {
          finishSegment(out);
          if (!child_->next(in_)) break;
          row_ = 0;
        }
        current_ = row_++;
        next_ = 0;
        search();
        continue;
      }
      const std::size_t taken = std::min(found_.size() - next_, target() - out.rows);
      auto& column = out.columns[test_.slot];
      column.resize(out.rows, kUnbound);
      column.insert(column.end(), found_.begin() + static_cast<std::ptrdiff_t>(next_),
                    found_.begin() + static_cast<std::ptrdiff_t>(next_ + taken));
      from_.insert(from_.end(), taken, static_cast<std::uint32_t>(current_));
      out.rows += taken;
      next_ += taken;
    }
    finishSegment(out);
    return out.rows > 0;
  }

 private:
  /// Fills found_ with the candidates of the current row.
  void search() {
    found_.clear();
    runtime().guard.work(1);
    Evaluator evaluator(runtime());
    const KnownNumber bound = evaluated(test_.bound, in_, current_, evaluator);
    const KnownBox place = mapBoxOf(evaluator.value(*test_.place, in_, current_), runtime().functions);
    if (bound.known == Known::Error || place.known == Known::Error) return;
    Box2 box = widened(place.box, bound.number + bound.error);
    constexpr double kFar = std::numeric_limits<double>::infinity();
    if (bound.known == Known::Nothing || place.known == Known::Nothing) box = {-kFar, -kFar, kFar, kFar};
    found_ = index_->meeting(rdf::FlatBox::around(box.min_x, box.min_y, box.max_x, box.max_y));
    const ValueId known = in_.at(test_.slot, current_);
    if (known != kUnbound) std::erase_if(found_, [known](ValueId id) { return id != known; });
  }

  void finishSegment(Batch& out) {
    if (from_.empty()) return;
    std::vector<Slot> carried = child_->slots();
    std::erase(carried, test_.slot);
    appendRows(in_, from_, carried, out.rows - from_.size(), out);
    from_.clear();
  }

  RangeTest test_;
  std::shared_ptr<const rdf::GeometryIndex> index_;
  Batch in_;
  std::size_t row_ = 0, current_ = 0, next_ = 0;
  std::vector<ValueId> found_;
  std::vector<std::uint32_t> from_;
};

}  // namespace

OperatorPtr makeNearLookup(OperatorPtr child, RangeTest test) {
  return std::make_unique<NearLookupOperator>(std::move(child), std::move(test));
}

}  // namespace cluxel::sparql
