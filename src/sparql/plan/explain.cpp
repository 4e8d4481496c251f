// SPDX-License-Identifier: Apache-2.0
// Prints a query plan with estimated and actual row counts.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

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

nlohmann::ordered_json planJson(const Operator& plan, const PlanNames& names, bool has_run) {
  nlohmann::ordered_json json{{"operator", plan.label(names)},
                              {"estimated", std::llround(std::min(plan.estimated_rows, 1e18))}};
  if (has_run) json["actual"] = plan.actualRows();
  json["inputs"] = nlohmann::ordered_json::array();
  for (const Operator* input : plan.inputs()) json["inputs"].push_back(planJson(*input, names, has_run));
  return json;
}

}  // namespace

std::string PreparedQuery::explain() const {
  std::string out;
  printPlan(*impl_->plan, {impl_->algebra, impl_->terms}, impl_->has_run, 0, out);
  return out;
}

std::string PreparedQuery::explainJson() const {
  constexpr auto kReplaceInvalid = nlohmann::ordered_json::error_handler_t::replace;
  return planJson(*impl_->plan, {impl_->algebra, impl_->terms}, impl_->has_run).dump(-1, ' ', false, kReplaceInvalid);
}

}  // namespace cluxel::sparql
