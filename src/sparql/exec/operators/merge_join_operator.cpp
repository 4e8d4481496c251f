// SPDX-License-Identifier: Apache-2.0
// The merge join of two inputs sorted by the same slot.
#include <algorithm>
#include <stdexcept>

#include "sparql/exec/operators/operators.hpp"

namespace cluxel::sparql {
namespace {

class MergeJoinOperator : public UnaryOperator {
 public:
  MergeJoinOperator(OperatorPtr child, OperatorPtr other, Slot slot)
      : UnaryOperator(std::move(child)), other_(std::move(other)), slot_(slot) {
    for (const Slot column : other_->slots()) {
      const bool shared = std::find(slots_.begin(), slots_.end(), column) != slots_.end();
      if (!shared) added_.push_back(column);
      if (shared && column != slot_) compared_.push_back(column);
    }
    carried_ = slots_;
    slots_ = mergedSlots(slots_, other_->slots());
  }
  std::string label(const PlanNames& names) const override { return "merge join on ?" + names.query.slot_names[slot_]; }

 protected:
  void reopen(bool fresh) override {
    UnaryOperator::reopen(fresh);
    other_->open(runtime(), fresh);
    in_.columns.resize(runtime().slot_count);
    ahead_.columns.resize(runtime().slot_count);
    group_.columns.resize(runtime().slot_count);
    in_.rows = ahead_.rows = row_ = ahead_row_ = 0;
    group_.reset();
    key_ = kUnbound;
    next_in_group_ = 0;
    at_end_ = false;
  }
  void listInputs(std::vector<const Operator*>& inputs) const override {
    UnaryOperator::listInputs(inputs);
    inputs.push_back(other_.get());
  }

  bool produce(Batch& out) override {
    while (out.rows < target()) {
      if (next_in_group_ >= group_.rows) {
        if (row_ >= in_.rows) {
          finishSegment(out);
          if (!child_->next(in_)) break;
          row_ = 0;
        }
        current_ = row_++;
        moveTo(in_.at(slot_, current_));
        next_in_group_ = 0;
        if (group_.rows == 0 && at_end_) {
          // Later rows cannot match either.
          row_ = in_.rows = 0;
          finishSegment(out);
          break;
        }
        continue;
      }
      const std::size_t match = next_in_group_++;
      if (!agrees(match)) continue;
      from_.push_back(static_cast<std::uint32_t>(current_));
      for (const Slot slot : added_) out.columns[slot].push_back(group_.at(slot, match));
      ++out.rows;
    }
    finishSegment(out);
    return out.rows > 0;
  }

 private:
  bool agrees(std::size_t match) const {
    return std::all_of(compared_.begin(), compared_.end(),
                       [&](Slot slot) { return in_.at(slot, current_) == group_.at(slot, match); });
  }

  /// Collects the rows of the other side with this key.
  void moveTo(ValueId key) {
    if (key == key_) return;
    if (key < key_) throw std::logic_error("merge join input is not sorted");
    key_ = key;
    group_.reset();
    while (!at_end_) {
      if (ahead_row_ >= ahead_.rows) {
        at_end_ = !other_->next(ahead_);
        ahead_row_ = 0;
        continue;
      }
      const auto& keys = ahead_.columns[slot_];
      const auto begin = keys.begin() + static_cast<std::ptrdiff_t>(ahead_row_);
      ahead_row_ = static_cast<std::size_t>(std::lower_bound(begin, keys.end(), key) - keys.begin());
      for (; ahead_row_ < ahead_.rows && keys[ahead_row_] == key; ++ahead_row_) {
        for (const Slot slot : other_->slots()) group_.columns[slot].push_back(ahead_.at(slot, ahead_row_));
        ++group_.rows;
      }
      if (ahead_row_ < ahead_.rows) return;
    }
  }

  void finishSegment(Batch& out) {
    if (from_.empty()) return;
    appendRows(in_, from_, carried_, out.rows - from_.size(), out);
    from_.clear();
  }

  OperatorPtr other_;
  Slot slot_;
  std::vector<Slot> added_, compared_, carried_;
  Batch in_, ahead_, group_;
  std::size_t row_ = 0, current_ = 0, ahead_row_ = 0, next_in_group_ = 0;
  ValueId key_ = kUnbound;
  bool at_end_ = false;
  std::vector<std::uint32_t> from_;
};

}  // namespace

OperatorPtr makeMergeJoin(OperatorPtr child, OperatorPtr other, Slot slot) {
  return std::make_unique<MergeJoinOperator>(std::move(child), std::move(other), slot);
}

}  // namespace cluxel::sparql
