// SPDX-License-Identifier: Apache-2.0
// Changes numbers in the text of a rule file; comments, order and spacing stay.
#pragma once

#include <string>
#include <vector>

#include "tasks/rule_fitting/evidence_fit.hpp"

namespace cluxel::tasks {

/// `text` with the changes whose place is in `file`. Throws Error (FaultyInput) when no number stands at a place: the
/// text is not the one that was read.
std::string withNumbers(const std::string& text, const std::string& file, std::vector<FittedNumber> changes);

/// "0.85" for a share, "-1.5" for log-odds.
std::string writtenNumber(const FittedNumber& number);

}  // namespace cluxel::tasks
