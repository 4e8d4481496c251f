// SPDX-License-Identifier: Apache-2.0
// Evaluates SPARQL rules (CONSTRUCT queries) in strata, each to its fixpoint, into graph inferred.
#pragma once

#include <vector>

#include "cluxel/progress.hpp"
#include "mapping/inference/inference_record.hpp"
#include "mapping/map_inputs.hpp"
#include "rdf/file/environment.hpp"
#include "rdf/ontology/ontology.hpp"

namespace cluxel::mapping {

/// Throws InputError when a text is not a CONSTRUCT query or its result may differ between runs.
void checkSparqlRules(const std::vector<NamedText>& rules);
/// The same for rules that no map has yet, for paths as refuseUnboundPaths() does, and for rules that name the graph of
/// the history. A map of an earlier program may have such a rule, and can still be changed.
void checkNewSparqlRules(const std::vector<NamedText>& rules);
/// Tells of classes and properties in SPARQL rules that the ontology does not know.
void noteUnknownNames(const std::vector<NamedText>& rules, const rdf::OntologyView& ontology, ProgressSink& sink);

/// Evaluates the rules in order. Each rule is a stratum: it sees the facts of earlier rules and its own, and is
/// repeated until it derives nothing new. Expects the closure to be complete and keeps it so. Each derived fact names
/// its rule by a clx:Derivation. What statements rule out (excludedTypes()) is not derived. Returns what a later
/// inference needs to follow changes.
InferenceRecord runSparqlRules(rdf::WriteTransaction& transaction, const std::vector<NamedText>& rules,
                               const rdf::InferenceCheck& check = {});

}  // namespace cluxel::mapping
