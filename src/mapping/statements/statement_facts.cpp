// SPDX-License-Identifier: Apache-2.0
// Facts go into graph `observed`: they follow from the statements and the scans.
#include "mapping/statements/statement_facts.hpp"

#include "cluxel/error.hpp"
#include "mapping/map_tables.hpp"
#include "mapping/object_store.hpp"
#include "rdf/map_iris.hpp"

namespace cluxel::mapping {

namespace {

constexpr std::string_view kNamesKey = "overruled names";

}  // namespace

AppliedStatements appliedStatements(const rdf::ReadTransaction& transaction, TileStages& stages,
                                    const perception::ThinParams& thin, const std::vector<Cloud>& clouds,
                                    const perception::Scene& scene, const rules::ClassCatalogue& classes,
                                    std::vector<rules::SemanticObject> by_rules) {
  const std::vector<Statement> statements = storedStatements(rdf::QuadReader(transaction));
  if (statements.empty()) return {std::move(by_rules), {}, {}};
  stages.loadPoints(transaction);
  PointOwners owners(transaction, stages, thin, clouds);
  return applyStatements(statements, std::move(by_rules), scene, classes, owners, clouds);
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

void storeOverruled(rdf::WriteTransaction& transaction, const std::vector<OverruledObject>& overruled) {
  if (overruled.empty()) {
    transaction.eraseBlock(tables::kMeta, kNamesKey);
    eraseObjectsByRules(transaction);
    return;
  }
  std::vector<rules::SemanticObject> by_rules;
  std::string names;
  for (const OverruledObject& object : overruled) {
    by_rules.push_back(object.by_rules);
    names += tables::keyOf(object.now.value_or(ContentHash{}));
  }
  storeObjectsByRules(transaction, by_rules);
  transaction.putBlock(tables::kMeta, kNamesKey, names);
}

std::vector<OverruledObject> storedOverruled(const rdf::ReadTransaction& transaction) {
  const auto names = transaction.block(tables::kMeta, kNamesKey);
  if (!names) return {};
  constexpr std::size_t kBytes = sizeof(ContentHash::bytes);
  const std::vector<rules::SemanticObject> by_rules = storedObjectsByRules(transaction);
  if (names->size() != kBytes * by_rules.size())
    throw Error(ErrorKind::StoreUnavailable,
                "the map's objects that statements changed cannot be read; build the map anew");
  std::vector<OverruledObject> overruled;
  for (std::size_t i = 0; i < by_rules.size(); ++i) {
    const ContentHash now = tables::hashOfKey(std::string_view(*names).substr(kBytes * i, kBytes));
    overruled.push_back({by_rules[i], now.isZero() ? std::nullopt : std::optional(now)});
  }
  return overruled;
}

}  // namespace cluxel::mapping
