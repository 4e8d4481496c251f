// SPDX-License-Identifier: Apache-2.0
// Instantiates CONSTRUCT templates and computes concise bounded descriptions.
#include "sparql/exec/graph_results.hpp"

namespace cluxel::sparql {

GraphResult::GraphResult(Runtime& runtime, const ast::Query& query, const AlgebraQuery& algebra)
    : runtime_(runtime), query_(query), algebra_(algebra), triples_(3) {}

ValueId GraphResult::idOf(const ast::PatternTerm& place, const Batch& batch, std::size_t row,
                          std::map<std::string, ValueId>& blanks) {
  if (place.isVariable()) return batch.at(algebra_.slot_of_variable[place.variable()], row);
  const Term& term = place.term();
  if (term.kind != TermKind::BlankNode) return runtime_.terms.intern(term);
  ValueId& blank = blanks[term.text];
  if (blank == kUnbound) blank = runtime_.terms.intern(Term::blank(runtime_.functions.freshLabel()));
  return blank;
}

void GraphResult::add(ValueId subject, ValueId predicate, ValueId object) {
  if (subject == kUnbound || predicate == kUnbound || object == kUnbound) return;
  if (runtime_.terms.view(subject).kind == TermKind::Literal) return;
  if (runtime_.terms.view(predicate).kind != TermKind::Iri) return;
  const std::array<ValueId, 3> triple = {subject, predicate, object};
  const std::size_t before = triples_.bytes();
  triples_.insert(triple.data());
  if (triples_.bytes() != before) runtime_.guard.charge(triples_.bytes() - before);
  runtime_.guard.answerRows(triples_.size());
}

void GraphResult::construct(const Batch& batch) {
  runtime_.guard.requireRoomFor(triples_.growthFor(batch.rows * query_.construct_template.size()));
  for (std::size_t row = 0; row < batch.rows; ++row) {
    std::map<std::string, ValueId> blanks;
    for (const ast::TriplePattern& pattern : query_.construct_template) {
      add(idOf(pattern.subject, batch, row, blanks), idOf(pattern.predicate, batch, row, blanks),
          idOf(pattern.object, batch, row, blanks));
    }
  }
}

void GraphResult::describe(const Batch& batch) {
  std::map<std::string, ValueId> none;
  for (std::size_t row = 0; row < batch.rows; ++row) {
    for (const ast::PatternTerm& named : query_.describe) {
      const ValueId id = idOf(named, batch, row, none);
      if (id != kUnbound && noted_.insert(id)) resources_.push_back(id);
    }
  }
}

void GraphResult::finish() {
  // Blank nodes found during the loop are appended to the list and described too.
  for (std::size_t i = 0; i < resources_.size(); ++i) describeNode(resources_[i]);
}

void GraphResult::describeNode(ValueId node) {
  if (node >= kFirstComputed) return;
  rdf::PrefixLookup lookup = runtime_.reader.lookup(rdf::QuadOrder::Spog);
  const std::array<rdf::TermId, 1> prefix = {node};
  for (auto block = lookup.find(prefix); !block.empty(); block = lookup.more()) {
    runtime_.guard.work(block.size());
    for (const rdf::QuadKey& key : block) {
      if (!runtime_.dataset.default_graph.admits(key.at(3))) continue;
      add(key.at(0), key.at(1), key.at(2));
      const ValueId object = key.at(2);
      if (runtime_.reader.valueOf(object).kind == TermKind::BlankNode && noted_.insert(object))
        resources_.push_back(object);
    }
  }
}

void GraphResult::write(ResultSink& sink) const {
  constexpr std::size_t kBytesOfTriple = 256;
  for (std::size_t i = 0; i < triples_.size(); ++i) {
    const ValueId* triple = triples_.row(i);
    runtime_.guard.spend(kBytesOfTriple);
    sink.triple(runtime_.terms.view(triple[0]), runtime_.terms.view(triple[1]), runtime_.terms.view(triple[2]));
  }
}

}  // namespace cluxel::sparql
