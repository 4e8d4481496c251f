// SPDX-License-Identifier: Apache-2.0
// Makes graph inferred follow from the other graphs: anew, or by what has changed in them.
#pragma once

#include <optional>
#include <vector>

#include "cluxel/progress.hpp"
#include "mapping/inference/whole_rules.hpp"
#include "mapping/map_inputs.hpp"
#include "rdf/file/environment.hpp"
#include "rdf/ontology/ontology.hpp"

namespace cluxel::mapping {

/// Makes graph inferred hold the closure and what SPARQL rules derive. Follows the changes that the transaction has
/// made when graph inferred is known to have been inferred from the state before them and the rules allow it; else
/// infers everything anew. The outcome is the same. Notes axioms that are ignored. Gives the rules that it evaluated
/// for the whole map because of what they are; when everything is inferred anew, all that a change would evaluate so.
std::vector<WholeRule> inferAll(rdf::WriteTransaction& transaction, const std::vector<NamedText>& rules,
                                ProgressSink& sink, const rdf::InferenceCheck& check = {});

/// The same without looking at changes.
std::vector<WholeRule> inferAnew(rdf::WriteTransaction& transaction, const std::vector<NamedText>& rules,
                                 ProgressSink& sink, const rdf::InferenceCheck& check = {});

/// Follows the changes. Absent when that is not possible: then graph inferred may be in any state.
std::optional<std::vector<WholeRule>> inferChanges(rdf::WriteTransaction& transaction,
                                                   const std::vector<NamedText>& rules, ProgressSink& sink,
                                                   const rdf::InferenceCheck& check = {});

/// Notes the axioms of an ontology from which nothing is inferred, and what to write instead.
void noteUnusedAxioms(const std::vector<NamedText>& ontology, ProgressSink& sink);
/// Notes each label that is one of several classes.
void noteSharedLabels(const rdf::OntologyView& ontology, ProgressSink& sink);

}  // namespace cluxel::mapping
