// SPDX-License-Identifier: Apache-2.0
// Plan operators: each produces batches of solutions from the batches of its inputs (the iterator model).
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sparql/algebra/algebra.hpp"
#include "sparql/exec/runtime.hpp"

namespace cluxel::sparql {

class Operator;
struct RangeTest;
struct NearestTest;
using OperatorPtr = std::unique_ptr<Operator>;

/// Names for printing plans.
struct PlanNames {
  const AlgebraQuery& query;
  const QueryTerms& terms;
};

/// For a group whose HAVING rejects counts of `count` and more: of the rows that continue one row of a join and pass
/// the conditions, at most `count` are needed.
struct EnoughRows {
  std::uint64_t count = 0;
  std::vector<Slot> keys;        ///< of the group
  Slot counted = kNoSlot;        ///< kNoSlot: the rows
  bool distinct = false;         ///< each value counts once
  std::vector<Expr> conditions;  ///< of the filters between the join and the group
};

class Operator {
 public:
  virtual ~Operator() = default;
  /// Restarts the operator. `fresh` is false when only the outer input rows have changed; results that do not depend on
  /// them may then be reused.
  void open(Runtime& runtime, bool fresh) {
    runtime_ = &runtime;
    target_ = kFirstTarget;
    reopen(fresh);
  }
  /// Produces the next batch of at least one row; false at the end. Columns outside slots() are undefined.
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

  /// For an operator that gives rows by ascending distance: it ends when `is_enough(distance)` says that rows of this
  /// distance and more are not needed.
  // NOLINTNEXTLINE(performance-unnecessary-value-param): operators that use it keep it
  virtual void stopWhen(std::function<bool(double)> /*is_enough*/) {}

  /// For a join by distance: it may leave out rows that are not needed.
  // NOLINTNEXTLINE(performance-unnecessary-value-param): operators that use it keep it
  virtual void stopAfter(EnoughRows /*enough*/) {}

  /// The slots that may be bound, ascending.
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
  /// The desired batch size: small at first, for consumers that stop early.
  std::size_t target() const { return target_; }

  std::vector<Slot> slots_;

 private:
  Runtime* runtime_ = nullptr;
  std::size_t target_ = kFirstTarget;
  std::uint64_t actual_rows_ = 0;
};

/// Base of operators with one input.
class UnaryOperator : public Operator {
 public:
  explicit UnaryOperator(OperatorPtr child) : child_(std::move(child)) { slots_ = child_->slots(); }

 protected:
  void reopen(bool fresh) override { child_->open(runtime(), fresh); }
  void listInputs(std::vector<const Operator*>& inputs) const override { inputs.push_back(child_.get()); }
  OperatorPtr child_;
};

/// Produces one solution with the parameters of the run.
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

/// Produces nothing, without reading its input: the pattern contains a term that the store does not contain.
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

/// Replays the rows of an outer batch, with their row numbers in the column `origin`.
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

/// A subplan that is run for the rows of a batch.
struct Pipeline {
  OperatorPtr top;
  InputOperator* input = nullptr;
  Slot origin = kNoSlot;

  void start(Runtime& runtime, const Batch& batch, bool fresh) {
    input->feed(batch);
    top->open(runtime, fresh);
  }
};

/// An index scan of one pattern.
OperatorPtr makeScan(const TripleNode& pattern, rdf::QuadOrder order);
/// The index nested loop join of `child` with a pattern. `by_column`: so many lookups are expected that building a
/// subject column of the predicate (subject_column.hpp) pays off.
OperatorPtr makeQuadJoin(OperatorPtr child, const TripleNode& pattern, bool by_column);
/// Merge join. Both inputs are sorted by `slot`; all shared slots must be bound in every row.
OperatorPtr makeMergeJoin(OperatorPtr child, OperatorPtr other, Slot slot);
/// Pairs each row with the rows of `build` that pass the tests; all slots of `build` are bound in every row. The caller
/// filters the result: rows without numbers or boxes always pass.
OperatorPtr makeRangeJoin(OperatorPtr child, OperatorPtr build, std::vector<RangeTest> tests,
                          std::optional<NearestTest> nearest);
/// Binds the slot of the test to the stored geometries that may pass it.
OperatorPtr makeNearLookup(OperatorPtr child, RangeTest test);
OperatorPtr makePathJoin(OperatorPtr child, const TripleNode& pattern);
/// Hash join. The keys are the slots bound in every row of both sides; other shared slots are compared per candidate.
OperatorPtr makeHashJoin(OperatorPtr child, OperatorPtr build, std::vector<Slot> keys, std::vector<Slot> compared);
OperatorPtr makeLeftJoin(OperatorPtr child, Pipeline optional);
/// UNION: the rows of all branches for each row of the child.
OperatorPtr makeUnion(OperatorPtr child, std::vector<Pipeline> branches);
/// MINUS: removes the rows that are compatible with a row of `removed` and share a bound slot other than `ignored` with
/// it.
OperatorPtr makeMinus(OperatorPtr child, OperatorPtr removed, std::vector<Slot> keys, std::vector<Slot> compared,
                      Slot ignored);
/// Runs `body` once per distinct combination of the child's values in `outer`, passed as parameters, and joins its rows
/// to the child's, or (minus) removes the matching ones.
OperatorPtr makeCorrelatedJoin(OperatorPtr child, OperatorPtr body, const std::vector<Slot>& outer);
OperatorPtr makeCorrelatedMinus(OperatorPtr child, OperatorPtr body, const std::vector<Slot>& outer,
                                const std::vector<Slot>& shared, Slot ignored);
/// Concatenates the rows of its inputs.
OperatorPtr makeConcat(std::vector<OperatorPtr> branches);
struct ExistsPlan {
  std::uint32_t number = 0;
  Pipeline pipeline;
};
OperatorPtr makeFilter(OperatorPtr child, std::vector<Expr> conditions, std::vector<ExistsPlan> exists);
OperatorPtr makeExtend(OperatorPtr child, std::vector<std::pair<Slot, Expr>> columns, std::vector<ExistsPlan> exists);
/// `note` is the origin of the rows in plans, unless they come from a VALUES of the query.
OperatorPtr makeValues(std::vector<Slot> slots, IdRows rows, std::string note = {});
OperatorPtr makeGraphNames(OperatorPtr child, const GraphPlace& graph);
/// Runs `body` once per named graph, with the graph as the parameter `slot`.
OperatorPtr makeGraphLoop(OperatorPtr body, Slot slot);
OperatorPtr makeGroup(OperatorPtr child, std::vector<Slot> keys, std::vector<AggregateSpec> aggregates,
                      bool grouped_by_keys, std::vector<Slot> parameters, std::vector<ExistsPlan> exists);
/// The geometries in `slot`, objects of `predicate`, around `place`.
struct NearestScan {
  Slot slot = kNoSlot;
  Expr place;
  rdf::TermId predicate = rdf::kNoTerm;
};
/// Runs `body` for the stored geometries around the place of each row of `places`, the nearest first, until stopWhen().
/// Objects without a known distance come first.
OperatorPtr makeNearestSource(OperatorPtr places, Pipeline body, NearestScan scan);
/// Sorts; with `max_rows`, keeps only the first rows. Ties are broken by the terms of `ties`.
OperatorPtr makeOrder(OperatorPtr child, std::vector<SortKey> keys, std::vector<Expr> ties,
                      std::optional<std::uint64_t> max_rows, std::vector<ExistsPlan> exists);
OperatorPtr makeProject(OperatorPtr child, const std::vector<Slot>& slots);
OperatorPtr makeDistinct(OperatorPtr child, std::vector<Slot> slots);
OperatorPtr makeSlice(OperatorPtr child, std::uint64_t offset, std::optional<std::uint64_t> limit);

/// Evaluates the Exists of an expression for all rows of a batch, before the expression itself.
void answerExists(std::vector<ExistsPlan>& plans, const Batch& batch, Runtime& runtime, bool fresh);

/// The union of two ascending lists of slots.
std::vector<Slot> mergedSlots(const std::vector<Slot>& a, const std::vector<Slot>& b);

}  // namespace cluxel::sparql
