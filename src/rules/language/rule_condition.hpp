// SPDX-License-Identifier: Apache-2.0
// Conditions as plain values: what is measured and the threshold. All numbers are SI.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "cluxel/error.hpp"
#include "perception/segments/scene.hpp"

namespace cluxel::rules {

enum class Comparison : std::uint8_t { Less, LessEqual, Greater, GreaterEqual, Equal, NotEqual, Between, Outside };

/// A number in SI with its dimension and its text in the file ("2.5 m").
struct Quantity {
  double value = 0;
  perception::Dimension dimension = perception::Dimension::Ratio;
  std::string text;
};

/// What can be measured between two bound candidates; all but AdjacentFraction in metres.
enum class PairMeasure : std::uint8_t {
  Gap,               ///< smallest distance of their cluxels' boxes
  HorizontalGap,     ///< the same in plan view
  VerticalGap,       ///< height between their vertical extents; 0 when these overlap
  AxisDistance,      ///< plan distance of the subject's centroid from the other's axis
  AdjacentFraction,  ///< share of the subject's outward cluxel edges that lead to the other
};

/// Gaps are measured up to kMaxMeasure_m. The search radius exceeds the threshold of a test by kMeasureMargin_m, so
/// that the measured value is reported also when it is slightly above the threshold.
inline constexpr double kMaxMeasure_m = 50.0, kMeasureMargin_m = 0.5;

/// The other operand of a relation or measure: a bound name, any primitive with one of some labels, or any object of a
/// class.
struct Target {
  enum class Kind : std::uint8_t { Name, Labels, Object } kind = Kind::Name;
  std::string name;
  std::vector<scan::PrimitiveLabel> labels;
  std::string object_class;  ///< IRI; subclasses count
};

/// The cluxels between two heights above the local ground, both included.
struct SliceSpec {
  double from_m = 0, to_m = 0;
};

struct Condition {
  enum class Kind : std::uint8_t {
    Attribute,
    Pair,
    Relation,
    Label,
    Class,
    Ask,
    All,
    Any,
    Not,
    Unseen,  ///< the operand is neither true nor false, because no scan shows an end that it measures
  };
  Kind kind = Kind::All;
  SourceLocation at;
  std::string of;  ///< bound name of the subject; never empty after loading

  perception::Attribute attribute = perception::Attribute::Height;
  std::optional<SliceSpec>
      slice;  ///< of Attribute: only these cluxels are measured; the test fails when there are none
  PairMeasure measure = PairMeasure::Gap;
  perception::RelationKind relation = perception::RelationKind::Near;
  std::optional<Target> target;  ///< of Pair and Relation; TouchesGround has none

  Comparison comparison = Comparison::LessEqual;
  std::optional<Quantity> value;  ///< the threshold; the lower one of Between and Outside; `within` of Relation
  std::optional<Quantity> upper;
  double ratio = 1;  ///< threshold = ratio * (ratio_of's attribute), when ratio_of is given
  std::string ratio_of;
  std::optional<perception::Attribute> ratio_attribute;
  std::optional<SliceSpec> ratio_slice;

  std::vector<scan::PrimitiveLabel> labels;  ///< of Label; with `value`, the share of points that have one of them
  std::string class_iri;                     ///< of Class: the subject belongs to an object of that class
  std::string query;                         ///< of Ask: SPARQL with the rule set's prefixes
  std::vector<std::string> query_names;      ///< bound names that the query mentions as variables
  std::vector<std::string> query_classes;    ///< IRIs of classes of which the query looks for things, as far as known
  std::vector<Condition> operands;           ///< of All, Any, Not, Unseen
  bool asks_rivals = false;                  ///< of Pair: the target are objects that won the first round
  /// The numbers of `value` (or `ratio`) and of `upper` in RuleSet::thresholds, from 1; 0: none.
  std::uint32_t threshold = 0, upper_threshold = 0;
};

/// "a Tree", "an Avenue": a class or label with its article.
std::string withArticle(std::string_view name);
/// In words, for explanations: "height of pole >= 6 m".
std::string describe(const Condition& condition);
/// True when the condition relates `subject` to a bound name closely enough to look up candidates: a relation, a share
/// of adjacency, or a distance with an upper bound.
bool looksNearby(const Condition& condition, std::string_view subject);
std::string_view symbolOf(Comparison comparison);
/// The comparison that holds where the given one does not: `>=` of `<`.
Comparison negated(Comparison comparison);
std::string_view nameOf(PairMeasure measure);
/// "m", "m2", "m3", "deg", or empty.
std::string_view unitOf(perception::Dimension dimension);

}  // namespace cluxel::rules
