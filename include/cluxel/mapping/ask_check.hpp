// SPDX-License-Identifier: Apache-2.0
// The queries of rules, looked at when the rules are loaded and not only when one is asked.
#pragma once

#include "cluxel/reasoning/rule_loader.hpp"

namespace cluxel {

/// Options that report faulty queries of `ask:`, and those whose answer would not follow from the map alone.
RuleLoadOptions withCheckedQueries();

}  // namespace cluxel
