// SPDX-License-Identifier: Apache-2.0
// Correlated parts of an EXISTS, evaluated once per outer solution: sub-selects, MINUS, and nested groups that use its
// variables.
#include <algorithm>
#include <map>

#include "sparql/exec/operators/row_filter.hpp"
#include "sparql/exec/row_table.hpp"

namespace cluxel::sparql {
namespace {

/// Memoises the rows of a part by the outer values that it depends on, because consecutive solutions often agree in
/// them.
class CorrelatedRows {
 public:
  CorrelatedRows(OperatorPtr body, std::vector<Slot> outer) : body_(std::move(body)), outer_(std::move(outer)) {}

  const Operator& body() const { return *body_; }
  void clear(Runtime& runtime) {
    for (auto& [key, table] : known_) table.clear(runtime.guard);
    known_.clear();
    kept_bytes_ = 0;
  }
  const RowTable& of(const Batch& batch, std::size_t row, Runtime& runtime) {
    key_.clear();
    for (const Slot slot : outer_) key_.push_back(batch.at(slot, row));
    const auto known = known_.find(key_);
    if (known != known_.end()) return known->second;
    if (kept_bytes_ > kMaxKeptBytes) clear(runtime);
    return known_.emplace(key_, computed(runtime)).first->second;
  }

 private:
  static constexpr std::size_t kMaxKeptBytes = 16 << 20;

  RowTable computed(Runtime& runtime) {
    std::vector<ValueId> before;
    for (std::size_t i = 0; i < outer_.size(); ++i)
      before.push_back(std::exchange(runtime.parameters[outer_[i]], key_[i]));
    RowTable table(body_->slots());
    Batch made(runtime.slot_count);
    body_->open(runtime, true);
    while (body_->next(made)) table.append(made, runtime.guard);
    for (std::size_t i = 0; i < outer_.size(); ++i) runtime.parameters[outer_[i]] = before[i];
    kept_bytes_ += table.bytes() + sizeof(RowTable);
    return table;
  }

  OperatorPtr body_;
  std::vector<Slot> outer_;
  std::vector<ValueId> key_;
  std::map<std::vector<ValueId>, RowTable> known_;
  std::size_t kept_bytes_ = 0;
};

/// The columns shared by the part's rows and the solutions.
using SharedColumns = std::vector<std::pair<Slot, std::size_t>>;

SharedColumns columnsOf(const std::vector<Slot>& target_slots, const std::vector<Slot>& slots) {
  SharedColumns columns;
  for (std::size_t i = 0; i < slots.size(); ++i) {
    if (std::find(target_slots.begin(), target_slots.end(), slots[i]) != target_slots.end())
      columns.emplace_back(slots[i], i);
  }
  return columns;
}

bool isCompatible(const SharedColumns& shared, const Batch& batch, std::size_t row, const ValueId* other) {
  return std::all_of(shared.begin(), shared.end(), [&](const auto& column) {
    const ValueId mine = batch.at(column.first, row), theirs = other[column.second];
    return mine == kUnbound || theirs == kUnbound || mine == theirs;
  });
}

std::string outerText(const std::vector<Slot>& outer, const PlanNames& names) {
  std::string text;
  for (const Slot slot : outer) text += " ?" + names.query.slot_names[slot];
  return text;
}

class CorrelatedJoinOperator : public UnaryOperator {
 public:
  CorrelatedJoinOperator(OperatorPtr child, OperatorPtr body, const std::vector<Slot>& outer)
      : UnaryOperator(std::move(child)),
        outer_(outer),
        shared_(columnsOf(child_->slots(), body->slots())),
        body_slots_(body->slots()),
        rows_(std::move(body), outer) {
    slots_ = mergedSlots(child_->slots(), body_slots_);
  }
  std::string label(const PlanNames& names) const override { return "for each" + outerText(outer_, names); }

 protected:
  void reopen(bool fresh) override {
    UnaryOperator::reopen(fresh);
    if (fresh) rows_.clear(runtime());
    in_.columns.resize(runtime().slot_count);
    in_.rows = row_ = next_ = 0;
  }
  void listInputs(std::vector<const Operator*>& inputs) const override {
    UnaryOperator::listInputs(inputs);
    inputs.push_back(&rows_.body());
  }
  bool produce(Batch& out) override {
    while (out.rows < target()) {
      if (row_ >= in_.rows) {
        if (!child_->next(in_)) break;
        row_ = next_ = 0;
      }
      const RowTable& table = rows_.of(in_, row_, runtime());
      for (; next_ < table.rows() && out.rows < target(); ++next_) join(table.row(next_), out);
      runtime().guard.work(1);
      if (next_ < table.rows()) break;
      ++row_;
      next_ = 0;
    }
    return out.rows > 0;
  }

 private:
  void join(const ValueId* other, Batch& out) {
    if (!isCompatible(shared_, in_, row_, other)) return;
    for (const Slot slot : slots_)
      out.columns[slot].push_back(in_.columns[slot].empty() ? kUnbound : in_.at(slot, row_));
    for (std::size_t i = 0; i < body_slots_.size(); ++i) {
      if (other[i] != kUnbound) out.columns[body_slots_[i]].back() = other[i];
    }
    ++out.rows;
  }

  std::vector<Slot> outer_;
  SharedColumns shared_;
  std::vector<Slot> body_slots_;
  CorrelatedRows rows_;
  Batch in_;
  std::size_t row_ = 0, next_ = 0;
};

class CorrelatedMinusOperator : public RowFilter {
 public:
  CorrelatedMinusOperator(OperatorPtr child, OperatorPtr body, const std::vector<Slot>& outer,
                          const std::vector<Slot>& shared, Slot ignored)
      : RowFilter(std::move(child)),
        outer_(outer),
        shared_(columnsOf(shared, body->slots())),
        ignored_(ignored),
        rows_(std::move(body), outer) {}
  std::string label(const PlanNames& names) const override { return "minus, for each" + outerText(outer_, names); }

 protected:
  void reopen(bool fresh) override {
    RowFilter::reopen(fresh);
    if (fresh) rows_.clear(runtime());
  }
  void listInputs(std::vector<const Operator*>& inputs) const override {
    RowFilter::listInputs(inputs);
    inputs.push_back(&rows_.body());
  }
  bool passes(const Batch& in, std::uint32_t row) override {
    const RowTable& table = rows_.of(in, row, runtime());
    runtime().guard.work(table.rows());
    for (std::size_t i = 0; i < table.rows(); ++i) {
      if (isCompatible(shared_, in, row, table.row(i)) && sharesBound(in, row, table.row(i))) return false;
    }
    return true;
  }

 private:
  bool sharesBound(const Batch& in, std::size_t row, const ValueId* other) const {
    return std::any_of(shared_.begin(), shared_.end(), [&](const auto& column) {
      return column.first != ignored_ && in.at(column.first, row) != kUnbound && other[column.second] != kUnbound;
    });
  }

  std::vector<Slot> outer_;
  SharedColumns shared_;
  Slot ignored_;
  CorrelatedRows rows_;
};

}  // namespace

OperatorPtr makeCorrelatedJoin(OperatorPtr child, OperatorPtr body, const std::vector<Slot>& outer) {
  return std::make_unique<CorrelatedJoinOperator>(std::move(child), std::move(body), outer);
}
OperatorPtr makeCorrelatedMinus(OperatorPtr child, OperatorPtr body, const std::vector<Slot>& outer,
                                const std::vector<Slot>& shared, Slot ignored) {
  return std::make_unique<CorrelatedMinusOperator>(std::move(child), std::move(body), outer, shared, ignored);
}

}  // namespace cluxel::sparql
