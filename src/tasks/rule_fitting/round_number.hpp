// SPDX-License-Identifier: Apache-2.0
// Numbers as people write them.
#pragma once

#include <string>

namespace cluxel::tasks {

/// The number with the fewest digits between `low` and `high`, both included; of several the one nearest to the middle.
/// The middle, to six digits, when low >= high.
double roundestIn(double low, double high);

/// To six digits wherever the point is: "2.5" for 2.500000, "1.23457e-05".
std::string sixDigitText(double value);

}  // namespace cluxel::tasks
