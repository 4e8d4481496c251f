// SPDX-License-Identifier: Apache-2.0
// Budgets.
#include "sparql/guard.hpp"

#include <string>

#include "cluxel/base/diagnostic.hpp"

namespace cluxel::sparql {
namespace {

constexpr std::uint64_t kRowsBetweenChecks = 4096;

}  // namespace

void Guard::start(const QueryBudget& budget, const Usage& used) {
  budget_ = budget;
  constexpr auto kNoLimit = ~std::uint64_t{0};
  start_ = std::chrono::steady_clock::now() - used.time;
  deadline_ = start_ + budget.deadline.value_or(std::chrono::milliseconds(0));
  work_rows_ = used.work_rows;
  bytes_ = used.bytes;
  shared_.clear();
  most_work_rows_ = budget.max_work_rows == 0 ? kNoLimit : budget.max_work_rows;
  most_answer_rows_ = budget.max_rows == 0 ? kNoLimit : budget.max_rows;
  most_bytes_ = budget.max_memory_bytes == 0 ? kNoLimit : budget.max_memory_bytes;
  charge(0);
  check();
  if (budget.deadline && budget.deadline->count() <= 0) refuse("time");
}

void Guard::check() {
  if (work_rows_ > most_work_rows_) refuse("rows");
  if (budget_.deadline && std::chrono::steady_clock::now() > deadline_) refuse("time");
  next_check_ =
      std::min(work_rows_ + kRowsBetweenChecks, most_work_rows_ + (most_work_rows_ == ~std::uint64_t{0} ? 0 : 1));
}

void Guard::refuse(const char* what) const {
  throw Error(ExitCode::BudgetExceeded, std::string("query: its budget of ") + what +
                                            " is used up; no answer is given. Narrow the query or raise the budget");
}

}  // namespace cluxel::sparql
