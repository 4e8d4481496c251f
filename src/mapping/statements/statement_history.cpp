// SPDX-License-Identifier: Apache-2.0
// Times are xsd:dateTime in UTC with six digits of a second, so that their texts sort as the times do.
#include "mapping/statements/statement_history.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "base/utc_time.hpp"
#include "cluxel/error.hpp"
#include "mapping/thing_history.hpp"
#include "rdf/map_iris.hpp"

namespace cluxel::mapping {

namespace {

using rdf::vocabulary::clx;

std::vector<Quad> quadsAboutStatement(const rdf::QuadReader& reader, const ContentHash& id, std::string_view graph) {
  return quadsAbout(reader, rdf::iriOfStatement(id), graph);
}

/// Quads about statements, written together.
class StatementWriter {
 public:
  explicit StatementWriter(rdf::WriteTransaction& transaction)
      : reader_(static_cast<const rdf::ReadTransaction&>(transaction)), writer_(transaction) {
    now_ = Term::literal(dateTimeText(secondsNow()), rdf::vocabulary::xsd("dateTime"));
  }

  bool has(const ContentHash& id) const {
    return !quadsAboutStatement(reader_, id, rdf::vocabulary::kGraphOperator).empty();
  }
  bool wasWithdrawn(const ContentHash& id) const {
    const std::vector<Quad> known = quadsAboutStatement(reader_, id, rdf::vocabulary::kGraphHistory);
    return std::any_of(known.begin(), known.end(),
                       [](const Quad& quad) { return quad.predicate.text == provenance("invalidatedAtTime"); });
  }
  void add(const Quad& quad) { writer_.add(quad); }
  void remove(const ContentHash& id, std::string_view graph_iri) {
    for (const Quad& quad : quadsAboutStatement(reader_, id, graph_iri))
      writer_.remove(rdf::QuadIds{writer_.intern(quad.subject), writer_.intern(quad.predicate),
                                  writer_.intern(quad.object), writer_.intern(quad.graph)});
  }
  void recordMade(const ContentHash& id, const std::string& author) {
    remove(id, rdf::vocabulary::kGraphHistory);
    record(id, clx("statedBy"), author, "generatedAtTime");
  }
  void recordWithdrawn(const ContentHash& id, const std::string& author) {
    record(id, clx("withdrawnBy"), author, "invalidatedAtTime");
  }
  void flush() { writer_.flush(); }

 private:
  void record(const ContentHash& id, const std::string& by, const std::string& author, std::string_view time) {
    const Term subject = Term::iri(rdf::iriOfStatement(id)), graph = Term::iri(rdf::vocabulary::kGraphHistory);
    if (!author.empty()) writer_.add(Quad{subject, Term::iri(by), Term::literal(author), graph});
    writer_.add(Quad{subject, Term::iri(provenance(time)), now_, graph});
  }

  rdf::QuadReader reader_;
  rdf::QuadWriter writer_;
  Term now_;
};

/// The last of the times of each statement in the history of the maps.
std::map<std::string, std::string> lastTimes(std::span<const rdf::QuadReader* const> maps, std::string_view property) {
  const std::string statements = rdf::mapIri("statement", "");
  std::map<std::string, std::string> last;
  for (const rdf::QuadReader* map : maps) {
    const auto predicate = map->idOf(Term::iri(provenance(property)));
    const auto history = map->idOf(Term::iri(rdf::vocabulary::kGraphHistory));
    if (!predicate || !history) continue;
    rdf::QuadCursor cursor = map->scan({.s = {}, .p = *predicate, .o = {}, .g = *history});
    for (rdf::QuadIds quad; cursor.next(quad);) {
      const std::string subject = map->termOf(quad.s).text;
      if (!subject.starts_with(statements)) continue;
      std::string& time = last[subject];
      time = std::max(time, map->termOf(quad.o).text);
    }
  }
  return last;
}

}  // namespace

bool addStatement(rdf::WriteTransaction& transaction, const Statement& statement, const std::string& author) {
  StatementWriter writer(transaction);
  if (writer.has(statement.id())) return false;
  for (const Quad& quad : quadsOf(statement)) writer.add(quad);
  writer.recordMade(statement.id(), author);
  writer.flush();
  return true;
}

bool withdrawStatement(rdf::WriteTransaction& transaction, const ContentHash& id, const std::string& author) {
  StatementWriter writer(transaction);
  if (!writer.has(id) && writer.wasWithdrawn(id)) return false;
  if (!writer.has(id)) throw Error(ErrorKind::NotFound, "the map has no operator statement " + id.hex());
  writer.remove(id, rdf::vocabulary::kGraphOperator);
  writer.recordWithdrawn(id, author);
  writer.flush();
  return true;
}

void eraseStatements(rdf::WriteTransaction& transaction, std::span<const ContentHash> ids) {
  StatementWriter writer(transaction);
  for (const ContentHash& id : ids) writer.remove(id, rdf::vocabulary::kGraphOperator);
  writer.flush();
}

void recordStatements(rdf::WriteTransaction& transaction, const std::vector<ContentHash>& made,
                      const std::vector<ContentHash>& withdrawn, const std::string& author) {
  StatementWriter writer(transaction);
  for (const ContentHash& id : made) writer.recordMade(id, author);
  for (const ContentHash& id : withdrawn) writer.recordWithdrawn(id, author);
  writer.flush();
}

void copyStatementHistory(const rdf::QuadReader& from, rdf::WriteTransaction& into) {
  StatementWriter writer(into);
  std::vector<ContentHash> ids = withdrawnStatements(from);
  for (const Statement& statement : storedStatements(from)) ids.push_back(statement.id());
  for (const ContentHash& id : ids)
    for (const Quad& quad : quadsAboutStatement(from, id, rdf::vocabulary::kGraphHistory)) writer.add(quad);
  writer.flush();
}

std::vector<ContentHash> withdrawnAmong(std::span<const rdf::QuadReader* const> maps) {
  const auto made = lastTimes(maps, "generatedAtTime"), withdrawn = lastTimes(maps, "invalidatedAtTime");
  std::set<ContentHash> ids;
  for (const rdf::QuadReader* map : maps)
    for (const Statement& statement : storedStatements(*map)) {
      const std::string iri = rdf::iriOfStatement(statement.id());
      const auto end = withdrawn.find(iri);
      if (end == withdrawn.end()) continue;
      const auto begin = made.find(iri);
      if (begin == made.end() || begin->second < end->second) ids.insert(statement.id());
    }
  return {ids.begin(), ids.end()};
}

std::vector<ContentHash> withdrawnStatements(const rdf::QuadReader& quads) {
  const rdf::QuadReader* const only = &quads;
  std::vector<ContentHash> ids;
  for (const auto& [iri, time] : lastTimes({&only, 1}, "invalidatedAtTime"))
    if (const auto id = hashIn(iri, "statement");
        id && quadsAboutStatement(quads, *id, rdf::vocabulary::kGraphOperator).empty())
      ids.push_back(*id);
  return ids;
}

StatementRecord recordOf(const rdf::QuadReader& quads, const ContentHash& id) {
  StatementRecord record;
  std::set<std::string> authors;
  for (const Quad& quad : quadsAboutStatement(quads, id, rdf::vocabulary::kGraphHistory)) {
    if (quad.predicate.text == clx("statedBy")) authors.insert(quad.object.text);
    if (quad.predicate.text == provenance("generatedAtTime"))
      record.stated_at = std::max(record.stated_at, quad.object.text);
  }
  for (const std::string& author : authors) record.author += (record.author.empty() ? "" : ", ") + author;
  return record;
}

}  // namespace cluxel::mapping
