// SPDX-License-Identifier: Apache-2.0
// Answers `ask:` for a finished map as its build did: a query sees the objects of the classes before, and no others.
#pragma once

#include <memory>

#include "cluxel/mapping/map_reader.hpp"
#include "cluxel/reasoning/reason.hpp"

namespace cluxel {

/// Works in a temporary store, made when the first question comes. `map` must outlive it.
class AskReplay : public AskOracle {
 public:
  explicit AskReplay(const MapReader& map);
  ~AskReplay() override;
  bool ask(const std::string& query, const std::map<std::string, std::string>& bindings) override;
  void objectsSoFar(std::span<const SemanticObject> objects) override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cluxel
