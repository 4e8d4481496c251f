// SPDX-License-Identifier: Apache-2.0
// Look-ups in the catalogue of classes.
#include "rules/language/class_catalogue.hpp"

#include <algorithm>
#include <set>

#include "rdf/ontology/ontology.hpp"

namespace cluxel::rules {

namespace {

/// `iri` and all of its superclasses.
std::set<std::string> lineage(const ClassCatalogue& catalogue, std::string_view iri) {
  std::set<std::string> seen;
  std::vector<std::string> open{std::string(iri)};
  while (!open.empty()) {
    const std::string next = std::move(open.back());
    open.pop_back();
    if (!seen.insert(next).second) continue;
    if (const ClassEntry* entry = catalogue.find(next))
      open.insert(open.end(), entry->superclasses.begin(), entry->superclasses.end());
  }
  return seen;
}

}  // namespace

const ClassEntry* ClassCatalogue::find(std::string_view iri) const {
  const auto found =
      std::find_if(classes.begin(), classes.end(), [&](const ClassEntry& entry) { return entry.iri == iri; });
  return found == classes.end() ? nullptr : &*found;
}

bool ClassCatalogue::isA(std::string_view iri, std::string_view ancestor) const {
  return iri == ancestor || lineage(*this, iri).count(std::string(ancestor)) > 0;
}

std::vector<std::string> ClassCatalogue::partsOf(std::string_view iri) const {
  std::set<std::string> parts;
  for (const std::string& name : lineage(*this, iri))
    if (const ClassEntry* entry = find(name)) parts.insert(entry->parts.begin(), entry->parts.end());
  return {parts.begin(), parts.end()};
}

bool haveSameClasses(ClassCatalogue a, ClassCatalogue b) {
  for (ClassCatalogue* catalogue : {&a, &b}) {
    for (ClassEntry& entry : catalogue->classes) {
      std::sort(entry.superclasses.begin(), entry.superclasses.end());
      std::sort(entry.parts.begin(), entry.parts.end());
    }
    std::sort(catalogue->classes.begin(), catalogue->classes.end());
  }
  return a.classes == b.classes;
}

rdf::ClassNames namesOf(const ClassCatalogue& catalogue) {
  rdf::ClassNames names;
  for (const ClassEntry& entry : catalogue.classes) names.add(entry.iri);
  return names;
}

ClassCatalogue catalogueOf(const rdf::OntologyView& ontology) {
  ClassCatalogue catalogue;
  for (const rdf::OntologyClass& known : ontology.classes)
    catalogue.classes.push_back({known.iri, known.superclasses, known.parts});
  return catalogue;
}

}  // namespace cluxel::rules
