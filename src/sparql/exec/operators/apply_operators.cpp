// SPDX-License-Identifier: Apache-2.0
// Operators that evaluate a subplan for the rows of another: OPTIONAL, UNION, EXISTS, GRAPH with sub-selects.
#include <algorithm>

#include "sparql/exec/operators/operators.hpp"

namespace cluxel::sparql {
namespace {

std::vector<Slot> without(std::vector<Slot> slots, Slot slot) {
  std::erase(slots, slot);
  return slots;
}

class LeftJoinOperator : public UnaryOperator {
 public:
  LeftJoinOperator(OperatorPtr child, Pipeline optional)
      : UnaryOperator(std::move(child)), optional_(std::move(optional)) {
    slots_ = mergedSlots(slots_, without(optional_.top->slots(), optional_.origin));
  }
  std::string label(const PlanNames&) const override { return "optional"; }
  void stopAfter(EnoughRows enough) override {
    // Filters above see rows without a match too: whether there is one must not follow from them.
    if (enough.conditions.empty()) optional_.top->stopAfter(std::move(enough));
  }

 protected:
  void reopen(bool fresh) override {
    UnaryOperator::reopen(fresh);
    fresh_ = fresh;
    active_ = false;
    in_.columns.resize(runtime().slot_count);
    made_.columns.resize(runtime().slot_count);
  }
  void listInputs(std::vector<const Operator*>& inputs) const override {
    UnaryOperator::listInputs(inputs);
    inputs.push_back(optional_.top.get());
  }
  bool produce(Batch& out) override {
    while (true) {
      if (!active_) {
        if (!child_->next(in_)) return false;
        optional_.start(runtime(), in_, fresh_);
        fresh_ = false;
        active_ = true;
        matched_.assign(in_.rows, 0);
      }
      if (optional_.top->next(out)) {
        for (const ValueId origin : out.columns[optional_.origin]) matched_[origin] = 1;
        out.columns[optional_.origin].clear();
        return true;
      }
      active_ = false;
      out.reset();
      picks_.clear();
      for (std::uint32_t row = 0; row < in_.rows; ++row) {
        if (matched_[row] == 0) picks_.push_back(row);
      }
      if (picks_.empty()) continue;
      appendRows(in_, picks_, child_->slots(), 0, out);
      out.rows = picks_.size();
      return true;
    }
  }

 private:
  Pipeline optional_;
  Batch in_, made_;
  std::vector<std::uint8_t> matched_;
  std::vector<std::uint32_t> picks_;
  bool fresh_ = true, active_ = false;
};

class UnionOperator : public UnaryOperator {
 public:
  UnionOperator(OperatorPtr child, std::vector<Pipeline> branches)
      : UnaryOperator(std::move(child)), branches_(std::move(branches)) {
    for (const Pipeline& branch : branches_) slots_ = mergedSlots(slots_, without(branch.top->slots(), branch.origin));
  }
  std::string label(const PlanNames&) const override { return "union"; }

 protected:
  void reopen(bool fresh) override {
    UnaryOperator::reopen(fresh);
    fresh_.assign(branches_.size(), fresh ? 1 : 0);
    branch_ = branches_.size();
    started_ = false;
    in_.columns.resize(runtime().slot_count);
  }
  void listInputs(std::vector<const Operator*>& inputs) const override {
    UnaryOperator::listInputs(inputs);
    for (const Pipeline& branch : branches_) inputs.push_back(branch.top.get());
  }
  bool produce(Batch& out) override {
    while (true) {
      if (branch_ >= branches_.size()) {
        if (!child_->next(in_)) return false;
        branch_ = 0;
        started_ = false;
      }
      Pipeline& branch = branches_[branch_];
      if (!started_) {
        branch.start(runtime(), in_, fresh_[branch_] != 0);
        fresh_[branch_] = 0;
        started_ = true;
      }
      if (branch.top->next(out)) {
        out.columns[branch.origin].clear();
        return true;
      }
      out.reset();
      ++branch_;
      started_ = false;
    }
  }

 private:
  std::vector<Pipeline> branches_;
  std::vector<std::uint8_t> fresh_;
  std::size_t branch_ = 0;
  bool started_ = false;
  Batch in_;
};

class ConcatOperator : public Operator {
 public:
  explicit ConcatOperator(std::vector<OperatorPtr> branches) : branches_(std::move(branches)) {
    for (const OperatorPtr& branch : branches_) slots_ = mergedSlots(slots_, branch->slots());
  }
  std::string label(const PlanNames&) const override { return "union"; }

 protected:
  void reopen(bool fresh) override {
    for (const OperatorPtr& branch : branches_) branch->open(runtime(), fresh);
    branch_ = 0;
  }
  void listInputs(std::vector<const Operator*>& inputs) const override {
    for (const OperatorPtr& branch : branches_) inputs.push_back(branch.get());
  }
  bool produce(Batch& out) override {
    for (; branch_ < branches_.size(); ++branch_) {
      if (branches_[branch_]->next(out)) return true;
    }
    return false;
  }

 private:
  std::vector<OperatorPtr> branches_;
  std::size_t branch_ = 0;
};

class GraphLoopOperator : public UnaryOperator {
 public:
  GraphLoopOperator(OperatorPtr body, Slot slot) : UnaryOperator(std::move(body)), slot_(slot) {
    slots_ = mergedSlots(slots_, {slot});
  }
  std::string label(const PlanNames& names) const override {
    return "for each named graph ?" + names.query.slot_names[slot_];
  }

 protected:
  void reopen(bool) override {
    graph_ = 0;
    started_ = false;
  }
  bool produce(Batch& out) override {
    const std::vector<rdf::TermId>& named = runtime().dataset.named;
    for (; graph_ < named.size(); ++graph_, started_ = false) {
      runtime().parameters[slot_] = named[graph_];
      if (!started_) child_->open(runtime(), true);
      started_ = true;
      if (!child_->next(out)) continue;
      out.columns[slot_].assign(out.rows, named[graph_]);
      return true;
    }
    out.reset();
    return false;
  }

 private:
  Slot slot_;
  std::size_t graph_ = 0;
  bool started_ = false;
};

}  // namespace

void answerExists(std::vector<ExistsPlan>& plans, const Batch& batch, Runtime& runtime, bool fresh) {
  for (ExistsPlan& plan : plans) {
    std::vector<std::uint8_t> answers(batch.rows, 0);
    std::size_t open = batch.rows;
    plan.pipeline.start(runtime, batch, fresh);
    Batch made(runtime.slot_count);
    while (open > 0 && plan.pipeline.top->next(made)) {
      for (const ValueId origin : made.columns[plan.pipeline.origin]) {
        open -= answers[origin] == 0 ? 1 : 0;
        answers[origin] = 1;
      }
    }
    runtime.exists_results[plan.number] = std::move(answers);
  }
}

OperatorPtr makeLeftJoin(OperatorPtr child, Pipeline optional) {
  return std::make_unique<LeftJoinOperator>(std::move(child), std::move(optional));
}
OperatorPtr makeUnion(OperatorPtr child, std::vector<Pipeline> branches) {
  return std::make_unique<UnionOperator>(std::move(child), std::move(branches));
}
OperatorPtr makeConcat(std::vector<OperatorPtr> branches) {
  return std::make_unique<ConcatOperator>(std::move(branches));
}
OperatorPtr makeGraphLoop(OperatorPtr body, Slot slot) {
  return std::make_unique<GraphLoopOperator>(std::move(body), slot);
}

}  // namespace cluxel::sparql
