// SPDX-License-Identifier: Apache-2.0
// Named fragments of rules: `define:` names a piece of YAML, `use:` puts a copy of it in its place.
#pragma once

#include "rules/language/rule_sources.hpp"

namespace cluxel::rules {

/// Replaces every `use:` in the rules by what `define:` says. Copies keep the places of the definition. Unknown names,
/// definitions that use each other and copies that grow beyond all measure are faults; unused definitions are warnings.
void expandDefinitions(GatheredRules& gathered, FaultList& faults);

}  // namespace cluxel::rules
