// SPDX-License-Identifier: Apache-2.0
// What FILTER and both forms of MINUS are: an operator that lets some of its rows pass.
#pragma once

#include "sparql/operators.hpp"

namespace cluxel::sparql {

class RowFilter : public UnaryOperator {
 public:
  using UnaryOperator::UnaryOperator;

 protected:
  /// Before batches are asked for: whenever rows are wanted, so again and again in a run.
  virtual void beginRun() {}
  /// Before the rows of each batch.
  virtual void beginBatch(const Batch& /*in*/) {}
  /// The rows of a batch come in turn.
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
