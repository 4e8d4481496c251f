// SPDX-License-Identifier: Apache-2.0
// The reasoning stage over what lies around a thing, with the outcome of the run over the whole scene.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "rules/explain/explain.hpp"

namespace cluxel::rules {

/// What the run over a whole scene left.
struct WholeRun {
  const std::vector<std::uint64_t>& traces;  ///< ReasoningResult::traces
  const std::vector<SemanticObject>& objects;
  KnownSplits* splits = nullptr;  ///< as in ReasoningContext; learns those of the part
};

/// A run with probes at some primitives. All numbers refer to the part.
struct PartRun {
  std::shared_ptr<const perception::Scene> part;
  std::vector<perception::PrimitiveIndex> primitives;  ///< the probed ones
  ReasoningResult result;
};

/// The parts that are tried: the primitives within a margin around the explained ones.
struct TriedParts {
  std::vector<double> margins_m{12, 30, 75};  ///< ascending
  double max_share = 0.6;                     ///< of the scene's cluxels: larger parts take as long as the whole
};

/// Around what is explained, a run over a part must give every cluxel to the same rule as the whole run [m].
inline constexpr double kSameOwnersWithin_m = 5;

/// Tries parts of growing size. One counts when the traces of `primitives` (ascending), and of the seeds of the
/// objects that own them, are those of the whole run, and when every cluxel within kSameOwnersWithin_m around them went
/// to the same rule. A counterfactual may still read what lies farther away. Absent when no part counts that has at
/// most `max_share` of the scene's cluxels, or when the rules ask the map. `scene` may itself be cut out of a larger
/// one, to which the traces belong. A part that holds all of it is the scene itself.
std::optional<PartRun> runInPart(const std::shared_ptr<const perception::Scene>& scene, const RuleSet& rules,
                                 const WholeRun& whole, const std::vector<perception::PrimitiveIndex>& primitives,
                                 const TriedParts& tried = {});
/// The same with a scene that outlives the result.
std::optional<PartRun> runInPart(const perception::Scene& scene, const RuleSet& rules, const WholeRun& whole,
                                 const std::vector<perception::PrimitiveIndex>& primitives,
                                 const TriedParts& tried = {});

/// An object of the whole run, with its primitives in a part.
struct AskedObject {
  ContentHash id;  ///< that the rules gave to it
  std::vector<perception::PrimitiveIndex> primitives;
};

/// Explains many objects by one run over a part of a map: all for which the part counts as it does for runInPart().
/// Absent for the others. `whole`: of the part's primitives, and objects by the part's numbers. Cost: one run with
/// probes at all of these primitives.
std::vector<std::optional<Explanation>> explainInPart(const perception::Scene& part, const RuleSet& rules,
                                                      const WholeRun& whole, const std::vector<AskedObject>& asked);

}  // namespace cluxel::rules
