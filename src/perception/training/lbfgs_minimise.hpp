// SPDX-License-Identifier: Apache-2.0
// Minimises a smooth function by liblbfgs.
#pragma once

#include <functional>
#include <span>
#include <vector>

namespace cluxel::perception {

/// Returns the value at `x` and writes the gradient.
using SmoothObjective = std::function<double(std::span<const double> x, std::span<double> gradient)>;

struct MinimiseParams {
  int iterations = 200;
  double precision = 1e-5;  ///< stop when |gradient| < precision * max(1, |x|)
};

/// The best point found from `start`. Deterministic; rethrows what the objective throws.
std::vector<double> minimise(const SmoothObjective& objective, std::vector<double> start, const MinimiseParams& params);

}  // namespace cluxel::perception
