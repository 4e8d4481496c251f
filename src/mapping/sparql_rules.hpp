// SPDX-License-Identifier: Apache-2.0
// Rules as CONSTRUCT queries: stratum by stratum, each to its fixpoint, into the inferred graph.
#pragma once

#include <vector>

#include "cluxel/knowledge/environment.hpp"
#include "cluxel/mapping/map_inputs.hpp"

namespace cluxel {

/// Throws InputError when a text is no CONSTRUCT query or uses what differs from run to run.
void checkSparqlRules(const std::vector<NamedText>& rules);

/// Runs the rules in order; each is a stratum: it sees what earlier ones derived, and itself until nothing new comes.
/// The closure has been inferred before and is brought up to date. Each derived fact names its rule by a
/// clx:Derivation.
void runSparqlRules(WriteTransaction& transaction, const std::vector<NamedText>& rules);

}  // namespace cluxel
