// SPDX-License-Identifier: Apache-2.0
// Spatial filters: the R-tree gives candidate literals, which the filter then tests exactly.
#include <algorithm>
#include <cmath>

#include "rdf/vocabulary.hpp"
#include "sparql/exec/geometry_index.hpp"
#include "sparql/functions/function_bodies.hpp"
#include "sparql/functions/geometry.hpp"
#include "sparql/plan/planner.hpp"

namespace cluxel::sparql {
namespace {

using Kind = Expr::Kind;

/// The R-tree is built when the filter would test at least this fraction of its literals, and used when it keeps at
/// most this fraction.
constexpr double kWorthMaking = 0.25, kWorthUsing = 0.25;

/// The condition of a filter on the bounding box of the geometry in `slot`.
struct Search {
  Slot slot = kNoSlot;
  Box2 box;
};

/// Grows the box by more than the rounding tolerance of the relations.
Box2 widened(Box2 box, double by_m) {
  const double size = std::max({std::abs(box.min_x), std::abs(box.min_y), std::abs(box.max_x), std::abs(box.max_y)});
  const double margin = by_m * (1 + 1e-9) + 1e-6 + size * 1e-9;
  return {box.min_x - margin, box.min_y - margin, box.max_x + margin, box.max_y + margin};
}

/// Matches calls with one variable and one constant geometry.
std::optional<Search> searchBy(const Expr& call, double by_m, const QueryTerms& terms) {
  if (call.arguments.size() < 2) return std::nullopt;
  const bool first = call.arguments[0].kind == Kind::Slot;
  const Expr& variable = call.arguments[first ? 0 : 1];
  const Expr& constant = call.arguments[first ? 1 : 0];
  if (variable.kind != Kind::Slot || constant.kind != Kind::Constant || constant.constant.id == kUnbound)
    return std::nullopt;
  const rdf::TermView literal = terms.view(constant.constant.id);
  if (literal.datatype != std::string(rdf::vocabulary::kGeo) + "wktLiteral") return std::nullopt;
  const auto geometry = parseWkt(literal.text);
  if (!geometry) return std::nullopt;
  const Box2 box = boundsOf(*geometry);
  if (!std::isfinite(box.min_x) || !std::isfinite(by_m)) return std::nullopt;
  return Search{variable.slot, widened(box, std::max(by_m, 0.0))};
}

bool isCallOf(const Expr& expression, FunctionBody body) {
  return expression.kind == Kind::Call && expression.function != nullptr && expression.function->body == body;
}

/// Replaces a slot by the expression of its BIND.
const Expr& resolved(const Expr& expression, const Node& group) {
  if (expression.kind != Kind::Slot) return expression;
  for (const Node* node = &group; !node->children.empty(); node = node->children[0].get()) {
    if (node->kind == Node::Kind::Extend && node->slot == expression.slot) return *node->expression;
    // If the BIND fails, a surrounding OPTIONAL could bind the variable to another value.
    const bool passes =
        node->kind == Node::Kind::Extend || node->kind == Node::Kind::Filter || node->kind == Node::Kind::Minus;
    if (!passes) break;
  }
  return expression;
}

std::optional<Search> searchOf(const Expr& condition, const Node& group, const QueryTerms& terms) {
  for (const FunctionBody body : {sfIntersectsFunction, sfWithinFunction, sfContainsFunction, sfTouchesFunction}) {
    if (isCallOf(condition, body)) return searchBy(condition, 0, terms);
  }
  const bool less = condition.kind == Kind::Less || condition.kind == Kind::LessEqual;
  const bool greater = condition.kind == Kind::Greater || condition.kind == Kind::GreaterEqual;
  if (!less && !greater) return std::nullopt;
  const Expr& distance = resolved(condition.arguments[less ? 0 : 1], group);
  const Expr& limit = condition.arguments[less ? 1 : 0];
  if (!isCallOf(distance, geoDistanceFunction) || limit.kind != Kind::Constant || !limit.constant.isNumeric())
    return std::nullopt;
  return searchBy(distance, limit.constant.number, terms);
}

/// The predicate of a mandatory pattern whose object is the slot; kUnbound if there is none.
ValueId predicateOf(const Node& node, Slot slot) {
  switch (node.kind) {
    case Node::Kind::Triple: {
      const TripleNode& triple = node.triple;
      const bool fits = !triple.path && triple.object.slot == slot && !triple.predicate.isSlot();
      return fits && triple.predicate.constant < kFirstComputed ? triple.predicate.constant : kUnbound;
    }
    case Node::Kind::Join:
      for (const NodePtr& child : node.children) {
        if (const ValueId found = predicateOf(*child, slot); found != kUnbound) return found;
      }
      return kUnbound;
    case Node::Kind::Filter:
    case Node::Kind::Extend:
    case Node::Kind::LeftJoin:
    case Node::Kind::Minus:
      return predicateOf(*node.children[0], slot);
    default:
      return kUnbound;
  }
}

}  // namespace

/// Adds the candidate literals as VALUES to the parts, if they are a small fraction of the predicate's literals.
void Planner::searchBySpace(const Expr& condition, const Node& child, Parts& parts) {
  const auto search = searchOf(condition, child, terms_);
  if (!search) return;
  const ValueId predicate = predicateOf(child, search->slot);
  if (predicate == kUnbound) return;
  auto index = knownGeometryIndex(reader_, predicate);
  if (!index) {
    rdf::QuadPattern all;
    all.p = predicate;
    if (cardinality_.rows(child) < kWorthMaking * static_cast<double>(reader_.estimate(all))) return;
    index = geometryIndex(reader_, predicate);
  }
  const std::vector<rdf::TermId> found = index->meeting(search->box);
  if (static_cast<double>(found.size()) > kWorthUsing * static_cast<double>(index->size())) return;
  NodePtr values = makeNode(Node::Kind::Values, condition.at);
  values->slots = {search->slot};
  for (const rdf::TermId id : found) values->rows.push_back({id});
  values->note =
      "R-tree, " + std::to_string(found.size()) + " of " + std::to_string(index->size()) + " boxes meet the filter's:";
  values->annotate();
  // With no rows, annotate() would conclude that the variable is never bound.
  values->possible.add(search->slot);
  values->certain.add(search->slot);
  parts.joined.push_back(values.get());
  parts.made.push_back(std::move(values));
}

}  // namespace cluxel::sparql
