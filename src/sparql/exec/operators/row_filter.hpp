// SPDX-License-Identifier: Apache-2.0
// Base of FILTER and both forms of MINUS: an operator that passes a subset of its rows.
#pragma once

#include "sparql/exec/operators/operators.hpp"

namespace cluxel::sparql {

class RowFilter : public UnaryOperator {
 public:
  using UnaryOperator::UnaryOperator;

 protected:
  /// Called before each request for rows, possibly many times in a run.
  virtual void beginRun() {}
  /// Called before the rows of each batch.
  virtual void beginBatch(const Batch& /*in*/) {}
  /// Called for the rows of a batch in order.
  virtual bool passes(const Batch& in, std::uint32_t row) = 0;

  void reopen(bool fresh) override {
    UnaryOperator::reopen(fresh);
    in_.columns.resize(runtime().slot_count);
  }
  bool produce(Batch& out) final {
    beginRun();
    while (child_->next(in_)) {
      beginBatch(in_);
      kept_.clear();
      for (std::uint32_t row = 0; row < in_.rows; ++row) {
        if (passes(in_, row)) kept_.push_back(row);
      }
      if (kept_.empty()) continue;
      if (kept_.size() == in_.rows) {
        std::swap(in_, out);
        return true;
      }
      appendRows(in_, kept_, slots_, 0, out);
      out.rows = kept_.size();
      return true;
    }
    return false;
  }

 private:
  Batch in_;
  std::vector<std::uint32_t> kept_;
};

}  // namespace cluxel::sparql
