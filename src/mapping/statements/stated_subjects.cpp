// SPDX-License-Identifier: Apache-2.0
// Object names change with their members; points do not.
#include "mapping/statements/stated_subjects.hpp"

#include <set>

#include "cluxel/error.hpp"
#include "mapping/build/operator_statements.hpp"
#include "mapping/change/map_things.hpp"
#include "mapping/change/statement_change.hpp"
#include "mapping/layers/stored_layers.hpp"
#include "mapping/statements/stated_values.hpp"
#include "rdf/map_iris.hpp"

namespace cluxel::mapping {

namespace {

/// The present object that an IRI means.
class StatedObjects {
 public:
  StatedObjects(const rdf::ReadTransaction& transaction, const ParsedInputs& parsed)
      : transaction_(transaction),
        stages_(parsed.model, parsed.inputs.params),
        lineage_(rdf::QuadReader(transaction), storedObjectIds(transaction)) {}

  /// Of a class-wide object its class, else the points of an object. Absent when the IRI means none.
  struct Anchor {
    PointAnchor points;
    std::string class_iri;
  };
  std::optional<Anchor> anchorOfIri(const std::string& iri) {
    const std::optional<ContentHash> object = objectOf(iri);
    if (!object) return std::nullopt;
    const auto record = storedRecord(transaction_, *object);
    if (record && record->is_class_wide) return Anchor{{}, record->class_iri};
    return Anchor{anchorOfStored(transaction_, stages_, *object), {}};
  }

 private:
  std::optional<ContentHash> objectOf(const std::string& iri) const {
    const std::optional<ContentHash> object = hashIn(iri, "object");
    if (object && storedRecord(transaction_, *object)) return object;
    const auto former = lineage_.find(iri);
    return former ? std::optional(former->object) : std::nullopt;
  }

  const rdf::ReadTransaction& transaction_;
  TileStages stages_;
  Lineage lineage_;
};

Statement statementOf(const Quad& quad, StatedObjects::Anchor anchor, const rules::ClassCatalogue& classes) {
  const bool is_type = quad.predicate.text == rdf::vocabulary::rdf("type");
  if (is_type && quad.object.kind != TermKind::Iri)
    throw Error(ErrorKind::NotFound, "the map's ontology knows no class " + toNTriples(quad.object));
  Statement statement{is_type ? StatementKind::Is : StatementKind::Fact,
                      is_type ? "" : quad.predicate.text,
                      quad.object,
                      std::move(anchor.points),
                      {},
                      std::move(anchor.class_iri)};
  requireStatable(statement, classes);
  return statement;
}

}  // namespace

bool namesObject(const Term& subject) {
  return subject.kind == TermKind::Iri &&
         (subject.text.starts_with(rdf::mapIri("object", "")) || subject.text.starts_with(rdf::mapIri("thing", "")));
}

void anchorStatedObjects(rdf::WriteTransaction& transaction, const ParsedInputs& parsed, ProgressSink& sink) {
  std::vector<Quad> about_objects;
  for (Quad& quad : operatorStatements(rdf::QuadReader(static_cast<const rdf::ReadTransaction&>(transaction))))
    if (namesObject(quad.subject)) about_objects.push_back(std::move(quad));
  if (about_objects.empty()) return;
  StatedObjects objects(transaction, parsed);
  rdf::QuadWriter writer(transaction);
  std::size_t anchored = 0;
  std::set<std::string> unknown;
  for (const Quad& quad : about_objects) {
    auto anchor = objects.anchorOfIri(quad.subject.text);
    if (!anchor) {
      unknown.insert(quad.subject.text);
      continue;
    }
    const Statement statement = statementOf(quad, *std::move(anchor), parsed.rules.catalogue);
    if (statement.kind == StatementKind::Is && !statement.class_iri.empty())
      throw Error(ErrorKind::InvalidArgument,
                  "<" + quad.subject.text +
                      "> is one object over all of the map: another class would change all of it; state other "
                      "properties");
    writer.remove(rdf::QuadIds{writer.intern(quad.subject), writer.intern(quad.predicate), writer.intern(quad.object),
                               writer.intern(quad.graph)});
    for (const Quad& stated : quadsOf(statement)) writer.add(stated);
    ++anchored;
  }
  writer.flush();
  if (!unknown.empty())
    sink.note(*unknown.begin() +
              (unknown.size() > 1 ? " and " + std::to_string(unknown.size() - 1) + " more are" : " is") +
              " no object that this map has or had: what is stated of it changes no object, but queries find it");
  if (anchored > 0) sink.note(std::to_string(anchored) + " statements about objects are anchored to their points");
}

NewStatements newStatements(const rdf::ReadTransaction& transaction) {
  const rdf::QuadReader reader(transaction);
  std::set<std::string> told, stated;
  const auto effect = reader.idOf(Term::iri(rdf::vocabulary::clx("statementEffect")));
  const auto observed = reader.idOf(Term::iri(rdf::vocabulary::kGraphObserved));
  if (effect && observed) {
    rdf::QuadCursor cursor = reader.scan({.s = {}, .p = *effect, .o = {}, .g = *observed});
    for (rdf::QuadIds quad; cursor.next(quad);) told.insert(reader.termOf(quad.s).text);
  }
  NewStatements news;
  for (Statement& statement : storedStatements(reader)) {
    const std::string iri = rdf::iriOfStatement(statement.id());
    stated.insert(iri);
    if (!told.contains(iri)) news.made.push_back(std::move(statement));
  }
  for (const std::string& iri : told)
    if (!stated.contains(iri)) news.withdrawn.push_back(ContentHash::fromHex(iri.substr(iri.rfind('/') + 1)));
  return news;
}

}  // namespace cluxel::mapping
