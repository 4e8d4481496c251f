// SPDX-License-Identifier: Apache-2.0
// The set functions of SPARQL 1.1 section 18.5.1; all are independent of the order of values.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "sparql/exec/row_set.hpp"
#include "sparql/exec/runtime.hpp"

namespace cluxel::sparql {

/// An order-independent sum: integers and decimals exactly, floating-point numbers with a single rounding.
class ExactSum {
 public:
  /// Returns false for a non-numeric value.
  bool add(const Value& value, const QueryTerms& terms);
  Value total() const;

 private:
  void addReal(double value);
  double realTotal() const;

  Value::Type type_ = Value::Type::Integer;
  std::int64_t small_ = 0;
  Decimal exact_;
  std::vector<double> partials_;        ///< exact sum as non-overlapping partials (Shewchuk)
  std::vector<double> great_partials_;  ///< the same for numbers near the end of the range, scaled down
  double special_ = 0;                  ///< infinities and NaN
  bool is_special_ = false;
};

/// The state of one aggregate in one group.
class Accumulator {
 public:
  void add(const AggregateSpec& spec, const Value& value, Runtime& runtime);
  void countRow() { ++count_; }
  /// COUNT(DISTINCT *)
  void countDistinctRow(std::span<const ValueId> row, Runtime& runtime);
  /// Counts a bound id without decoding it.
  void addId(const AggregateSpec& spec, ValueId id, Runtime& runtime);
  ValueId result(const AggregateSpec& spec, Runtime& runtime);
  /// The bytes charged to the guard.
  std::size_t bytes() const;

 private:
  bool isRepeated(const AggregateSpec& spec, ValueId id, Runtime& runtime);
  void take(const AggregateSpec& spec, const Value& value, Runtime& runtime);
  void countText(const Value& value, const AggregateSpec& spec, Runtime& runtime);

  std::uint64_t count_ = 0;
  std::size_t text_bytes_ = 0;  ///< of GROUP_CONCAT
  bool error_ = false;
  Value best_;
  std::unique_ptr<ExactSum> sum_;
  std::unique_ptr<IdSet> seen_;
  std::unique_ptr<RowSet> seen_rows_;
  std::unique_ptr<std::vector<Value>> texts_;
};

}  // namespace cluxel::sparql
