// SPDX-License-Identifier: Apache-2.0
// The reasoning stage: primitives and rules in, objects with reasons out.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>

#include "cluxel/perception/scene.hpp"
#include "cluxel/reasoning/rule_set.hpp"
#include "cluxel/reasoning/semantic_object.hpp"

namespace cluxel {

/// Answers the `ask:` tests of rules from the map and the ontology. The stage calls it from one thread.
class AskOracle {
 public:
  virtual ~AskOracle() = default;
  /// Whether the ASK query holds with its variables bound to these primitives' IRIs. `query` has its prefixes.
  virtual bool ask(const std::string& query, const std::map<std::string, std::string>& bindings) = 0;
  /// The objects of all classes that have had their turn; later queries may ask about them.
  virtual void objectsSoFar(std::span<const SemanticObject> /*objects*/) {}
};

struct ReasoningContext {
  /// Needed by rule sets with `ask:`; without it such a test is an Error.
  AskOracle* oracle = nullptr;
  /// When given, decisions about this primitive also tell what would have changed them (Decision::flips).
  std::optional<PrimitiveIndex> probe = std::nullopt;
};

/// Makes objects of the scene's primitives, class by class in the rule set's order. Objects' cluxels are disjoint. The
/// result depends on the primitives' ids and measures, never on their order. Cost about linear in cluxels and edges.
ReasoningResult reason(const Scene& scene, const RuleSet& rules, const ReasoningContext& context = {});

/// `https://w3id.org/cluxel/map/primitive/<hash>`.
std::string iriOf(const Primitive& primitive);

}  // namespace cluxel
