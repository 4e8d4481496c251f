// SPDX-License-Identifier: Apache-2.0
// liblbfgs behind a std::function.
#include "perception/training/lbfgs_minimise.hpp"

#include <lbfgs.h>

#include <algorithm>
#include <exception>
#include <limits>
#include <memory>

namespace cluxel::perception {

namespace {

struct Call {
  const SmoothObjective& objective;
  std::exception_ptr failure;
};

lbfgsfloatval_t evaluate(void* instance, const lbfgsfloatval_t* x, lbfgsfloatval_t* gradient, const int n,
                         const lbfgsfloatval_t /*step*/) {
  auto& call = *static_cast<Call*>(instance);
  const auto size = static_cast<std::size_t>(n);
  try {
    return call.objective(std::span(x, size), std::span(gradient, size));
  } catch (...) {
    call.failure = std::current_exception();
    std::fill_n(gradient, size, 0.0);
    return std::numeric_limits<double>::infinity();
  }
}

int stopOnFailure(void* instance, const lbfgsfloatval_t*, const lbfgsfloatval_t*, lbfgsfloatval_t, lbfgsfloatval_t,
                  lbfgsfloatval_t, lbfgsfloatval_t, int, int, int) {
  return static_cast<Call*>(instance)->failure ? 1 : 0;
}

}  // namespace

std::vector<double> minimise(const SmoothObjective& objective, std::vector<double> start,
                             const MinimiseParams& params) {
  if (start.empty()) return start;
  const int n = static_cast<int>(start.size());
  const std::unique_ptr<lbfgsfloatval_t, decltype(&lbfgs_free)> x(lbfgs_malloc(n), &lbfgs_free);
  if (!x) throw std::bad_alloc();
  std::copy(start.begin(), start.end(), x.get());
  lbfgs_parameter_t settings;
  lbfgs_parameter_init(&settings);
  settings.max_iterations = params.iterations;
  settings.epsilon = params.precision;
  Call call{objective, nullptr};
  // A failed line search ends at the best point so far, which is acceptable.
  lbfgs(n, x.get(), nullptr, &evaluate, &stopOnFailure, &call, &settings);
  if (call.failure) std::rethrow_exception(call.failure);
  return {x.get(), x.get() + n};
}

}  // namespace cluxel::perception
