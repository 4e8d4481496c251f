// SPDX-License-Identifier: Apache-2.0
// Answers `ask:` for a finished map as its build did: a query sees only objects of classes decided earlier.
#pragma once

#include <memory>

#include "mapping/map_reader.hpp"
#include "rules/ask_oracle.hpp"

namespace cluxel::mapping {

/// Uses a temporary store, created by the first query. `map` must outlive it.
class AskReplay : public rules::AskOracle {
 public:
  explicit AskReplay(const MapReader& map);
  ~AskReplay() override;
  bool ask(const std::string& query, const std::map<std::string, std::string>& bindings) override;
  void objectsSoFar(std::span<const rules::SemanticObject> objects) override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cluxel::mapping
