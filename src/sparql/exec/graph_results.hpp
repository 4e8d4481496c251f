// SPDX-License-Identifier: Apache-2.0
// The triples of CONSTRUCT and DESCRIBE.
#pragma once

#include "sparql/exec/row_set.hpp"
#include "sparql/exec/runtime.hpp"
#include "sparql/results/result_table.hpp"

namespace cluxel::sparql {

class GraphResult {
 public:
  GraphResult(Runtime& runtime, const ast::Query& query, const AlgebraQuery& algebra);

  /// Instantiates the template for each row.
  void construct(const Batch& batch);
  /// Collects the resources of a DESCRIBE from each row.
  void describe(const Batch& batch);
  /// For DESCRIBE: adds the concise bounded descriptions of the collected resources.
  void finish();
  void write(ResultSink& sink) const;

 private:
  ValueId idOf(const ast::PatternTerm& place, const Batch& batch, std::size_t row,
               std::map<std::string, ValueId>& blanks);
  void add(ValueId subject, ValueId predicate, ValueId object);
  void describeNode(ValueId node);

  Runtime& runtime_;
  const ast::Query& query_;
  const AlgebraQuery& algebra_;
  RowSet triples_;
  IdSet noted_;
  std::vector<ValueId> resources_;
};

}  // namespace cluxel::sparql
