// SPDX-License-Identifier: Apache-2.0
// Enforces resource budgets.
#include "sparql/exec/guard.hpp"

#include <string>

#include "cluxel/error.hpp"

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
  max_work_rows_ = budget.max_work_rows == 0 ? kNoLimit : budget.max_work_rows;
  max_answer_rows_ = budget.max_rows == 0 ? kNoLimit : budget.max_rows;
  max_bytes_ = budget.max_memory_bytes == 0 ? kNoLimit : budget.max_memory_bytes;
  charge(0);
  check();
  if (budget.deadline && budget.deadline->count() <= 0) refuse("time");
}

void Guard::check() {
  if (work_rows_ > max_work_rows_) refuse("rows");
  checkTime();
  next_check_ =
      std::min(work_rows_ + kRowsBetweenChecks, max_work_rows_ + (max_work_rows_ == ~std::uint64_t{0} ? 0 : 1));
}

void Guard::refuse(const char* what) const {
  const std::string request = budget_.is_of_update ? "update" : "query";
  throw Error(ErrorKind::BudgetExceeded, request + ": its budget of " + what + " is exceeded; " +
                                             (budget_.is_of_update ? "nothing was changed" : "no result is returned") +
                                             ". Narrow the " + request + " or raise the budget");
}

}  // namespace cluxel::sparql
