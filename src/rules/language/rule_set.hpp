// SPDX-License-Identifier: Apache-2.0
// A rule set as plain values: decision trees per class. docs/rules.md defines the language.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "base/content_hash.hpp"
#include "rules/language/class_catalogue.hpp"
#include "rules/language/rule_condition.hpp"

namespace cluxel::rules {

/// Linked primitives become one candidate, as long as all limits hold for it.
struct GroupSpec {
  SourceLocation at;
  std::vector<scan::PrimitiveLabel> labels;
  std::optional<double> near_m;                    ///< link when the gap is at most this
  std::optional<double> horizontal_m, vertical_m;  ///< or when both gaps are
  /// Their numbers in RuleSet::thresholds, from 1; 0: none.
  std::uint32_t near_threshold = 0, horizontal_threshold = 0, vertical_threshold = 0;
  bool adjacent = false;  ///< or when a cluxel edge joins them
  std::vector<Condition> limits;
};

struct SeedSpec {
  std::string name = "seed";
  std::vector<scan::PrimitiveLabel> labels;
  std::optional<SliceSpec> slice;  ///< each connected component of its cluxels is a seed
  std::vector<Condition> where;    ///< each primitive must pass before it is grouped
};

enum class Choice : std::uint8_t { LargestVolume, MostPoints, Nearest, Highest, Lowest, MostAdjacent, All };

using NodeIndex = std::size_t;

struct BranchNode {
  Condition condition;
  NodeIndex yes = 0, no = 0;
};

/// Binds another primitive, or all that pass, to a name for the rest of the branch.
struct FindNode {
  std::string name;
  std::vector<scan::PrimitiveLabel> labels;
  std::string object_class;      ///< when given: looks among the primitives of such objects, for reference only
  std::vector<Condition> where;  ///< relations and measures to bound names; the subject is the candidate
  Choice choose = Choice::LargestVolume;
  std::string nearest_to;  ///< for Nearest, MostAdjacent: the first bound name in `where`
  bool share = false;      ///< may be bound by several candidates of this class; `split` then divides it
  NodeIndex found = 0, missing = 0;
};

/// Confidence grows from `low` to `high` while an attribute goes from `at_low` to `at_high`.
struct ConfidenceRamp {
  std::string of;
  perception::Attribute attribute = perception::Attribute::Probability;
  double at_low = 0, at_high = 1;
};
struct Confidence {
  double low = 1, high = 1;
  std::vector<ConfidenceRamp> ramps;  ///< their mean is used; none: `high`
  SourceLocation low_at, high_at;     ///< where the numbers stand
};

/// In evidence, the name of everything that a candidate would own.
inline constexpr std::string_view kWholeCandidate = "whole";

/// One line of evidence: it adds log-odds to a candidate for what is measured of it.
struct EvidenceLine {
  enum class Kind : std::uint8_t {
    Curve,  ///< log-odds between knots of a measured value, interpolated linearly, constant beyond the ends
    Bell,   ///< weight * exp(-(value - about)^2 / (2 spread^2))
    Test,   ///< weight when the condition holds
  };
  struct Knot {
    double at = 0;        ///< measured value, SI
    double log_odds = 0;  ///< what it adds there
    SourceLocation where;
  };
  Kind kind = Kind::Curve;
  SourceLocation at;
  Condition measure;  ///< Attribute or Pair without a comparison; of Test: the condition
  std::vector<Knot> knots;
  double about = 0, spread = 1;
  double weight = 0;  ///< of Bell and Test
  SourceLocation weight_at;
  double missing = 0;  ///< log-odds when the value cannot be measured: nothing is bound to the name, an empty slice
  /// The number of `missing` in RuleSet::constants, from 1. Those of the knots, or of the bell or weight, follow.
  std::uint32_t constant = 0;
  /// It looks at objects of classes that compete with the rule's: it counts in the second round only, and reads the
  /// winners of the first.
  bool asks_rivals = false;
};

struct AbsorbSpec {
  SourceLocation at;
  std::vector<scan::PrimitiveLabel> labels;
  std::vector<Condition> when;
  double max_fraction_of_points = 1;
  std::uint32_t threshold = 0;  ///< its number in RuleSet::thresholds, from 1
  std::string into;             ///< bound name whose part they join
  bool late = false;            ///< after all classes instead of after this class
};

/// Collects fragments that belong to a split primitive without touching it.
struct GatherSpec {
  double within_m = 0;  ///< largest gap to the object
  double above_m = 0;   ///< minimum height above the ground of such a fragment
};

/// Splits shared primitives among the objects that claim them, along the cluxel graph.
struct SplittingSpec {
  SourceLocation at;
  std::string part, from;            ///< bound names: what is split, and where the paths start
  double reach_m = 8;                ///< largest plan distance from the foot of `from`
  double jump_m = 0.5;               ///< gaps up to this are bridged, at double length
  double start_m = 0.5;              ///< the same between `from` and what is split; at least jump_m
  double clearance_m = 0;            ///< cluxels below this height above ground are not assigned
  std::optional<GatherSpec> gather;  ///< then also assigns free fragments of the same labels
};

enum class MergeInto : std::uint8_t {
  Nothing,  ///< makes an object
  Related,  ///< joins the object found by the last relation test that passed
  Class,    ///< joins the one object of the rule's class; the first candidate makes it
};

struct AcceptLeaf {
  std::vector<std::pair<std::string, std::string>> parts;  ///< bound name -> part class IRI, in the order written
  Confidence confidence;                                   ///< before the evidence
  SourceLocation confidence_at;
  std::vector<EvidenceLine> evidence;  ///< beside the rule's own
  std::uint32_t constant = 0;          ///< the number of `confidence` in RuleSet::constants, from 1
  std::vector<AbsorbSpec> absorb;
  std::optional<SplittingSpec> splitting;
  MergeInto merge_into = MergeInto::Nothing;
};

struct RejectLeaf {
  std::string reason;
  std::string hint;            ///< a rule that may fit instead
  bool leave_unknown = false;  ///< no later rule may take the seed
};

struct TreeNode {
  SourceLocation at;
  std::variant<BranchNode, FindNode, AcceptLeaf, RejectLeaf> what;
};

struct Rule {
  std::string id;
  std::string class_iri;
  std::string description;
  SourceLocation at;
  SeedSpec seed;
  std::optional<GroupSpec> group;
  std::vector<EvidenceLine> evidence;  ///< for every accept leaf
  bool leftovers = false;              ///< proposes after its stratum was decided, from what is left
  std::vector<TreeNode> nodes;         ///< node 0 is the root
};

/// In words, for explanations: "roughness of pole".
std::string describe(const EvidenceLine& line);

/// A constant that a measured number is compared with.
struct PlainThreshold {
  double value = 0;              ///< SI; a ratio: the measured number is the quotient of two attributes
  bool is_met_by_equal = false;  ///< an equal number has the outcome of larger ones, else that of smaller ones
};

/// A file of a rule set, under the name by which it was included.
struct RuleSource {
  std::string name;
  std::string text;
};

struct RuleSet {
  std::string name, version, description;
  std::map<std::string, std::string> prefixes;
  std::vector<std::string> order;                ///< class IRIs; earlier classes get a primitive first
  std::vector<std::vector<std::string>> strata;  ///< the same classes; those of one stratum compete
  /// For each label, the log-odds that a primitive which a rule accepts is no object at all.
  std::array<double, scan::kPrimitiveLabelCount> nothing{};
  std::vector<Rule> rules;  ///< in the order written
  bool asks_map = false;    ///< some condition is an `ask:`
  /// Edges of the cluxel graph and relations lead no farther in plan view [m]. More with models of large volumes.
  double contact_m = 2;
  std::vector<RuleSource> sources;
  ClassCatalogue catalogue;  ///< the classes it was checked against
  /// What may change while all else stays, and a hash of all else that a run reads; see numberThresholds(). Of
  /// constants that something is computed from, hashes.
  std::vector<PlainThreshold> thresholds;
  std::vector<std::uint64_t> constants;
  ContentHash structure;
  /// Hash of the sources' texts.
  ContentHash hash() const;
  const Rule* find(std::string_view id) const;
  /// "clx:Tree" for a class IRI, with the rule set's prefixes; the IRI itself when none fits.
  std::string shorten(std::string_view iri) const;
};

}  // namespace cluxel::rules
