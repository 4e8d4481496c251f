// SPDX-License-Identifier: Apache-2.0
// For those who want a query run and not its answer.
#pragma once

#include "cluxel/sparql/result_table.hpp"

namespace cluxel {

/// Takes an answer and forgets it.
class NoSink : public ResultSink {
 public:
  void beginSolutions(std::span<const std::string>, const TermLookup&) override {}
  void rows(std::span<const ResultId>, std::size_t) override {}
  void boolean(bool) override {}
  void beginGraph() override {}
  void triple(const TermView&, const TermView&, const TermView&) override {}
  void end() override {}
};

}  // namespace cluxel
