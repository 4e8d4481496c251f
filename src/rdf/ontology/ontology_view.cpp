// SPDX-License-Identifier: Apache-2.0
// Reads classes and properties from an ontology graph.
#include <algorithm>
#include <set>
#include <utility>

#include "rdf/iri.hpp"
#include "rdf/ontology/ontology.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::rdf {

namespace {

using namespace vocabulary;

void sortUnique(std::vector<std::string>& names) {
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
}

/// The statements of one graph, accessed by IRI.
class GraphReader {
 public:
  GraphReader(const QuadReader& reader, std::string_view graph) : reader_(reader), graph_(idOf(graph)) {}

  std::vector<Term> objects(std::string_view subject, const std::string& property) const {
    std::vector<Term> found;
    const auto s = idOf(subject);
    const auto p = idOf(property);
    if (!s || !p || !graph_) return found;
    QuadCursor cursor = reader_.scan({.s = *s, .p = *p, .o = {}, .g = *graph_}, QuadOrder::Spog);
    for (QuadIds quad; cursor.next(quad);) found.push_back(reader_.termOf(quad.o));
    std::sort(found.begin(), found.end());
    return found;
  }

  std::vector<std::string> subjects(const std::string& property, std::string_view object) const {
    std::vector<std::string> found;
    const auto p = idOf(property);
    const auto o = idOf(object);
    if (!p || !o || !graph_) return found;
    QuadCursor cursor = reader_.scan({.s = {}, .p = *p, .o = *o, .g = *graph_}, QuadOrder::Posg);
    for (QuadIds quad; cursor.next(quad);) addIri(reader_.termOf(quad.s), found);
    sortUnique(found);
    return found;
  }

  std::vector<std::string> iris(std::string_view subject, const std::string& property) const {
    std::vector<std::string> found;
    for (const Term& object : objects(subject, property)) addIri(object, found);
    return found;
  }

  double number(std::string_view subject, const std::string& property) const {
    for (const Term& object : objects(subject, property))
      if (const auto id = reader_.idOf(object)) return reader_.valueOf(*id).number;
    return 0;
  }

  /// The literal in a language, else the one without a language tag.
  std::string text(std::string_view subject, const std::string& property, std::string_view language) const {
    std::string plain;
    for (const Term& object : objects(subject, property)) {
      if (object.language == language) return object.text;
      if (object.language.empty() && object.kind == TermKind::Literal) plain = object.text;
    }
    return plain;
  }

 private:
  std::optional<TermId> idOf(std::string_view iri) const { return reader_.idOf(Term::iri(iri)); }
  static void addIri(const Term& term, std::vector<std::string>& found) {
    if (term.kind == TermKind::Iri) found.push_back(term.text);
  }

  const QuadReader& reader_;
  std::optional<TermId> graph_;
};

Mobility mobilityOf(const std::vector<std::string>& iris) {
  for (const std::string& iri : iris) {
    if (iri == clx("Static")) return Mobility::Static;
    if (iri == clx("Movable")) return Mobility::Movable;
  }
  return Mobility::Unknown;
}

void readPlaces(const GraphReader& graph, OntologyClass& entry) {
  for (const std::string& place : graph.subjects(clx("usualFor"), entry.iri))
    for (const std::string& near : graph.iris(place, clx("nearClass")))
      entry.places.push_back({near, graph.number(place, clx("within")), graph.number(place, clx("probability"))});
  std::sort(entry.places.begin(), entry.places.end(), [](const UsualPlace& a, const UsualPlace& b) {
    return a.probability != b.probability ? a.probability > b.probability : a < b;
  });
}

OntologyClass readClass(const GraphReader& graph, const std::string& iri) {
  OntologyClass entry;
  entry.iri = iri;
  const std::pair<LabelKind, std::string> label_properties[] = {
      {LabelKind::Preferred, std::string(kSkos) + "prefLabel"},
      {LabelKind::Plain, rdfs("label")},
      {LabelKind::Alternative, std::string(kSkos) + "altLabel"}};
  for (const auto& [kind, property] : label_properties)
    for (const Term& label : graph.objects(iri, property))
      if (label.kind == TermKind::Literal) entry.labels.push_back({label.language, kind, label.text});
  std::sort(entry.labels.begin(), entry.labels.end());
  entry.comment = graph.text(iri, rdfs("comment"), "en");
  for (const Term& color : graph.objects(iri, clx("color"))) entry.color = color.text;
  entry.mobility = mobilityOf(graph.iris(iri, clx("mobility")));
  entry.superclasses = graph.iris(iri, rdfs("subClassOf"));
  entry.parts = graph.iris(iri, clx("mayHavePart"));
  sortUnique(entry.superclasses);
  readPlaces(graph, entry);
  return entry;
}

/// Inherits properties from ancestors, nearest first.
void inherit(OntologyClass& entry, const OntologyView& own) {
  std::set<std::string> seen = {entry.iri};
  std::vector<std::string> level = entry.superclasses;
  while (!level.empty()) {
    std::vector<std::string> next;
    for (const std::string& iri : level) {
      if (!seen.insert(iri).second) continue;
      entry.ancestors.push_back(iri);
      const OntologyClass* above = own.find(iri);
      if (above == nullptr) continue;
      if (entry.color.empty()) entry.color = above->color;
      if (entry.mobility == Mobility::Unknown) entry.mobility = above->mobility;
      entry.parts.insert(entry.parts.end(), above->parts.begin(), above->parts.end());
      next.insert(next.end(), above->superclasses.begin(), above->superclasses.end());
    }
    sortUnique(next);
    level = std::move(next);
  }
  sortUnique(entry.ancestors);
  sortUnique(entry.parts);
}

std::vector<std::string> classIris(const GraphReader& graph) {
  std::vector<std::string> iris = graph.subjects(rdf("type"), std::string(kOwl) + "Class");
  const std::vector<std::string> rdfs_classes = graph.subjects(rdf("type"), rdfs("Class"));
  iris.insert(iris.end(), rdfs_classes.begin(), rdfs_classes.end());
  sortUnique(iris);
  return iris;
}

std::vector<OntologyProperty> readProperties(const GraphReader& graph) {
  std::vector<std::string> iris;
  for (const std::string& kind :
       {rdf("Property"), std::string(kOwl) + "ObjectProperty", std::string(kOwl) + "DatatypeProperty"})
    for (std::string& iri : graph.subjects(rdf("type"), kind)) iris.push_back(std::move(iri));
  sortUnique(iris);
  std::vector<OntologyProperty> properties;
  properties.reserve(iris.size());
  for (const std::string& iri : iris)
    properties.push_back({iri, graph.text(iri, rdfs("label"), "en"), graph.text(iri, rdfs("comment"), "en"),
                          graph.text(iri, clx("unit"), "en")});
  return properties;
}

}  // namespace

std::string OntologyClass::label(std::string_view language) const {
  for (const std::string_view tag : {language, std::string_view("en"), std::string_view("")})
    for (const ClassLabel& label : labels)
      if (label.language == tag && label.kind != LabelKind::Alternative) return label.text;
  const std::string local = localName(iri);
  return local.empty() ? iri : local;
}

const OntologyClass* OntologyView::find(std::string_view iri) const {
  const auto found =
      std::lower_bound(classes.begin(), classes.end(), iri,
                       [](const OntologyClass& entry, std::string_view name) { return entry.iri < name; });
  return found != classes.end() && found->iri == iri ? &*found : nullptr;
}

bool OntologyView::isA(std::string_view iri, std::string_view ancestor) const {
  if (iri == ancestor) return true;
  const OntologyClass* entry = find(iri);
  return entry != nullptr && std::binary_search(entry->ancestors.begin(), entry->ancestors.end(), ancestor);
}

std::vector<std::string> OntologyView::classNames() const {
  std::vector<std::string> names;
  for (const OntologyClass& entry : classes) names.push_back(entry.iri);
  return names;
}

std::vector<std::string> classIrisOf(const QuadReader& reader, std::string_view graph) {
  return classIris(GraphReader(reader, graph.empty() ? kGraphOntology : graph));
}

OntologyView ontologyViewOf(const QuadReader& reader, std::string_view graph_iri) {
  const GraphReader graph(reader, graph_iri.empty() ? kGraphOntology : graph_iri);
  OntologyView own;
  for (const std::string& iri : classIris(graph)) own.classes.push_back(readClass(graph, iri));
  OntologyView view = own;
  for (OntologyClass& entry : view.classes) inherit(entry, own);
  view.properties = readProperties(graph);
  return view;
}

OntologyView ontologyViewOf(std::span<const RdfSource> sources) {
  const auto environment = Environment::temporary();
  WriteTransaction transaction = environment->write();
  QuadWriter writer(transaction);
  loadOntology(sources, writer);
  writer.flush();
  return ontologyViewOf(QuadReader(transaction));
}

}  // namespace cluxel::rdf
