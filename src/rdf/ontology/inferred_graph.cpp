// SPDX-License-Identifier: Apache-2.0
// Maintains the graph `inferred` as the closure of the other graphs.
#include <algorithm>
#include <iterator>

#include "rdf/ontology/ontology.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::rdf {

namespace {

using namespace vocabulary;

struct GraphIds {
  TermId inferred = 0;
  std::vector<TermId> stated;  ///< ontology, observed, operator
};

GraphIds internGraphs(QuadWriter& writer) {
  GraphIds ids;
  ids.inferred = writer.intern(Term::iri(kGraphInferred));
  for (const std::string_view graph : {kGraphOntology, kGraphObserved, kGraphOperator})
    ids.stated.push_back(writer.intern(Term::iri(graph)));
  writer.flush();
  return ids;
}

std::vector<QuadIds> quadsOf(const QuadReader& reader, TermId graph) {
  std::vector<QuadIds> quads;
  QuadCursor cursor = reader.scan({.s = {}, .p = {}, .o = {}, .g = graph}, QuadOrder::Gspo);
  for (QuadIds quad; cursor.next(quad);) quads.push_back(quad);
  return quads;
}

ClosureLimits limitsOf(const QuadReader& reader, const InferenceCheck& check) {
  ClosureLimits limits = ClosureLimits::of(reader);
  limits.check = check;
  return limits;
}

}  // namespace

ClosureChange inferClosure(WriteTransaction& transaction, const InferenceCheck& check) {
  QuadWriter writer(transaction);
  const GraphIds graphs = internGraphs(writer);
  const QuadReader reader(transaction);
  EntailedQuads entailed = closureOf(reader, graphs.inferred, graphs.stated, limitsOf(reader, check));
  const std::vector<QuadIds>& target = entailed.quads;
  const std::vector<QuadIds> present = quadsOf(reader, graphs.inferred);
  std::vector<QuadIds> added;
  std::vector<QuadIds> removed;
  std::set_difference(target.begin(), target.end(), present.begin(), present.end(), std::back_inserter(added));
  std::set_difference(present.begin(), present.end(), target.begin(), target.end(), std::back_inserter(removed));
  for (const QuadIds& quad : added) writer.add(quad);
  for (const QuadIds& quad : removed) writer.remove(quad);
  writer.flush();
  return {added.size(), removed.size(), std::move(entailed.ignored), {}};
}

ClosureChange extendClosure(WriteTransaction& transaction, std::span<const QuadIds> fresh,
                            const InferenceCheck& check) {
  QuadWriter writer(transaction);
  GraphIds graphs = internGraphs(writer);
  graphs.stated.push_back(graphs.inferred);
  const QuadReader reader(transaction);
  EntailedQuads entailed = closureOf(reader, graphs.inferred, graphs.stated, limitsOf(reader, check), fresh);
  for (const QuadIds& quad : entailed.quads) writer.add(quad);
  writer.flush();
  return {entailed.quads.size(), 0, std::move(entailed.ignored), std::move(entailed.quads)};
}

}  // namespace cluxel::rdf
