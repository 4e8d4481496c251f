// SPDX-License-Identifier: Apache-2.0
// Hash aggregation: GROUP BY and aggregates.
#include <algorithm>

#include "sparql/exec/operators/operators.hpp"
#include "sparql/exec/values_ahead.hpp"
#include "sparql/functions/aggregate.hpp"

namespace cluxel::sparql {
namespace {

class GroupOperator : public UnaryOperator {
 public:
  GroupOperator(OperatorPtr child, std::vector<Slot> keys, std::vector<AggregateSpec> aggregates, bool grouped_by_keys,
                std::vector<Slot> parameters, std::vector<ExistsPlan> exists)
      : UnaryOperator(std::move(child)),
        keys_(std::move(keys)),
        aggregates_(std::move(aggregates)),
        grouped_by_keys_(grouped_by_keys),
        parameters_(std::move(parameters)),
        exists_(std::move(exists)),
        groups_(keys_.size()) {
    slots_ = mergedSlots(keys_, parameters_);
    for (const AggregateSpec& aggregate : aggregates_) {
      slots_ = mergedSlots(slots_, {aggregate.result});
      ValuesAhead& ahead = ahead_.emplace_back();
      if (looksAtValues(aggregate)) ahead.add(*aggregate.argument);
    }
  }
  std::string label(const PlanNames& names) const override {
    std::string text = grouped_by_keys_ ? "group by" : "one group";
    for (const Slot slot : keys_) text += " ?" + names.query.slot_names[slot];
    for (const AggregateSpec& aggregate : aggregates_) text += "  " + std::string(ast::nameOf(aggregate.function));
    return text;
  }

 protected:
  void reopen(bool fresh) override {
    UnaryOperator::reopen(fresh);
    fresh_ = fresh;
    for (const Accumulator& accumulator : accumulators_) runtime().guard.release(accumulator.bytes());
    runtime().guard.release(groups_.size() * bytesOfGroup());
    groups_.clear();
    accumulators_.clear();
    done_ = false;
    given_ = 0;
  }
  void listInputs(std::vector<const Operator*>& inputs) const override {
    UnaryOperator::listInputs(inputs);
    for (const ExistsPlan& plan : exists_) inputs.push_back(plan.pipeline.top.get());
  }

  bool produce(Batch& out) override {
    if (!done_) collect();
    out.rows = std::min(groups_.size() - given_, std::size_t{kLastTarget});
    for (std::size_t i = 0; i < out.rows; ++i) write(out, given_ + i);
    for (const Slot slot : parameters_) {
      if (runtime().parameters[slot] != kUnbound) out.columns[slot].assign(out.rows, runtime().parameters[slot]);
    }
    given_ += out.rows;
    return out.rows > 0;
  }

 private:
  void collect() {
    done_ = true;
    Batch in(runtime().slot_count);
    while (child_->next(in)) {
      if (!exists_.empty()) {
        answerExists(exists_, in, runtime(), fresh_);
        fresh_ = false;
      }
      assignGroups(in);
      for (std::size_t i = 0; i < aggregates_.size(); ++i) feed(in, i);
    }
    if (groups_.size() == 0 && !grouped_by_keys_) newGroup(nullptr);
  }

  std::size_t bytesOfGroup() const { return aggregates_.size() * sizeof(Accumulator) + keys_.size() * 8 + 16; }

  void newGroup(const ValueId* key) {
    if (key == nullptr) groups_.insert(kNoKey.data());
    accumulators_.resize(accumulators_.size() + aggregates_.size());
    runtime().guard.charge(bytesOfGroup());
  }

  void assignGroups(const Batch& in) {
    group_of_row_.resize(in.rows);
    const bool moves = accumulators_.size() + in.rows * aggregates_.size() > accumulators_.capacity();
    runtime().guard.requireRoomFor(groups_.growthFor(in.rows) +
                                   (moves ? accumulators_.size() * sizeof(Accumulator) : 0));
    std::vector<ValueId> key(std::max<std::size_t>(keys_.size(), 1));
    for (std::size_t row = 0; row < in.rows; ++row) {
      for (std::size_t i = 0; i < keys_.size(); ++i) key[i] = in.at(keys_[i], row);
      const auto [group, is_new] = groups_.insert(key.data());
      if (is_new) newGroup(key.data());
      group_of_row_[row] = group;
    }
  }

  void feed(const Batch& in, std::size_t number) {
    const AggregateSpec& spec = aggregates_[number];
    const auto of = [&](std::size_t row) -> Accumulator& {
      return accumulators_[group_of_row_[row] * aggregates_.size() + number];
    };
    if (!spec.argument) return feedRows(in, spec, number);
    Evaluator evaluator(runtime());
    const bool is_slot = spec.argument->kind == Expr::Kind::Slot;
    for (std::size_t row = 0; row < in.rows; ++row) {
      ahead_[number].before(row, in, runtime().terms);
      if (is_slot)
        of(row).addId(spec, in.at(spec.argument->slot, row), runtime());
      else
        of(row).add(spec, evaluator.value(*spec.argument, in, row), runtime());
    }
  }

  /// COUNT of a variable needs ids only, not values.
  static bool looksAtValues(const AggregateSpec& spec) {
    return spec.argument && (spec.function != ast::AggregateFunction::Count || spec.argument->kind != Expr::Kind::Slot);
  }

  /// COUNT(*)
  void feedRows(const Batch& in, const AggregateSpec& spec, std::size_t number) {
    std::vector<ValueId> cells(spec.row_slots.size());
    for (std::size_t row = 0; row < in.rows; ++row) {
      Accumulator& accumulator = accumulators_[group_of_row_[row] * aggregates_.size() + number];
      if (!spec.distinct) {
        accumulator.countRow();
        continue;
      }
      for (std::size_t i = 0; i < cells.size(); ++i) cells[i] = in.at(spec.row_slots[i], row);
      accumulator.countDistinctRow(cells, runtime());
    }
  }

  void write(Batch& out, std::size_t group) {
    const ValueId* key = groups_.row(group);
    for (std::size_t i = 0; i < keys_.size(); ++i) out.columns[keys_[i]].push_back(key[i]);
    for (std::size_t i = 0; i < aggregates_.size(); ++i) {
      Accumulator& accumulator = accumulators_[group * aggregates_.size() + i];
      out.columns[aggregates_[i].result].push_back(accumulator.result(aggregates_[i], runtime()));
    }
  }

  static constexpr std::array<ValueId, 1> kNoKey{};
  std::vector<Slot> keys_;
  std::vector<AggregateSpec> aggregates_;
  std::vector<ValuesAhead> ahead_;  ///< one per aggregate
  bool grouped_by_keys_;
  std::vector<Slot> parameters_;
  std::vector<ExistsPlan> exists_;
  RowSet groups_;
  std::vector<Accumulator> accumulators_;
  std::vector<std::uint32_t> group_of_row_;
  bool done_ = false, fresh_ = true;
  std::size_t given_ = 0;
};

}  // namespace

OperatorPtr makeGroup(OperatorPtr child, std::vector<Slot> keys, std::vector<AggregateSpec> aggregates,
                      bool grouped_by_keys, std::vector<Slot> parameters, std::vector<ExistsPlan> exists) {
  return std::make_unique<GroupOperator>(std::move(child), std::move(keys), std::move(aggregates), grouped_by_keys,
                                         std::move(parameters), std::move(exists));
}

}  // namespace cluxel::sparql
