// SPDX-License-Identifier: Apache-2.0
// The options for budgets that `query` and `update` share.
#pragma once

#include <cstdint>

#include "app/command.hpp"
#include "sparql/query_engine.hpp"

namespace cluxel::app {

struct BudgetOptions {
  double deadline_s = 0;  ///< 0: none
  std::uint64_t max_memory_mib = 0;

  void applyTo(sparql::QueryBudget& budget) const;
};

void addBudget(CLI::App& command, BudgetOptions& options);

}  // namespace cluxel::app
