// SPDX-License-Identifier: Apache-2.0
// Which class a written name means: one answer for all commands.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>

#include "mapping/map_reader.hpp"
#include "rdf/ontology/ontology.hpp"

namespace cluxel::tasks {

/// A name that no other class shares, to make names of rules and places from: the local name of a class of the clx
/// namespace; of others with digits of the IRI's hash ("Tree-1a2b3c4d"), the same in every map.
std::string distinctName(const std::string& class_iri);

/// The namespaces of prefixes. Files may give one prefix different namespaces.
using Namespaces = std::multimap<std::string, std::string, std::less<>>;

/// The IRI of a class. An IRI, also between < and >, and a name with a prefix ("clx:StreetSign") mean that class alone.
/// A local name ("StreetSign") means the class of the clx namespace, else the only class that has it. Other words are
/// the label of one class in some language ("street sign"; one as it is written has the first right, then one whatever
/// its case), then a local name whatever its case, that of the clx namespace first. `namespaces` is asked when there is
/// a prefix other than clx. Throws Error (NotFound) for an unknown class, and for a name of several; lists those.
std::string classNamed(const rdf::OntologyView& ontology, const std::string& written,
                       const std::function<Namespaces()>& namespaces = {});
/// The same with the prefixes of the map's ontology and rules. `ontology`: that of the map.
std::string classNamed(const mapping::MapReader& map, const rdf::OntologyView& ontology, const std::string& written);
std::string classNamed(const mapping::MapReader& map, const std::string& written);

/// "clx:Movable", "movable", "Static": a mobility is written as a class is. A class that has the word as a label goes
/// first; then nothing is returned.
std::optional<rdf::Mobility> mobilityNamed(const rdf::OntologyView& ontology, const std::string& written);

/// For a class of which no object of the map is. Throws Error (InvalidArgument) when none can be: it is not below
/// clx:Object, and neither is a class below it, as of ways, parts and places.
void requireClassOfObjects(const rdf::OntologyView& ontology, const std::string& class_iri);
/// The same, unless an object of the map is of the class.
void requireClassOfObjects(const mapping::MapReader& map, const rdf::OntologyView& ontology,
                           const std::string& class_iri);

/// The prefixes that the map's ontology and rules declare. Cost: that of parsing both.
Namespaces namespacesOf(const mapping::MapInputs& inputs);

}  // namespace cluxel::tasks
