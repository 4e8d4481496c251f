// SPDX-License-Identifier: Apache-2.0
// The interval in which a share lies, given how many examples it was counted on.
#pragma once

namespace cluxel::tasks {

struct ShareInterval {
  double low = 0, high = 1;
};

/// Wilson's 95 % interval of the share `hits` of `total` (E. B. Wilson, JASA 22, 1927); 0 to 1 for a total of 0. Half
/// numbers are allowed, as for F1, which is a share of the mean of true and found objects.
ShareInterval wilsonInterval(double hits, double total);

}  // namespace cluxel::tasks
