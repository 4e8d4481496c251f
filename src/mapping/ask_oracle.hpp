// SPDX-License-Identifier: Apache-2.0
// Answers the rules' `ask:` tests from the map that is being written.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cluxel/knowledge/quad_store.hpp"
#include "cluxel/reasoning/reason.hpp"
#include "cluxel/sparql/query_engine.hpp"

namespace cluxel {

class MapOracle : public AskOracle {
 public:
  /// Writes the facts of the scene and of the given objects, so that queries see them.
  using Publish = std::function<void(std::span<const SemanticObject>)>;
  MapOracle(WriteTransaction& transaction, Publish publish) : transaction_(transaction), publish_(std::move(publish)) {}

  bool ask(const std::string& query, const std::map<std::string, std::string>& bindings) override;
  void objectsSoFar(std::span<const SemanticObject> objects) override;

 private:
  void bringUpToDate();

  WriteTransaction& transaction_;
  Publish publish_;
  std::vector<SemanticObject> objects_;  ///< copies: the stage's own list ends with its call
  std::optional<QuadReader> reader_;     ///< absent: the facts are not written yet
  std::map<std::string, PreparedQuery> prepared_;
};

}  // namespace cluxel
