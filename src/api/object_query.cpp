// SPDX-License-Identifier: Apache-2.0
// Two queries to the observed graph: objects, and their parts.
#include "api/object_query.hpp"

#include <algorithm>
#include <map>

#include "api/answer_data.hpp"
#include "rdf/iri.hpp"
#include "rdf/map_iris.hpp"
#include "rdf/vocabulary.hpp"
#include "sparql/query_engine.hpp"
#include "tasks/named_class.hpp"
#include "tasks/objects_of_class.hpp"

namespace cluxel {

namespace {

constexpr const char* kExtentPattern =
    " a ?class ; clx:x ?x ; clx:y ?y ; clx:z ?z ; clx:minX ?minX ; clx:minY ?minY ; clx:minZ ?minZ ; clx:maxX ?maxX ; "
    "clx:maxY ?maxY ; clx:maxZ ?maxZ ; clx:length ?length ; clx:width ?width ; clx:height ?height ; "
    "clx:bottom ?bottom ; clx:top ?top ; clx:pointCount ?pointCount . ";

Answer answerOf(const rdf::QuadReader& reader, const std::string& pattern, const std::string& order) {
  const std::string text = "PREFIX clx: <" + std::string(rdf::vocabulary::kClx) + "> SELECT * { GRAPH <" +
                           std::string(rdf::vocabulary::kGraphObserved) + "> { " + pattern + "} } ORDER BY " + order;
  sparql::QueryOptions options;
  options.budget.max_memory_bytes = 0;
  return Answer::Data::answer({sparql::evaluateQuery(reader, text, options), {}});
}

Extent extentOf(const Answer::Row& row) {
  Extent extent;
  extent.centroid = {row.number("x"), row.number("y"), row.number("z")};
  extent.min = {row.number("minX"), row.number("minY"), row.number("minZ")};
  extent.max = {row.number("maxX"), row.number("maxY"), row.number("maxZ")};
  extent.length_m = row.number("length");
  extent.width_m = row.number("width");
  extent.height_m = row.number("height");
  extent.bottom_m = row.number("bottom");
  extent.top_m = row.number("top");
  extent.point_count = static_cast<std::uint64_t>(row.number("pointCount"));
  return extent;
}

std::optional<std::string> timeOf(const Answer::Row& row, std::string_view variable) {
  const Term* term = row.find(variable);
  return term == nullptr ? std::nullopt : std::optional(term->text);
}

std::string labelOf(const rdf::OntologyView& ontology, const std::string& class_iri) {
  const rdf::OntologyClass* found = ontology.find(class_iri);
  return found == nullptr ? rdf::localName(class_iri) : found->label();
}

std::map<std::string, std::vector<ObjectPart>> partsByObject(const rdf::QuadReader& reader,
                                                             const rdf::OntologyView& ontology) {
  std::map<std::string, std::vector<ObjectPart>> parts;
  for (const Answer::Row row :
       answerOf(reader, "?o clx:hasPart ?part . ?part" + std::string(kExtentPattern), "?part")) {
    ObjectPart part;
    static_cast<Extent&>(part) = extentOf(row);
    part.iri = row.text("part");
    part.class_iri = row.text("class");
    part.label = labelOf(ontology, part.class_iri);
    parts[row.text("o")].push_back(std::move(part));
  }
  return parts;
}

std::vector<Object> objectsOf(const rdf::QuadReader& reader, const rdf::OntologyView& ontology) {
  auto parts = partsByObject(reader, ontology);
  std::vector<Object> objects;
  for (const Answer::Row row : answerOf(reader,
                                        "?o clx:confidence ?confidence ; clx:rule ?rule ; clx:heading ?heading . ?o" +
                                            std::string(kExtentPattern) +
                                            "OPTIONAL { ?o clx:firstSeen ?firstSeen ; clx:lastSeen ?lastSeen } "
                                            "OPTIONAL { ?o clx:seenThrough ?seenThrough } ",
                                        "?o")) {
    Object object;
    static_cast<Extent&>(object) = extentOf(row);
    object.number = objects.size();
    object.iri = row.text("o");
    object.class_iri = row.text("class");
    object.label = labelOf(ontology, object.class_iri);
    object.confidence = row.number("confidence");
    object.rule = row.text("rule");
    object.heading_rad = row.number("heading");
    object.first_seen = timeOf(row, "firstSeen"), object.last_seen = timeOf(row, "lastSeen");
    object.seen_through = timeOf(row, "seenThrough");
    if (const auto found = parts.find(object.iri); found != parts.end()) object.parts = std::move(found->second);
    objects.push_back(std::move(object));
  }
  return objects;
}

}  // namespace

std::vector<Object> objectsOf(const rdf::QuadReader& reader) {
  return objectsOf(reader, ontologyViewOf(reader));
}

std::vector<Object> objectsOf(const rdf::QuadReader& reader, std::string_view class_name,
                              const std::function<tasks::Namespaces()>& namespaces) {
  const rdf::OntologyView ontology = ontologyViewOf(reader);
  const std::string class_iri = tasks::classNamed(ontology, std::string(class_name), namespaces);
  const std::vector<Object> all = objectsOf(reader, ontology);
  std::vector<Object> objects;
  for (const Object* object : objectsOfClass(all, reader, class_iri)) objects.push_back(*object);
  if (objects.empty()) tasks::requireClassOfObjects(ontology, class_iri);
  return objects;
}

std::vector<const Object*> objectsOfClass(const std::vector<Object>& objects, const rdf::QuadReader& reader,
                                          const std::string& class_iri) {
  std::vector<const Object*> found;
  for (const ContentHash& id : tasks::objectsOfClass(reader, class_iri)) {
    const std::string iri = rdf::iriOfObject(id);
    const auto place = std::lower_bound(objects.begin(), objects.end(), iri,
                                        [](const Object& object, const auto& name) { return object.iri < name; });
    if (place != objects.end() && place->iri == iri) found.push_back(&*place);
  }
  return found;
}

}  // namespace cluxel
