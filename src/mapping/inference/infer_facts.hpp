// SPDX-License-Identifier: Apache-2.0
// Makes graph inferred follow from the other graphs: anew, or by what has changed in them.
#pragma once

#include <vector>

#include "cluxel/progress.hpp"
#include "mapping/map_inputs.hpp"
#include "rdf/file/environment.hpp"
#include "rdf/ontology/ontology.hpp"

namespace cluxel::mapping {

/// Makes graph inferred hold the closure and what SPARQL rules derive. Follows the changes that the transaction has
/// made when graph inferred is known to have been inferred from the state before them and the rules allow it; else
/// infers everything anew. The outcome is the same. Notes axioms that are ignored, and rules that a change evaluates as
/// a whole.
void inferAll(rdf::WriteTransaction& transaction, const std::vector<NamedText>& rules, ProgressSink& sink,
              const rdf::InferenceCheck& check = {});

/// The same without looking at changes.
void inferAnew(rdf::WriteTransaction& transaction, const std::vector<NamedText>& rules, ProgressSink& sink,
               const rdf::InferenceCheck& check = {});

/// Follows the changes. False when that is not possible: then graph inferred may be in any state.
bool inferChanges(rdf::WriteTransaction& transaction, const std::vector<NamedText>& rules, ProgressSink& sink,
                  const rdf::InferenceCheck& check = {});

/// Notes the axioms of an ontology from which nothing is inferred, and what to write instead.
void noteUnusedAxioms(const std::vector<NamedText>& ontology, ProgressSink& sink);
/// Notes each label that is one of several classes.
void noteSharedLabels(const rdf::OntologyView& ontology, ProgressSink& sink);

}  // namespace cluxel::mapping
