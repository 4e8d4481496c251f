// SPDX-License-Identifier: Apache-2.0
// Results of the reasoning stage: objects with class and parts, and the decisions behind them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/content_hash.hpp"
#include "perception/segments/scene.hpp"

namespace cluxel::rules {

/// The cluxels and primitives of one part of an object.
struct ObjectPart {
  std::string part_class;  ///< IRI: clx:TreeTrunk; the object's class when the rule names no part
  std::vector<perception::PrimitiveIndex>
      primitives;                      ///< ascending; a primitive that was split belongs to several objects
  std::vector<std::uint32_t> cluxels;  ///< numbers in SceneCluxels, ascending; disjoint between objects
};

/// One test on the path to a leaf, with the value it measured.
struct DecisionStep {
  std::string rule_id;
  std::string test;  ///< in words: "height of pole >= 6 m"
  std::string file;  ///< where the test stands
  std::size_t line = 0;
  std::optional<double> measured, threshold;  ///< SI
  std::optional<double> other;                ///< of a ratio: the attribute that the measured one is compared with
  bool is_looked_for = false;                 ///< a gap that is measured up to a bound which the threshold gives
  std::string unit;
  bool passed = false;
};

/// What one line of evidence added to the log-odds of a candidate.
struct EvidenceStep {
  std::string text;  ///< in words: "roughness of pole"
  std::string file;
  std::size_t line = 0;
  std::optional<double> measured;  ///< SI; absent for a test, and when nothing could be measured
  std::optional<bool> holds;       ///< of a test
  std::string unit;
  double log_odds = 0;
};

/// A candidate that wanted some of the same fragments.
struct RivalNote {
  std::string rule_id, class_iri;
  double log_odds = 0;
  bool won = false;
};

/// A change of one measured value that flips a test.
struct NeededChange {
  std::string test;
  double measured = 0, threshold = 0;  ///< in `unit`: degrees for angles
  std::string unit;
  double margin = 0;  ///< distance of the value from the threshold, >= 0
};

/// The least change of measured values that turns one branch of the path, when the rule would then say the opposite:
/// its tree is walked and its evidence is weighed with these values.
struct DecisionFlip {
  std::vector<NeededChange> changes;  ///< all of them are needed
  bool accepted = false;
  std::string outcome;  ///< the reason or description of the leaf reached then, or that evidence speaks against it
};

/// Why a rule accepted or rejected a seed primitive.
struct Decision {
  std::string rule_id;
  perception::PrimitiveIndex seed = 0;            ///< the one with most points, when several were grouped
  std::vector<perception::PrimitiveIndex> seeds;  ///< all of them, ascending
  bool accepted = false;
  bool is_gathered = false;  ///< it was gathered into an object: `path` holds the gap, and no tree was walked
  std::size_t leaf = 0;      ///< its number in Rule::nodes
  std::string reason;        ///< the reason of the leaf, or what was accepted
  std::vector<DecisionStep> path;
  double log_odds = 0;                 ///< sum of the evidence; of accept leaves only
  double probability = 0;              ///< of these log-odds; without evidence the leaf's confidence as written
  std::vector<EvidenceStep> evidence;  ///< the leaf's confidence, then each line
  std::vector<RivalNote> rivals;       ///< in a stratum of several classes
  std::string hint;                    ///< a rule that may fit instead
  std::vector<DecisionFlip> flips;     ///< only for a probed primitive: what would reverse what the rule says
};

struct SemanticObject {
  ContentHash id;  ///< hash of class and sorted members; of a class-wide object of the class alone
  std::string class_iri;
  double confidence = 0;
  std::string rule_id;
  std::vector<ObjectPart> parts;
  std::size_t decision = 0;    ///< number in ReasoningResult::decisions; of a stored object 0
  bool is_class_wide = false;  ///< all of the map that is of its class (`merge_into: class`)
};

struct ReasoningResult {
  std::vector<SemanticObject> objects;  ///< sorted by id
  std::vector<Decision> decisions;      ///< accepted and rejected, in the order they were taken
  /// For each primitive a hash of all steps that it took part in, with what they measured, and of the objects that own
  /// some of it. Two runs with the same rules in which it has the same trace treated it alike. The trace depends on
  /// what is around the primitive only, and not on how anything is numbered.
  std::vector<std::uint64_t> traces = {};
};

}  // namespace cluxel::rules
