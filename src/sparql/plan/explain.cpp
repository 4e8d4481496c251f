// SPDX-License-Identifier: Apache-2.0
// Prints a query plan with estimated and actual row counts.
#include <algorithm>
#include <cmath>

#include "sparql/exec/prepared_query.hpp"
#include "sparql/results/result_table.hpp"

namespace cluxel::sparql {
namespace {

std::string rounded(double rows) {
  return std::to_string(static_cast<long long>(std::llround(std::min(rows, 1e18))));
}

void printPlan(const Operator& plan, const PlanNames& names, bool has_run, std::size_t depth, std::string& out) {
  std::string line = std::string(depth * 2, ' ') + plan.label(names);
  constexpr std::size_t kColumn = 72;
  line += std::string(line.size() + 2 < kColumn ? kColumn - line.size() : 2, ' ');
  line += "estimated " + rounded(plan.estimated_rows);
  if (has_run) line += ", actual " + std::to_string(plan.actualRows());
  out += line + "\n";
  for (const Operator* input : plan.inputs()) printPlan(*input, names, has_run, depth + 1, out);
}

}  // namespace

std::string PreparedQuery::explain() const {
  std::string out;
  printPlan(*impl_->plan, {impl_->algebra, impl_->terms}, impl_->has_run, 0, out);
  return out;
}

}  // namespace cluxel::sparql
