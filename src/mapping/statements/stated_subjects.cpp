// SPDX-License-Identifier: Apache-2.0
// Object names change with their members; points do not.
#include "mapping/statements/stated_subjects.hpp"

#include <map>
#include <optional>
#include <set>
#include <utility>

#include "cluxel/error.hpp"
#include "mapping/change/statement_change.hpp"
#include "mapping/layers/stored_layers.hpp"
#include "mapping/statements/known_objects.hpp"
#include "mapping/statements/named_resources.hpp"
#include "mapping/statements/refused_quad.hpp"
#include "mapping/statements/stated_values.hpp"
#include "rdf/map_iris.hpp"

namespace cluxel::mapping {

namespace {

/// What a statement about such an object is anchored to.
class StatedObjects {
 public:
  StatedObjects(const rdf::ReadTransaction& transaction, const ParsedInputs& parsed)
      : transaction_(transaction), stages_(parsed.model, parsed.inputs.params), known_(transaction) {}

  /// Of a class-wide object its class, else the points of an object. Absent when the IRI means none.
  struct Anchor {
    PointAnchor points;
    std::string class_iri;
  };
  std::optional<Anchor> anchorOfIri(const std::string& iri) {
    const std::optional<ContentHash> object = known_.find(iri);
    if (!object) return std::nullopt;
    const auto record = storedRecord(transaction_, *object);
    if (record && record->is_class_wide) return Anchor{{}, record->class_iri};
    return Anchor{anchorOfStored(transaction_, stages_, *object), {}};
  }
  std::optional<EndedName> endOf(const std::string& iri) const { return known_.endOf(iri); }

 private:
  const rdf::ReadTransaction& transaction_;
  TileStages stages_;
  KnownObjects known_;
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
  if (is_type && !statement.class_iri.empty())
    throw Error(ErrorKind::InvalidArgument,
                "it is one object over all of the map: another class would change all of it; state other properties");
  return statement;
}

/// Calls `check`. When it finds a fault of what the quad states, throws RefusedQuad.
template <typename Check>
auto aboutSubject(const Quad& quad, const Check& check) {
  try {
    return check();
  } catch (const Error& fault) {
    if (!isFaultOfStatement(fault)) throw;
    throw RefusedQuad(quad, "what is stated of <" + quad.subject.text + ">: " + fault.what());
  }
}

/// Refuses what would contradict the map once it has the object: a property that the map computes, and a class of
/// objects. `end`: of an object that the map had.
void requireStatableOfUnknown(const Quad& quad, const std::optional<EndedName>& end,
                              const rules::ClassCatalogue& classes) {
  if (quad.predicate.text != rdf::vocabulary::rdf("type"))
    return aboutSubject(quad, [&] { requireStatable(quad.predicate.text); });
  if (quad.object.kind == TermKind::Iri && isClassOfObjects(quad.object.text, classes))
    throw RefusedQuad(quad, "<" + quad.subject.text + "> is no object that the map " +
                                (end ? "has now: " + textOf(*end) + ". Its" : "knows: its") + " class <" +
                                quad.object.text + "> cannot be stated before the map has the object" +
                                (end ? " again" : ""));
}

/// Names of no present object.
struct UnknownNames {
  std::set<std::string> never;             ///< the map did not have them
  std::map<std::string, EndedName> ended;  ///< it had them

  void add(const std::string& iri, std::optional<EndedName> end) {
    if (end)
      ended.emplace(iri, *std::move(end));
    else
      never.insert(iri);
  }
};

void noteUnknown(const UnknownNames& unknown, ProgressSink& sink) {
  const std::string outcome = ": what is stated of it changes no object, now or later, but queries find it";
  const auto others = [](std::size_t names) { return names > 1 ? " and " + std::to_string(names - 1) + " more" : ""; };
  if (const auto& never = unknown.never; !never.empty())
    sink.note(*never.begin() + others(never.size()) + (never.size() > 1 ? " are" : " is") +
              " no object that this map has or had" + outcome);
  if (const auto& ended = unknown.ended; !ended.empty())
    sink.note("<" + ended.begin()->first + ">" + others(ended.size()) +
              (ended.size() > 1 ? " are objects" : " is an object") + " that this map had. " +
              textOf(ended.begin()->second) + outcome);
}

}  // namespace

void anchorStatedObjects(rdf::WriteTransaction& transaction, const ParsedInputs& parsed,
                         const std::set<rdf::QuadIds>& before, ProgressSink& sink) {
  const auto& now = static_cast<const rdf::ReadTransaction&>(transaction);
  std::set<rdf::QuadIds> stated = quadsThatNameResources(now);
  std::erase_if(stated, [&](const rdf::QuadIds& quad) { return before.contains(quad); });
  if (stated.empty()) return;
  const rdf::QuadReader reader(now);
  StatedObjects objects(transaction, parsed);
  rdf::QuadWriter writer(transaction);
  std::size_t anchored = 0;
  UnknownNames unknown;
  for (const rdf::QuadIds& ids : stated) {
    const Quad quad{reader.termOf(ids.s), reader.termOf(ids.p), reader.termOf(ids.o), reader.termOf(ids.g)};
    if (!namesObject(quad.subject)) continue;
    auto anchor = objects.anchorOfIri(quad.subject.text);
    if (!anchor) {
      std::optional<EndedName> end = objects.endOf(quad.subject.text);
      requireStatableOfUnknown(quad, end, parsed.rules.catalogue);
      unknown.add(quad.subject.text, std::move(end));
      continue;
    }
    const Statement statement = aboutSubject(quad, [&] {
      Statement made = statementOf(quad, *std::move(anchor), parsed.rules.catalogue);
      requireNoWholeClass(now, made);
      return made;
    });
    writer.remove(ids);
    for (const Quad& part : quadsOf(statement)) writer.add(part);
    ++anchored;
  }
  writer.flush();
  noteNamesThatChange(now, stated, sink);
  noteUnknown(unknown, sink);
  if (anchored > 0)
    sink.note(std::to_string(anchored) + (anchored == 1 ? " statement about an object is anchored to its points"
                                                        : " statements about objects are anchored to their points"));
}

void noteStandingQuads(const rdf::ReadTransaction& transaction, const std::set<rdf::QuadIds>& before,
                       ProgressSink& sink) {
  const rdf::QuadReader reader(transaction);
  std::optional<KnownObjects> known;
  std::map<rdf::TermId, bool> is_known;  // by subject
  std::string first;
  std::size_t standing = 0;
  for (const rdf::QuadIds& quad : before) {
    auto subject = is_known.find(quad.s);
    if (subject == is_known.end()) {
      const Term term = reader.termOf(quad.s);
      const bool is_name = namesObject(term);
      if (is_name && !known) known.emplace(transaction);
      subject = is_known.emplace(quad.s, is_name && known->find(term.text)).first;
    }
    if (!subject->second || !reader.contains(quad)) continue;
    if (standing++ == 0) first = reader.termOf(quad.s).text;
  }
  if (standing == 0) return;
  const bool is_one = standing == 1;
  sink.note(std::to_string(standing) + (is_one ? " quad stands" : " quads stand") + " already under " +
            (is_one ? "the name of an object" : "names of objects") + " that the map knows now, such as <" + first +
            ">, and " + (is_one ? "changes" : "change") + " no object, also when stated again. To state " +
            (is_one ? "it of the object, delete it" : "them of the objects, delete them") + " in one update, and add " +
            (is_one ? "it" : "them") + " in the next");
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
