// SPDX-License-Identifier: Apache-2.0
// The hash join, and MINUS by a hash anti-join.
#include <algorithm>
#include <array>

#include "sparql/exec/operators/row_filter.hpp"
#include "sparql/exec/row_table.hpp"

namespace cluxel::sparql {
namespace {

std::size_t positionOf(const std::vector<Slot>& slots, Slot slot) {
  return static_cast<std::size_t>(std::find(slots.begin(), slots.end(), slot) - slots.begin());
}

/// The build side: its rows in a hash table over the keys.
class BuildSide {
 public:
  BuildSide(OperatorPtr source, const std::vector<Slot>& keys, const std::vector<Slot>& compared)
      : source_(std::move(source)), table_(source_->slots()), keys_(keys), compared_(compared) {
    for (const Slot slot : keys_) key_columns_.push_back(positionOf(table_.slots(), slot));
    for (const Slot slot : compared_) compared_columns_.push_back(positionOf(table_.slots(), slot));
  }

  void reopen(Runtime& runtime, bool fresh) {
    if (!fresh && built_) return;
    table_.clear(runtime.guard);
    index_.clear(runtime.guard);
    built_ = false;
    source_->open(runtime, fresh);
  }
  void build(Runtime& runtime) {
    if (built_) return;
    built_ = true;
    Batch batch(runtime.slot_count);
    while (source_->next(batch)) table_.append(batch, runtime.guard);
    index_.build(table_, key_columns_, runtime.guard);
  }
  const RowTable& table() const { return table_; }
  const Operator* source() const { return source_.get(); }

  /// The first row in the chain from `candidate` that matches the probe row, or kEnd.
  std::uint32_t match(const Batch& probe, std::size_t row, std::uint32_t candidate, Guard& guard) const {
    for (std::size_t passed = 0; candidate != RowIndex::kEnd; candidate = index_.next(candidate)) {
      if (agrees(probe, row, table_.row(candidate))) return candidate;
      if (++passed % kCounted == 0) guard.work(kCounted);
    }
    return candidate;
  }
  std::uint32_t first(const Batch& probe, std::size_t row) const { return index_.first(hashOf(probe, row)); }
  std::uint32_t next(std::uint32_t row) const { return index_.next(row); }

 private:
  static constexpr std::size_t kCounted = 256;  // rejected candidates count as work too
  std::uint64_t hashOf(const Batch& probe, std::size_t row) const {
    return hashOfKey(keys_.size(), [&](std::size_t i) { return probe.at(keys_[i], row); });
  }
  bool agrees(const Batch& probe, std::size_t row, const ValueId* built) const {
    for (std::size_t i = 0; i < keys_.size(); ++i) {
      if (probe.at(keys_[i], row) != built[key_columns_[i]]) return false;
    }
    for (std::size_t i = 0; i < compared_.size(); ++i) {
      const ValueId a = probe.at(compared_[i], row), b = built[compared_columns_[i]];
      if (a != kUnbound && b != kUnbound && a != b) return false;
    }
    return true;
  }

  OperatorPtr source_;
  RowTable table_;
  RowIndex index_;
  std::vector<Slot> keys_, compared_;
  std::vector<std::size_t> key_columns_, compared_columns_;
  bool built_ = false;
};

std::string keyText(const std::vector<Slot>& keys, const PlanNames& names) {
  std::string text;
  for (const Slot slot : keys) text += " ?" + names.query.slot_names[slot];
  return text.empty() ? " of all with all" : " on" + text;
}

class HashJoinOperator : public UnaryOperator {
 public:
  HashJoinOperator(OperatorPtr child, OperatorPtr build, std::vector<Slot> keys, std::vector<Slot> compared)
      : UnaryOperator(std::move(child)), keys_(keys), build_(std::move(build), keys, compared) {
    const auto& built = build_.table().slots();
    for (const Slot slot : child_->slots()) {
      // A shared slot may be bound on one side only.
      if (std::find(built.begin(), built.end(), slot) == built.end() ||
          std::find(keys.begin(), keys.end(), slot) != keys.end()) {
        carried_.push_back(slot);
      } else {
        merged_.push_back(slot);
      }
    }
    for (std::size_t column = 0; column < built.size(); ++column) {
      if (std::find(keys.begin(), keys.end(), built[column]) == keys.end()) added_.emplace_back(built[column], column);
    }
    slots_ = mergedSlots(slots_, built);
  }
  std::string label(const PlanNames& names) const override { return "hash join" + keyText(keys_, names); }

 protected:
  void reopen(bool fresh) override {
    UnaryOperator::reopen(fresh);
    build_.reopen(runtime(), fresh);
    in_.columns.resize(runtime().slot_count);
    in_.rows = row_ = 0;
    candidate_ = RowIndex::kEnd;
  }
  void listInputs(std::vector<const Operator*>& inputs) const override {
    UnaryOperator::listInputs(inputs);
    inputs.push_back(build_.source());
  }

  bool produce(Batch& out) override {
    build_.build(runtime());
    if (build_.table().rows() == 0) return false;
    while (out.rows < target()) {
      if (candidate_ == RowIndex::kEnd) {
        if (row_ >= in_.rows) {
          finishSegment(out);
          if (!child_->next(in_)) break;
          row_ = 0;
        }
        current_ = row_++;
        candidate_ = build_.match(in_, current_, build_.first(in_, current_), runtime().guard);
        continue;
      }
      from_.push_back(static_cast<std::uint32_t>(current_));
      matched_.push_back(candidate_);
      ++out.rows;
      candidate_ = build_.match(in_, current_, build_.next(candidate_), runtime().guard);
    }
    finishSegment(out);
    return out.rows > 0;
  }

 private:
  void finishSegment(Batch& out) {
    if (from_.empty()) return;
    const std::size_t before = out.rows - from_.size();
    appendRows(in_, from_, carried_, before, out);
    appendRows(in_, from_, merged_, before, out);
    for (const auto& [slot, column] : added_) {
      auto& target = out.columns[slot];
      target.resize(out.rows, kUnbound);
      for (std::size_t i = 0; i < matched_.size(); ++i) {
        const ValueId id = build_.table().row(matched_[i])[column];
        if (id != kUnbound) target[before + i] = id;
      }
    }
    from_.clear();
    matched_.clear();
  }

  std::vector<Slot> keys_;
  BuildSide build_;
  std::vector<Slot> carried_, merged_;
  std::vector<std::pair<Slot, std::size_t>> added_;
  Batch in_;
  std::size_t row_ = 0, current_ = 0;
  std::uint32_t candidate_ = RowIndex::kEnd;
  std::vector<std::uint32_t> from_, matched_;
};

/// MINUS: removes the rows that are compatible with a row of the build side and share a bound variable with it.
class MinusOperator : public RowFilter {
 public:
  MinusOperator(OperatorPtr child, OperatorPtr removed, std::vector<Slot> keys, std::vector<Slot> compared,
                Slot ignored)
      : RowFilter(std::move(child)),
        build_(std::move(removed), keys, compared),
        keys_(std::move(keys)),
        compared_(std::move(compared)),
        ignored_(ignored) {
    for (const Slot slot : compared_) compared_columns_.push_back(positionOf(build_.table().slots(), slot));
  }
  std::string label(const PlanNames& names) const override {
    return "minus" + keyText(mergedSlots(keys_, compared_), names);
  }

 protected:
  void reopen(bool fresh) override {
    RowFilter::reopen(fresh);
    build_.reopen(runtime(), fresh);
  }
  void listInputs(std::vector<const Operator*>& inputs) const override {
    RowFilter::listInputs(inputs);
    inputs.push_back(build_.source());
  }
  void beginRun() override { build_.build(runtime()); }
  bool passes(const Batch& in, std::uint32_t row) override {
    std::uint64_t looked = 0;
    for (std::uint32_t found = build_.match(in, row, build_.first(in, row), runtime().guard); found != RowIndex::kEnd;
         found = build_.match(in, row, build_.next(found), runtime().guard)) {
      if (sharesBound(in, row, build_.table().row(found))) return false;
      if (++looked % 1024 == 0) runtime().guard.work(1024);
    }
    return true;
  }

 private:
  bool sharesBound(const Batch& in, std::size_t row, const ValueId* removed) const {
    if (!keys_.empty()) return true;
    for (std::size_t i = 0; i < compared_.size(); ++i) {
      if (compared_[i] == ignored_) continue;
      if (in.at(compared_[i], row) != kUnbound && removed[compared_columns_[i]] != kUnbound) return true;
    }
    return false;
  }

  BuildSide build_;
  std::vector<Slot> keys_, compared_;
  std::vector<std::size_t> compared_columns_;
  Slot ignored_;
};

}  // namespace

OperatorPtr makeHashJoin(OperatorPtr child, OperatorPtr build, std::vector<Slot> keys, std::vector<Slot> compared) {
  return std::make_unique<HashJoinOperator>(std::move(child), std::move(build), std::move(keys), std::move(compared));
}
OperatorPtr makeMinus(OperatorPtr child, OperatorPtr removed, std::vector<Slot> keys, std::vector<Slot> compared,
                      Slot ignored) {
  return std::make_unique<MinusOperator>(std::move(child), std::move(removed), std::move(keys), std::move(compared),
                                         ignored);
}

}  // namespace cluxel::sparql
