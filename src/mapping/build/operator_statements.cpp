// SPDX-License-Identifier: Apache-2.0
// Quads are copied by their terms: term ids differ between stores.
#include "mapping/build/operator_statements.hpp"

#include "rdf/vocabulary.hpp"

namespace cluxel::mapping {

namespace {

Term withSuffix(const Term& term, const std::string& suffix) {
  return term.kind == TermKind::BlankNode && !suffix.empty() ? Term::blank(term.text + suffix) : term;
}

}  // namespace

std::uint64_t copyOperatorStatements(const rdf::QuadReader& from, rdf::WriteTransaction& into,
                                     const std::string& blank_suffix) {
  const std::vector<Quad> quads = operatorStatements(from, blank_suffix);
  addOperatorStatements(into, quads);
  return quads.size();
}

void addOperatorStatements(rdf::WriteTransaction& transaction, const std::vector<Quad>& quads) {
  if (quads.empty()) return;
  rdf::QuadWriter writer(transaction);
  for (const Quad& quad : quads)
    writer.add(Quad{quad.subject, quad.predicate, quad.object, Term::iri(rdf::vocabulary::kGraphOperator)});
  writer.flush();
}

std::vector<Quad> operatorStatements(const rdf::QuadReader& reader, const std::string& blank_suffix) {
  const Term graph_term = Term::iri(rdf::vocabulary::kGraphOperator);
  const auto graph = reader.idOf(graph_term);
  if (!graph) return {};
  std::vector<Quad> quads;
  rdf::QuadCursor cursor = reader.scan({.s = {}, .p = {}, .o = {}, .g = *graph});
  for (rdf::QuadIds quad; cursor.next(quad);)
    quads.push_back({withSuffix(reader.termOf(quad.s), blank_suffix), reader.termOf(quad.p),
                     withSuffix(reader.termOf(quad.o), blank_suffix), graph_term});
  return quads;
}

void clearOperatorStatements(rdf::WriteTransaction& transaction) {
  rdf::QuadWriter writer(transaction);
  writer.clearGraph(writer.intern(Term::iri(rdf::vocabulary::kGraphOperator)));
  writer.flush();
}

}  // namespace cluxel::mapping
