// SPDX-License-Identifier: Apache-2.0
// The ids of a map's graphs, as inference sees them.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "cluxel/progress.hpp"
#include "rdf/store/quad_journal.hpp"
#include "rdf/store/quad_store.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::mapping {

struct InferenceGraphs {
  std::vector<rdf::TermId> sources;  ///< ontology, observed and operator, as far as the store names them
  rdf::TermId inferred = rdf::kNoGraph, history = rdf::kNoGraph;
  bool are_all = true;  ///< there is no other graph

  explicit InferenceGraphs(const rdf::QuadReader& reader) {
    using namespace rdf::vocabulary;
    for (const std::string_view name : {kGraphOntology, kGraphObserved, kGraphOperator})
      if (const auto id = reader.idOf(Term::iri(name))) sources.push_back(*id);
    inferred = reader.idOf(Term::iri(kGraphInferred)).value_or(rdf::kNoGraph);
    history = reader.idOf(Term::iri(kGraphHistory)).value_or(rdf::kNoGraph);
    for (const rdf::TermId graph : reader.graphs())
      are_all = are_all && (graph == inferred || graph == history || isSource(graph));
  }
  bool isSource(rdf::TermId graph) const { return std::find(sources.begin(), sources.end(), graph) != sources.end(); }
};

void noteIgnoredAxioms(const std::vector<std::string>& axioms, ProgressSink& sink);

}  // namespace cluxel::mapping
