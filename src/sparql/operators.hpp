// SPDX-License-Identifier: Apache-2.0
// The operators of a plan: each gives batches of solutions, taking those of the operators below it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sparql/algebra.hpp"
#include "sparql/runtime.hpp"

namespace cluxel::sparql {

class Operator;
using OperatorPtr = std::unique_ptr<Operator>;

/// Names for plans as text.
struct PlanNames {
  const AlgebraQuery& query;
  const QueryTerms& terms;
};

class Operator {
 public:
  virtual ~Operator() = default;
  /// Begins anew. `fresh` is false when only the rows given from outside have changed: then what was computed without
  /// them may be kept.
  void open(Runtime& runtime, bool fresh) {
    runtime_ = &runtime;
    target_ = kFirstTarget;
    reopen(fresh);
  }
  /// The next rows, at least one; false at the end. Columns outside slots() have no meaning.
  bool next(Batch& out) {
    out.reset();
    if (!produce(out)) return false;
    padColumns(out, slots_);
    actual_rows_ += out.rows;
    runtime_->guard.work(out.rows);
    runtime_->chargeForTerms();
    if (target_ < kLastTarget) target_ *= 4;
    return true;
  }

  /// The columns that may be bound, ascending.
  const std::vector<Slot>& slots() const { return slots_; }
  virtual std::string label(const PlanNames& names) const = 0;
  std::vector<const Operator*> inputs() const;

  double estimated_rows = 0;
  std::uint64_t actualRows() const { return actual_rows_; }
  ast::SourceOffset at = 0;

 protected:
  static constexpr std::size_t kFirstTarget = 32, kLastTarget = 2048;
  virtual void reopen(bool fresh) = 0;
  virtual bool produce(Batch& out) = 0;
  virtual void listInputs(std::vector<const Operator*>& /*inputs*/) const {}
  Runtime& runtime() const { return *runtime_; }
  /// How many rows a batch should have about now: few at first, for those who want only some.
  std::size_t target() const { return target_; }

  std::vector<Slot> slots_;

 private:
  Runtime* runtime_ = nullptr;
  std::size_t target_ = kFirstTarget;
  std::uint64_t actual_rows_ = 0;
};

/// One operator above another.
class UnaryOperator : public Operator {
 public:
  explicit UnaryOperator(OperatorPtr child) : child_(std::move(child)) { slots_ = child_->slots(); }

 protected:
  void reopen(bool fresh) override { child_->open(runtime(), fresh); }
  void listInputs(std::vector<const Operator*>& inputs) const override { inputs.push_back(child_.get()); }
  OperatorPtr child_;
};

/// One solution: the parameters of the run.
class UnitOperator : public Operator {
 public:
  explicit UnitOperator(std::vector<Slot> parameters) { slots_ = std::move(parameters); }
  std::string label(const PlanNames&) const override { return slots_.empty() ? "one solution" : "parameters"; }

 protected:
  void reopen(bool) override { done_ = false; }
  bool produce(Batch& out) override;

 private:
  bool done_ = false;
};

/// A pattern that names what the store does not have: nothing, whatever the rows below (which are not asked for).
class NothingOperator : public UnaryOperator {
 public:
  NothingOperator(OperatorPtr child, TripleNode pattern, const std::vector<Slot>& slots)
      : UnaryOperator(std::move(child)), pattern_(std::move(pattern)) {
    slots_ = slots;
  }
  std::string label(const PlanNames& names) const override {
    return "nothing in the store fits  " + describe(pattern_, names.query, names.terms);
  }

 protected:
  bool produce(Batch&) override { return false; }

 private:
  TripleNode pattern_;
};

/// The rows of an outer batch, with their numbers in the column `origin`.
class InputOperator : public Operator {
 public:
  InputOperator(const std::vector<Slot>& slots, Slot origin);
  void feed(const Batch& batch) { batch_ = &batch; }
  std::string label(const PlanNames&) const override { return "each solution"; }

 protected:
  void reopen(bool) override { done_ = false; }
  bool produce(Batch& out) override;

 private:
  const Batch* batch_ = nullptr;
  Slot origin_;
  bool done_ = false;
};

/// A part of a plan that runs for the rows of a batch.
struct Pipeline {
  OperatorPtr top;
  InputOperator* input = nullptr;
  Slot origin = kNoSlot;

  void start(Runtime& runtime, const Batch& batch, bool fresh) {
    input->feed(batch);
    top->open(runtime, fresh);
  }
};

/// Reads the quads of one pattern in the order of an index.
OperatorPtr makeScan(const TripleNode& pattern, QuadOrder order);
/// For each row of `child` the quads of a pattern: the index nested loop. `by_column`: there will be so many lookups
/// that a column of the predicate (subject_column.hpp) is worth making.
OperatorPtr makeQuadJoin(OperatorPtr child, const TripleNode& pattern, bool by_column);
/// Both ascend in `slot`, which every row binds, and share only slots that every row binds; each is read once.
OperatorPtr makeMergeJoin(OperatorPtr child, OperatorPtr other, Slot slot);
OperatorPtr makePathJoin(OperatorPtr child, const TripleNode& pattern);
/// All rows of `build` in a hash table over the slots bound on both sides in every row; other slots in common are
/// compared row by row.
OperatorPtr makeHashJoin(OperatorPtr child, OperatorPtr build, std::vector<Slot> keys, std::vector<Slot> compared);
OperatorPtr makeLeftJoin(OperatorPtr child, Pipeline optional);
/// The rows of all branches for each row of the child.
OperatorPtr makeUnion(OperatorPtr child, std::vector<Pipeline> branches);
/// Removes the rows that agree with a row of `removed` and share a bound slot other than `ignored` with it.
OperatorPtr makeMinus(OperatorPtr child, OperatorPtr removed, std::vector<Slot> keys, std::vector<Slot> compared,
                      Slot ignored);
/// `body` once for every combination of values that the child's rows have in `outer`, as parameters; its rows joined
/// to those of the child, or (minus) removing them.
OperatorPtr makeCorrelatedJoin(OperatorPtr child, OperatorPtr body, const std::vector<Slot>& outer);
OperatorPtr makeCorrelatedMinus(OperatorPtr child, OperatorPtr body, const std::vector<Slot>& outer,
                                const std::vector<Slot>& shared, Slot ignored);
/// The rows of one after the other.
OperatorPtr makeConcat(std::vector<OperatorPtr> branches);
struct ExistsPlan {
  std::uint32_t number = 0;
  Pipeline pipeline;
};
OperatorPtr makeFilter(OperatorPtr child, std::vector<Expr> conditions, std::vector<ExistsPlan> exists);
OperatorPtr makeExtend(OperatorPtr child, std::vector<std::pair<Slot, Expr>> columns, std::vector<ExistsPlan> exists);
/// `note`: where the rows come from, when not from a VALUES of the query.
OperatorPtr makeValues(std::vector<Slot> slots, std::vector<std::vector<ValueId>> rows, std::string note = {});
OperatorPtr makeGraphNames(OperatorPtr child, const GraphPlace& graph);
/// Runs `body` once per named graph, with the graph as a parameter in `slot`.
OperatorPtr makeGraphLoop(OperatorPtr body, Slot slot);
OperatorPtr makeGroup(OperatorPtr child, std::vector<Slot> keys, std::vector<AggregateSpec> aggregates,
                      bool grouped_by_keys, std::vector<Slot> parameters, std::vector<ExistsPlan> exists);
/// Sorts; with `most_rows` keeps only so many. Ties are broken by the terms of `tie_slots`.
OperatorPtr makeOrder(OperatorPtr child, std::vector<SortKey> keys, std::vector<Slot> tie_slots,
                      std::optional<std::uint64_t> most_rows, std::vector<ExistsPlan> exists);
OperatorPtr makeProject(OperatorPtr child, const std::vector<Slot>& slots);
OperatorPtr makeDistinct(OperatorPtr child, std::vector<Slot> slots);
OperatorPtr makeSlice(OperatorPtr child, std::uint64_t offset, std::optional<std::uint64_t> limit);

/// Answers the Exists of an expression for every row of a batch, before the expression is computed.
void answerExists(std::vector<ExistsPlan>& plans, const Batch& batch, Runtime& runtime, bool fresh);

/// The union of two ascending lists of slots.
std::vector<Slot> mergedSlots(const std::vector<Slot>& a, const std::vector<Slot>& b);

}  // namespace cluxel::sparql
