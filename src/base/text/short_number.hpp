// SPDX-License-Identifier: Apache-2.0
// Numbers as messages show them.
#pragma once

#include <string>

namespace cluxel {

/// The number rounded to so many decimals, without zeros at the end: "2.5", "-3", "0". From 1e15 on with an exponent
/// and six digits, because nobody reads hundreds of digits: "1e300", "-2.5e17". "inf" and "nan" for what is no number.
std::string shortNumber(double value, int decimals = 6);

}  // namespace cluxel
