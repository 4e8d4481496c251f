// SPDX-License-Identifier: Apache-2.0
// Facts go into graph `observed`: they follow from the statements and the scans.
#include "mapping/statements/statement_facts.hpp"

#include "mapping/clouds/scan_store.hpp"
#include "mapping/statements/statement_places.hpp"
#include "mapping/thing_history.hpp"
#include "rdf/map_iris.hpp"

namespace cluxel::mapping {

AppliedStatements appliedStatements(const rdf::ReadTransaction& transaction, TileStages& stages,
                                    const perception::ThinParams& thin, const std::vector<Cloud>& clouds,
                                    const perception::Scene& scene, const rules::ClassCatalogue& classes,
                                    std::vector<rules::SemanticObject> by_rules) {
  const std::vector<Statement> statements = storedStatements(rdf::QuadReader(transaction));
  if (statements.empty()) return {std::move(by_rules), {}, {}, {}};
  PointOwners owners(transaction, stages, thin, clouds);
  AppliedStatements applied = applyStatements(statements, std::move(by_rules), scene, classes, owners, clouds);
  const perception::TileSet map = storedTiles(transaction);
  for (const Statement& statement : statements)
    applied.tiles.emplace(statement.id(), tilesOf(statement, owners, clouds, map));
  return applied;
}

void addStatementFacts(const std::vector<StatementOutcome>& outcomes, FactSink& facts) {
  for (const StatementOutcome& outcome : outcomes) {
    const rdf::TermId statement = facts.iri(rdf::iriOfStatement(outcome.statement.id()));
    facts.text(statement, "statementEffect", nameOf(outcome.effect));
    if (!outcome.rules_class.empty()) facts.link(statement, "rulesSay", facts.iri(outcome.rules_class));
    if (outcome.contradicts) facts.term(statement, "contradictsRules", Term::boolean(true));
    if (!outcome.object) continue;
    const rdf::TermId object = facts.iri(rdf::iriOfObject(*outcome.object));
    facts.link(statement, "appliesTo", object);
    if (outcome.statement.kind == StatementKind::Fact)
      facts.term(object, outcome.statement.property, outcome.statement.value);
  }
}

namespace {

/// Whether a scan is in the map: of one that left, only the history tells.
bool isObserved(const rdf::QuadReader& quads, const scan::ScanId& scan) {
  const auto cloud = quads.idOf(Term::iri(rdf::iriOfCloud(scan)));
  const auto graph = quads.idOf(Term::iri(rdf::vocabulary::kGraphObserved));
  rdf::QuadIds quad;
  return cloud && graph && quads.scan({.s = *cloud, .p = {}, .o = {}, .g = *graph}).next(quad);
}

}  // namespace

bool lacksScans(const rdf::QuadReader& quads, const Statement& statement) {
  return lacksScans(statement, [&](const scan::ScanId& scan) { return isObserved(quads, scan); });
}

std::vector<StatementOutcome> toldOutcomes(const rdf::QuadReader& quads) {
  std::vector<StatementOutcome> outcomes;
  for (const Statement& statement : storedStatements(quads)) {
    StatementOutcome outcome{statement, StatementEffect::Dormant, std::nullopt, "", false};
    const auto value = [&](const char* property) -> std::optional<std::string> {
      const auto subject = quads.idOf(Term::iri(rdf::iriOfStatement(statement.id())));
      const auto predicate = quads.idOf(Term::iri(rdf::vocabulary::clx(property)));
      const auto graph = quads.idOf(Term::iri(rdf::vocabulary::kGraphObserved));
      if (!subject || !predicate || !graph) return std::nullopt;
      rdf::QuadCursor cursor = quads.scan({.s = *subject, .p = *predicate, .o = {}, .g = *graph});
      rdf::QuadIds quad;
      return cursor.next(quad) ? std::optional(quads.termOf(quad.o).text) : std::nullopt;
    };
    const std::string effect = value("statementEffect").value_or("");
    for (const StatementEffect known : {StatementEffect::Applied, StatementEffect::Overruled})
      if (effect == nameOf(known)) outcome.effect = known;
    if (const auto object = value("appliesTo")) outcome.object = hashIn(*object, "object");
    outcome.rules_class = value("rulesSay").value_or("");
    outcome.contradicts = value("contradictsRules") == "true";
    outcome.lacks_scans = outcome.effect == StatementEffect::Dormant && lacksScans(quads, statement);
    outcomes.push_back(std::move(outcome));
  }
  return outcomes;
}

}  // namespace cluxel::mapping
