// SPDX-License-Identifier: Apache-2.0
// Larger limits are no limits in practice, and would overflow.
#include "app/budget_options.hpp"

#include <algorithm>
#include <cmath>

namespace cluxel::app {

void BudgetOptions::applyTo(sparql::QueryBudget& budget) const {
  constexpr double kMaxDeadline_s = 1e9;
  constexpr std::uint64_t kMaxMemory_mib = std::uint64_t{1} << 40U;
  if (deadline_s > 0)
    budget.deadline = std::chrono::milliseconds(std::llround(std::min(deadline_s, kMaxDeadline_s) * 1000));
  if (max_memory_mib > 0) budget.max_memory_bytes = std::min(max_memory_mib, kMaxMemory_mib) << 20U;
}

void addBudget(CLI::App& command, BudgetOptions& options) {
  command.add_option("--deadline", options.deadline_s, "seconds after which the command fails with exit code 6")
      ->check(above0());
  command.add_option("--max-memory", options.max_memory_mib, "MiB above which the command fails with exit code 6")
      ->check(above0());
}

}  // namespace cluxel::app
