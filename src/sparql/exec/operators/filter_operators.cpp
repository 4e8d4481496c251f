// SPDX-License-Identifier: Apache-2.0
// FILTER and BIND.
#include <algorithm>

#include "sparql/exec/operators/row_filter.hpp"
#include "sparql/exec/values_ahead.hpp"

namespace cluxel::sparql {
namespace {

class FilterOperator : public RowFilter {
 public:
  FilterOperator(OperatorPtr child, std::vector<Expr> conditions, std::vector<ExistsPlan> exists)
      : RowFilter(std::move(child)), conditions_(std::move(conditions)), exists_(std::move(exists)) {
    for (const Expr& condition : conditions_) ahead_.add(condition);
  }
  std::string label(const PlanNames& names) const override {
    std::string text = "filter";
    for (const Expr& condition : conditions_) {
      text += (text == "filter" ? "  " : " && ") + describe(condition, names.query, names.terms);
    }
    return text;
  }
  void stopAfter(EnoughRows enough) override {
    if (!exists_.empty()) return;
    enough.conditions.insert(enough.conditions.end(), conditions_.begin(), conditions_.end());
    child_->stopAfter(std::move(enough));
  }

 protected:
  void reopen(bool fresh) override {
    RowFilter::reopen(fresh);
    fresh_ = fresh;
  }
  void listInputs(std::vector<const Operator*>& inputs) const override {
    RowFilter::listInputs(inputs);
    for (const ExistsPlan& plan : exists_) inputs.push_back(plan.pipeline.top.get());
  }
  void beginBatch(const Batch& in) override {
    if (exists_.empty()) return;
    answerExists(exists_, in, runtime(), fresh_);
    fresh_ = false;
  }
  bool passes(const Batch& in, std::uint32_t row) override {
    ahead_.before(row, in, runtime().terms);
    Evaluator evaluator(runtime());
    return std::all_of(conditions_.begin(), conditions_.end(),
                       [&](const Expr& condition) { return evaluator.truth(condition, in, row).value_or(false); });
  }

 private:
  std::vector<Expr> conditions_;
  std::vector<ExistsPlan> exists_;
  ValuesAhead ahead_;
  bool fresh_ = true;
};

class ExtendOperator : public UnaryOperator {
 public:
  ExtendOperator(OperatorPtr child, std::vector<std::pair<Slot, Expr>> columns, std::vector<ExistsPlan> exists)
      : UnaryOperator(std::move(child)), columns_(std::move(columns)), exists_(std::move(exists)) {
    for (const auto& [slot, expression] : columns_) {
      slots_ = mergedSlots(slots_, {slot});
      ahead_.add(expression);
    }
  }
  std::string label(const PlanNames& names) const override {
    std::string text = "bind";
    for (const auto& [slot, expression] : columns_) {
      text += "  ?" + names.query.slot_names[slot] + " := " + describe(expression, names.query, names.terms);
    }
    return text;
  }

 protected:
  void reopen(bool fresh) override {
    UnaryOperator::reopen(fresh);
    fresh_ = fresh;
    in_.columns.resize(runtime().slot_count);
  }
  void listInputs(std::vector<const Operator*>& inputs) const override {
    UnaryOperator::listInputs(inputs);
    for (const ExistsPlan& plan : exists_) inputs.push_back(plan.pipeline.top.get());
  }
  bool produce(Batch& out) override {
    while (child_->next(in_)) {
      if (!exists_.empty()) {
        answerExists(exists_, in_, runtime(), fresh_);
        fresh_ = false;
      }
      compute(out);
      if (out.rows > 0) return true;
      out.reset();
    }
    return false;
  }

 private:
  void compute(Batch& out) {
    Evaluator evaluator(runtime());
    kept_.clear();
    for (const auto& [slot, expression] : columns_) in_.columns[slot].resize(in_.rows, kUnbound);
    for (std::uint32_t row = 0; row < in_.rows; ++row) {
      ahead_.before(row, in_, runtime().terms);
      ++runtime().functions.solution;
      bool agrees = true;
      for (const auto& [slot, expression] : columns_) {
        const ValueId id = runtime().terms.intern(evaluator.value(expression, in_, row));
        ValueId& cell = in_.columns[slot][row];
        // A variable that is already bound by the outer solution must have the same value.
        if (runtime().terms.computedBytes() > runtime().charged_for_terms + kUncharged) runtime().chargeForTerms();
        agrees = agrees && (cell == kUnbound || id == kUnbound || cell == id);
        if (id != kUnbound) cell = id;
      }
      if (agrees) kept_.push_back(row);
    }
    if (kept_.size() == in_.rows) {
      std::swap(in_, out);
      return;
    }
    appendRows(in_, kept_, slots_, 0, out);
    out.rows = kept_.size();
  }

  std::vector<std::pair<Slot, Expr>> columns_;
  std::vector<ExistsPlan> exists_;
  ValuesAhead ahead_;
  Batch in_;
  std::vector<std::uint32_t> kept_;
  static constexpr std::size_t kUncharged = 1 << 20;
  bool fresh_ = true;
};

}  // namespace

OperatorPtr makeFilter(OperatorPtr child, std::vector<Expr> conditions, std::vector<ExistsPlan> exists) {
  return std::make_unique<FilterOperator>(std::move(child), std::move(conditions), std::move(exists));
}
OperatorPtr makeExtend(OperatorPtr child, std::vector<std::pair<Slot, Expr>> columns, std::vector<ExistsPlan> exists) {
  return std::make_unique<ExtendOperator>(std::move(child), std::move(columns), std::move(exists));
}

}  // namespace cluxel::sparql
