// SPDX-License-Identifier: Apache-2.0
// DISTINCT: passes the first of equal rows.
#include "sparql/exec/operators/operators.hpp"
#include "sparql/exec/row_set.hpp"

namespace cluxel::sparql {
namespace {

class DistinctOperator : public UnaryOperator {
 public:
  DistinctOperator(OperatorPtr child, std::vector<Slot> slots)
      : UnaryOperator(std::move(child)), columns_(std::move(slots)), seen_(columns_.size()) {}
  std::string label(const PlanNames&) const override { return "distinct"; }

 protected:
  void reopen(bool fresh) override {
    UnaryOperator::reopen(fresh);
    runtime().guard.release(seen_.bytes());
    seen_.clear();
    in_.columns.resize(runtime().slot_count);
  }
  bool produce(Batch& out) override {
    std::vector<ValueId> row(std::max<std::size_t>(columns_.size(), 1));
    while (child_->next(in_)) {
      kept_.clear();
      const std::size_t before = seen_.bytes();
      runtime().guard.requireRoomFor(seen_.growthFor(in_.rows));
      for (std::uint32_t i = 0; i < in_.rows; ++i) {
        for (std::size_t column = 0; column < columns_.size(); ++column) row[column] = in_.at(columns_[column], i);
        if (seen_.insert(row.data()).second) kept_.push_back(i);
      }
      runtime().guard.charge(seen_.bytes() - before);
      if (kept_.empty()) continue;
      appendRows(in_, kept_, slots_, 0, out);
      out.rows = kept_.size();
      return true;
    }
    return false;
  }

 private:
  std::vector<Slot> columns_;
  RowSet seen_;
  Batch in_;
  std::vector<std::uint32_t> kept_;
};

}  // namespace

OperatorPtr makeDistinct(OperatorPtr child, std::vector<Slot> slots) {
  return std::make_unique<DistinctOperator>(std::move(child), std::move(slots));
}

}  // namespace cluxel::sparql
