// SPDX-License-Identifier: Apache-2.0
// Half numbers need no other formula: the share and the number of examples are real numbers in it.
#include "tasks/evaluation/evaluation_shares.hpp"

#include <algorithm>
#include <cmath>

namespace cluxel::tasks {

ShareInterval wilsonInterval(double hits, double total) {
  if (total <= 0) return {};
  constexpr double z = 1.959963984540054;  // 97.5 % quantile of the normal distribution
  const double share = hits / total;
  const double scale = 1 + z * z / total;
  const double center = (share + z * z / (2 * total)) / scale;
  const double half = z / scale * std::sqrt(share * (1 - share) / total + z * z / (4 * total * total));
  return {std::max(0.0, center - half), std::min(1.0, center + half)};
}

}  // namespace cluxel::tasks
