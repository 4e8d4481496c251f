// SPDX-License-Identifier: Apache-2.0
// The whole inference, and the choice between it and the change.
#include "mapping/inference/infer_facts.hpp"

#include <algorithm>

#include "mapping/inference/inference_graphs.hpp"
#include "mapping/inference/sparql_rules.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::mapping {

void noteIgnoredAxioms(const std::vector<std::string>& axioms, ProgressSink& sink) {
  for (const std::string& axiom : axioms)
    sink.note("warning: nothing is inferred from " + axiom +
              ": rdf:type, rdfs:subClassOf, rdfs:subPropertyOf and owl:inverseOf keep their meaning; remove the "
              "statement, or use properties of your own");
}

void inferAnew(rdf::WriteTransaction& transaction, const std::vector<NamedText>& rules, ProgressSink& sink,
               const rdf::InferenceCheck& check) {
  noteIgnoredAxioms(inferClosure(transaction, check).ignored, sink);
  InferenceRecord record = runSparqlRules(transaction, rules, check);
  const rdf::QuadReader reader{static_cast<const rdf::ReadTransaction&>(transaction)};
  if (!InferenceGraphs(reader).are_all && record.reason.empty()) {
    record = {};
    record.outputs.resize(rules.size());
    record.reason = "the map has a graph that no part of Cluxel writes";
  }
  storeInferenceRecord(transaction, record, rules);
  restartJournal(transaction);
}

void inferAll(rdf::WriteTransaction& transaction, const std::vector<NamedText>& rules, ProgressSink& sink,
              const rdf::InferenceCheck& check) {
  if (!inferChanges(transaction, rules, sink, check)) inferAnew(transaction, rules, sink, check);
}

}  // namespace cluxel::mapping
