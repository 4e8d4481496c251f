// SPDX-License-Identifier: Apache-2.0
// Lists statements. A statement that contradicts the rules is marked.
#include "app/commands/statement_list.hpp"

#include "base/utf8.hpp"
#include "mapping/map_reader.hpp"
#include "rdf/map_iris.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::app {

namespace {

using mapping::KnownStatement;

}  // namespace

std::string classText(const std::string& iri) {
  return iri.starts_with(rdf::vocabulary::kClx) ? mapping::localName(iri) : "<" + iri + ">";
}

namespace {

std::string lineOfKnown(const KnownStatement& known) {
  std::string line = known.statement.id().hex() + "  " + textOf(known.statement) + "  " + known.effect;
  if (known.lacks_scans) line += " until the scans that it is about are in the map again";
  const bool is_applied = known.effect == nameOf(mapping::StatementEffect::Applied);
  if (!known.object.empty())
    line += (is_applied ? " to object/" : ", about object/") + mapping::localName(known.object);
  if (known.contradicts) line += ", against the rules";
  if (known.contradicts && !known.rules_class.empty()) line += ", which say " + classText(known.rules_class);
  if (!known.author.empty()) line += "; by " + known.author;
  if (!known.stated_at.empty()) line += (known.author.empty() ? "; " : " ") + known.stated_at;
  return line;
}

Json jsonOfKnown(const KnownStatement& known) {
  Json entry{{"id", known.statement.id().hex()}, {"states", textOf(known.statement)}, {"effect", known.effect}};
  if (!known.object.empty()) entry["object"] = known.object;
  if (!known.rules_class.empty()) entry["rules_say"] = known.rules_class;
  entry["contradicts_rules"] = known.contradicts;
  entry["lacks_scans"] = known.lacks_scans;
  if (!known.author.empty()) entry["author"] = known.author;
  if (!known.stated_at.empty()) entry["stated_at"] = known.stated_at;
  return entry;
}

KnownStatement withoutHistory(const mapping::StatementOutcome& outcome) {
  const std::string object = outcome.object ? rdf::iriOfObject(*outcome.object) : "";
  return {.statement = outcome.statement,
          .effect = std::string(nameOf(outcome.effect)),
          .object = object,
          .rules_class = outcome.rules_class,
          .contradicts = outcome.contradicts,
          .lacks_scans = outcome.lacks_scans};
}

}  // namespace

std::string lineOf(const mapping::StatementOutcome& outcome) {
  return lineOfKnown(withoutHistory(outcome));
}

Json jsonOf(const mapping::StatementOutcome& outcome) {
  return jsonOfKnown(withoutHistory(outcome));
}

void printStatements(const std::vector<KnownStatement>& statements, const Session& session) {
  if (!session.json) {
    for (const KnownStatement& known : statements) print(withoutControls(lineOfKnown(known)));
    if (statements.empty()) print("no operator statements");
    return;
  }
  Json json = Json::array();
  for (const KnownStatement& known : statements) json.push_back(jsonOfKnown(known));
  printJson(Json{{"statements", std::move(json)}});
}

}  // namespace cluxel::app
