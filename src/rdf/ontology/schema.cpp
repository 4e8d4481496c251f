// SPDX-License-Identifier: Apache-2.0
// Reads the axioms from the facts.
#include "rdf/ontology/schema.hpp"

#include <algorithm>

#include "rdf/vocabulary.hpp"

namespace cluxel::rdf {

SchemaWords::SchemaWords(const QuadReader& reader) {
  const auto id = [&](const std::string& iri) { return reader.idOf(Term::iri(iri)).value_or(kNoTerm); };
  const std::string owl(vocabulary::kOwl);
  type = id(vocabulary::rdf("type"));
  sub_class = id(vocabulary::rdfs("subClassOf"));
  sub_property = id(vocabulary::rdfs("subPropertyOf"));
  inverse = id(owl + "inverseOf");
  symmetric = id(owl + "SymmetricProperty");
  transitive = id(owl + "TransitiveProperty");
}

bool SchemaWords::isReserved(TermId property) const {
  return property != kNoTerm &&
         (property == type || property == sub_class || property == sub_property || property == inverse);
}

bool SchemaWords::isAxiom(TermId property, TermId object) const {
  if (property == kNoTerm || property != type) return isReserved(property);
  return object != kNoTerm && (object == symmetric || object == transitive);
}

std::set<TermId> reachableFrom(TermId node, const Edges& edges, TermId property, ClosureBounds& bounds) {
  std::set<TermId> reached;
  std::vector<TermId> open = {node};
  while (!open.empty()) {
    const auto next = edges.find(open.back());
    open.pop_back();
    if (next == edges.end()) continue;
    for (const TermId target : next->second) {
      bounds.addStep(property);
      if (reached.insert(target).second) open.push_back(target);
    }
  }
  return reached;
}

namespace {

using DirectImplications = std::map<TermId, std::set<Implied>>;

std::set<Implied> allImplied(TermId property, const DirectImplications& direct, ClosureBounds& bounds) {
  std::set<Implied> reached;
  std::vector<Implied> open(direct.at(property).begin(), direct.at(property).end());
  while (!open.empty()) {
    const Implied next = open.back();
    open.pop_back();
    bounds.addStep(property);
    if (!reached.insert(next).second) continue;
    const auto further = direct.find(next.property);
    if (further == direct.end()) continue;
    for (const Implied& step : further->second)
      open.push_back({step.property, step.inverted != next.inverted, step.via_inverse || next.via_inverse});
  }
  reached.erase({property, false, false});
  return reached;
}

/// The axioms on properties. Those about reserved properties are set aside in `schema.ignored`.
DirectImplications readAxioms(const FactScan& scan, const SchemaWords& words, Schema& schema) {
  DirectImplications direct;
  const auto heeded = [&](TermId subject, TermId predicate, TermId object) {
    if (!words.isReserved(subject) && (predicate == words.type || !words.isReserved(object))) return true;
    schema.ignored.insert({subject, predicate, object});
    return false;
  };
  scan(words.sub_property, kNoTerm, [&](TermId sub, TermId super) {
    if (sub != super && heeded(sub, words.sub_property, super)) direct[sub].insert({super, false, false});
  });
  scan(words.inverse, kNoTerm, [&](TermId one, TermId other) {
    if (!heeded(one, words.inverse, other)) return;
    direct[one].insert({other, true, true});
    direct[other].insert({one, true, true});
  });
  for (const TermId kind : {words.symmetric, words.transitive}) {
    if (kind == kNoTerm) continue;
    scan(words.type, kind, [&](TermId property, TermId) {
      if (!heeded(property, words.type, kind)) return;
      if (kind == words.symmetric) direct[property].insert({property, true, true});
      if (kind == words.transitive) schema.transitive.insert(property);
    });
  }
  return direct;
}

}  // namespace

Schema readSchema(const QuadReader& reader, const SchemaWords& words, const FactScan& scan, ClosureBounds& bounds) {
  Schema schema;
  const DirectImplications direct = readAxioms(scan, words, schema);
  for (const TermId property : {words.sub_class, words.sub_property})
    if (property != kNoTerm) schema.transitive.insert(property);
  // A blank node such as [ owl:inverseOf p ] takes part in the schema, but cannot be the predicate of a fact.
  const auto is_no_predicate = [&](const Implied& implied) {
    return reader.valueOf(implied.property).kind != TermKind::Iri;
  };
  for (const auto& [property, first] : direct)
    std::erase_if(schema.implications.emplace(property, allImplied(property, direct, bounds)).first->second,
                  is_no_predicate);
  Edges above;
  scan(words.sub_class, kNoTerm, [&](TermId kind, TermId super) { above[kind].insert(super); });
  for (const auto& [kind, direct_ones] : above)
    schema.ancestors.emplace(kind, reachableFrom(kind, above, words.sub_class, bounds));
  return schema;
}

std::vector<std::string> ignoredAxioms(const QuadReader& reader, const Schema& schema) {
  std::vector<std::string> axioms;
  for (const auto& [subject, predicate, object] : schema.ignored)
    axioms.push_back(toNTriples(reader.termOf(subject)) + ' ' + toNTriples(reader.termOf(predicate)) + ' ' +
                     toNTriples(reader.termOf(object)));
  std::sort(axioms.begin(), axioms.end());
  return axioms;
}

}  // namespace cluxel::rdf
