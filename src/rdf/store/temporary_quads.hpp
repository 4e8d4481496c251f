// SPDX-License-Identifier: Apache-2.0
// Quads that are added to a store, or taken out of it, for the time of a query.
#pragma once

#include <utility>
#include <vector>

#include "rdf/store/quad_store.hpp"

namespace cluxel::rdf {

/// Without end() the store stays changed: after an error its transaction is dropped.
class TemporaryQuads {
 public:
  /// The store must not have the quads in `with`, and must have those in `without`.
  TemporaryQuads(WriteTransaction& transaction, std::vector<QuadIds> with, std::vector<QuadIds> without)
      : transaction_(transaction), with_(std::move(with)), without_(std::move(without)) {
    exchange(with_, without_);
  }
  void end() { exchange(without_, with_); }

 private:
  void exchange(const std::vector<QuadIds>& in, const std::vector<QuadIds>& out) {
    if (in.empty() && out.empty()) return;
    QuadWriter writer(transaction_);
    for (const QuadIds& quad : in) writer.add(quad);
    for (const QuadIds& quad : out) writer.remove(quad);
    writer.flush();
  }

  WriteTransaction& transaction_;
  std::vector<QuadIds> with_, without_;
};

}  // namespace cluxel::rdf
