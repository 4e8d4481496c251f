// SPDX-License-Identifier: Apache-2.0
// The whole inference, and the choice between it and the change.
#include "mapping/inference/infer_facts.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#include "base/free_memory.hpp"
#include "mapping/inference/inference_graphs.hpp"
#include "mapping/inference/sparql_rules.hpp"
#include "rdf/io/rdf_io.hpp"
#include "rdf/ontology/ontology.hpp"
#include "rdf/ontology/unused_axioms.hpp"

namespace cluxel::mapping {

void noteIgnoredAxioms(const std::vector<std::string>& axioms, ProgressSink& sink) {
  for (const std::string& axiom : axioms)
    sink.note("warning: nothing is inferred from " + axiom +
              ": rdf:type, rdfs:subClassOf, rdfs:subPropertyOf and owl:inverseOf keep their meaning; remove the "
              "statement, or use properties of your own");
}

namespace {

std::string_view insteadOf(const std::string& axiom) {
  if (axiom == "owl:equivalentClass") return "rdfs:subClassOf for each class that is below another";
  if (axiom == "owl:disjointUnionOf")
    return "rdfs:subClassOf for each class that is below another, and owl:disjointWith for each two that exclude each "
           "other";
  // Of owl:AllDisjointClasses, owl:AllDisjointProperties and owl:AllDifferent.
  if (axiom == "owl:members") return "owl:disjointWith for each two classes that exclude each other";
  return "what should follow as rdfs:subClassOf, rdfs:subPropertyOf or a SPARQL rule";
}

}  // namespace

void noteUnusedAxioms(const std::vector<NamedText>& ontology, ProgressSink& sink) {
  for (const auto& [name, count] : rdf::unusedAxioms(ontologySources(ontology))) {
    sink.note("warning: nothing is inferred from " + name + " (" + std::to_string(count) +
              (count == 1 ? " statement" : " statements") + " of the ontology); write " + std::string(insteadOf(name)));
  }
}

void noteSharedLabels(const rdf::OntologyView& ontology, ProgressSink& sink) {
  for (const Diagnostic& warning : sharedLabels(ontology)) sink.note(format(warning));
}

std::vector<WholeRule> inferAnew(rdf::WriteTransaction& transaction, const std::vector<NamedText>& rules,
                                 ProgressSink& sink, const rdf::InferenceCheck& check) {
  noteIgnoredAxioms(inferClosure(transaction, check).ignored, sink);
  returnFreeMemory();  // the closure of a large map takes hundreds of megabytes
  InferenceRecord record = runSparqlRules(transaction, rules, check);
  const rdf::QuadReader reader{static_cast<const rdf::ReadTransaction&>(transaction)};
  if (!InferenceGraphs(reader).are_all && record.reason.empty()) {
    record.outputs.assign(rules.size(), {});
    record.late.clear();
    record.reason = "the map has a graph that no part of Cluxel writes";
  }
  storeInferenceRecord(transaction, record, rules);
  restartJournal(transaction);
  return std::move(record.whole);
}

std::vector<WholeRule> inferAll(rdf::WriteTransaction& transaction, const std::vector<NamedText>& rules,
                                ProgressSink& sink, const rdf::InferenceCheck& check) {
  if (auto whole = inferChanges(transaction, rules, sink, check)) return *std::move(whole);
  return inferAnew(transaction, rules, sink, check);
}

}  // namespace cluxel::mapping
