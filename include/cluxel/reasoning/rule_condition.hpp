// SPDX-License-Identifier: Apache-2.0
// Conditions of rules as plain values: what is measured, and what it is compared with. All numbers are SI.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "cluxel/base/diagnostic.hpp"
#include "cluxel/perception/scene.hpp"

namespace cluxel {

enum class Comparison : std::uint8_t { Less, LessEqual, Greater, GreaterEqual, Equal, NotEqual, Between, Outside };

/// A number with its dimension, as it was written ("2.5 m") and in SI.
struct Quantity {
  double value = 0;
  Dimension dimension = Dimension::Ratio;
  std::string text;
};

/// What can be measured between two bound things; all but AdjacentFraction in metres.
enum class PairMeasure : std::uint8_t {
  Gap,               ///< smallest distance of their cluxels' boxes
  HorizontalGap,     ///< the same in plan view
  VerticalGap,       ///< height between their vertical extents; 0 when these overlap
  AxisDistance,      ///< plan distance of the subject's centroid from the other's axis
  AdjacentFraction,  ///< share of the subject's outward cluxel edges that lead to the other
};

/// The other side of a relation or measure: a bound name, anything with one of some labels, or any object of a class.
struct Target {
  enum class Kind : std::uint8_t { Name, Labels, Object } kind = Kind::Name;
  std::string name;
  std::vector<PrimitiveLabel> labels;
  std::string object_class;  ///< IRI; subclasses count
};

/// The cluxels between two heights above the local ground, both included.
struct SliceSpec {
  double from_m = 0, to_m = 0;
};

struct Condition {
  enum class Kind : std::uint8_t { Attribute, Pair, Relation, Label, Class, Ask, All, Any, Not };
  Kind kind = Kind::All;
  SourceLocation at;
  std::string of;  ///< bound name of the subject; never empty after loading

  Attribute attribute = Attribute::Height;
  std::optional<SliceSpec> slice;  ///< of Attribute: measures these cluxels only; without any, no test holds
  PairMeasure measure = PairMeasure::Gap;
  RelationKind relation = RelationKind::Near;
  std::optional<Target> target;  ///< of Pair and Relation; TouchesGround has none

  Comparison comparison = Comparison::LessEqual;
  std::optional<Quantity> value;  ///< the threshold; the lower one of Between and Outside; `within` of Relation
  std::optional<Quantity> upper;
  double ratio = 1;  ///< threshold = ratio * (ratio_of's attribute), when ratio_of is given
  std::string ratio_of;
  std::optional<Attribute> ratio_attribute;
  std::optional<SliceSpec> ratio_slice;

  std::vector<PrimitiveLabel> labels;    ///< of Label
  std::string class_iri;                 ///< of Class: the subject belongs to an object of that class
  std::string query;                     ///< of Ask: SPARQL with the rule set's prefixes
  std::vector<std::string> query_names;  ///< bound names that the query mentions as variables
  std::vector<Condition> operands;       ///< of All, Any, Not
};

/// "height of pole >= 6 m", as people read it in explanations.
std::string describe(const Condition& condition);
/// True when the condition ties `subject` to a bound name closely enough that candidates can be looked up by it: a
/// relation, a share of adjacency, or a distance with an upper bound.
bool looksNearby(const Condition& condition, std::string_view subject);
std::string_view symbolOf(Comparison comparison);
std::string_view nameOf(PairMeasure measure);
/// "m", "m2", "m3", "deg", or empty.
std::string_view unitOf(Dimension dimension);

}  // namespace cluxel
