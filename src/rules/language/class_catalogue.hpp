// SPDX-License-Identifier: Apache-2.0
// What rules may name: the classes of the ontology with their superclasses and parts.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "rdf/ontology/class_names.hpp"

namespace cluxel::rdf {
struct OntologyView;
}

namespace cluxel::rules {

/// One class of the ontology. All names are IRIs.
struct ClassEntry {
  std::string iri;
  std::vector<std::string> superclasses;  ///< direct ones
  std::vector<std::string> parts;         ///< classes its parts may have; superclasses' parts count too
  auto operator<=>(const ClassEntry&) const = default;
};

/// The known classes, in any order.
struct ClassCatalogue {
  std::vector<ClassEntry> classes;

  const ClassEntry* find(std::string_view iri) const;
  /// True when `iri` is `ancestor` or below it. Cycles are harmless.
  bool isA(std::string_view iri, std::string_view ancestor) const;
  /// The part classes of `iri` and of its superclasses, sorted.
  std::vector<std::string> partsOf(std::string_view iri) const;
};

/// Whether two catalogues have the same classes with the same superclasses and parts, in whatever order.
bool haveSameClasses(ClassCatalogue a, ClassCatalogue b);

/// What the classes are called in lists.
rdf::ClassNames namesOf(const ClassCatalogue& catalogue);

/// The classes of an ontology as rules see them.
ClassCatalogue catalogueOf(const rdf::OntologyView& ontology);

}  // namespace cluxel::rules
