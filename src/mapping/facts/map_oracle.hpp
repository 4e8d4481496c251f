// SPDX-License-Identifier: Apache-2.0
// Checks and answers the `ask:` tests of rules (rules/ask_oracle.hpp); answers come from the map that is being written.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rdf/ontology/ontology.hpp"
#include "rdf/store/quad_store.hpp"
#include "rules/ask_oracle.hpp"
#include "rules/language/rule_loader.hpp"
#include "rules/objects/semantic_object.hpp"
#include "sparql/query_engine.hpp"

namespace cluxel::mapping {

/// Options that report faulty queries of `ask:` when rules are loaded, and queries whose answer would not follow from
/// the map alone.
rules::RuleLoadOptions withCheckedQueries();
/// The same for rules that no map has yet: their queries may not name the graph of the history, either, which they do
/// not see.
rules::RuleLoadOptions withCheckedNewQueries();
/// As withCheckedQueries(), and queries that name classes or properties that the ontology does not know, or look in a
/// FILTER at what nothing binds. Of queries without fault it is told of which classes they look for things.
rules::RuleLoadOptions withCheckedQueries(const rdf::OntologyView& ontology);

class MapOracle : public rules::AskOracle {
 public:
  /// Writes the facts of the scene and of the given objects, so that queries see them.
  using Publish = std::function<void(std::span<const rules::SemanticObject>)>;
  MapOracle(rdf::WriteTransaction& transaction, Publish publish)
      : transaction_(transaction), publish_(std::move(publish)) {}

  bool ask(const std::string& query, const std::map<std::string, std::string>& bindings) override;
  void objectsSoFar(std::span<const rules::SemanticObject> objects) override;

 private:
  void bringUpToDate();

  rdf::WriteTransaction& transaction_;
  Publish publish_;
  std::vector<rules::SemanticObject> objects_;  ///< copies, because the caller's list does not outlive its call
  std::optional<rdf::QuadReader> reader_;       ///< absent until the facts of objects_ are written
  std::map<std::string, sparql::PreparedQuery> prepared_;
};

}  // namespace cluxel::mapping
