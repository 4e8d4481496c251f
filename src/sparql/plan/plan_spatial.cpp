// SPDX-License-Identifier: Apache-2.0
// Spatial filters: the R-tree gives candidate literals, which the filter then tests exactly.
#include <algorithm>
#include <cmath>

#include "rdf/store/geometry_index.hpp"
#include "rdf/vocabulary.hpp"
#include "sparql/geometry/geometry.hpp"
#include "sparql/plan/planner.hpp"
#include "sparql/plan/range_finder.hpp"

namespace cluxel::sparql {
namespace {

using Kind = Expr::Kind;

/// The index is used when it keeps at most this fraction of its geometries.
constexpr double kWorthUsing = 0.25;

/// Boxes that a geometry must meet one of.
struct Search {
  Slot slot = kNoSlot;
  std::vector<rdf::FlatBox> boxes;
};

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

/// The test of a slot against a constant geometry and a constant distance.
std::optional<Search> searchBy(const RangeTest& test, const QueryTerms& terms) {
  double by_m = 0;
  for (const RowSum::Part& part : test.bound.parts) {
    const Expr& limit = part.expression;
    if (limit.kind != Kind::Constant || !limit.constant.isNumeric()) return std::nullopt;
    by_m += part.is_negative ? -limit.constant.number : limit.constant.number;
  }
  if (test.place->kind != Kind::Constant || test.place->constant.id == kUnbound) return std::nullopt;
  const rdf::TermView literal = terms.view(test.place->constant.id);
  if (literal.datatype != std::string(rdf::vocabulary::kGeo) + "wktLiteral") return std::nullopt;
  const auto geometry = parseWkt(literal.text);
  if (!geometry || namesReferenceSystem(*geometry)) return std::nullopt;
  const Box2 box = planeBoxOf(*geometry);
  if (!std::isfinite(box.min_x) || !std::isfinite(by_m)) return std::nullopt;
  const Box2 wide = widened(box, by_m);
  return Search{test.slot, {rdf::FlatBox::around(wide.min_x, wide.min_y, wide.max_x, wide.max_y)}};
}

std::optional<Search> searchOf(const Expr& condition, const Node& group, const SlotSet& slots,
                               const QueryTerms& terms) {
  if (condition.kind == Kind::Or) {
    std::optional<Search> any;
    for (const Expr& argument : condition.arguments) {
      auto one = searchOf(argument, group, slots, terms);
      if (!one || (any && any->slot != one->slot)) return std::nullopt;
      if (any) one->boxes.insert(one->boxes.end(), any->boxes.begin(), any->boxes.end());
      any = std::move(one);
    }
    return any;
  }
  Expr whole = condition;
  for (Expr& argument : whole.arguments) argument = resolved(argument, group);
  for (const RangeTest& test : rangeTestsOf(whole, {{}, slots}, terms)) {
    if (test.kind != RangeTest::Kind::Near) continue;
    if (auto search = searchBy(test, terms)) return search;
  }
  return std::nullopt;
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

/// Adds the candidate literals as VALUES to the parts, if they are a small fraction of all.
void Planner::searchBySpace(const Expr& condition, const Node& child, Parts& parts) {
  const auto search = searchOf(condition, child, child.certain, terms_);
  if (!search || predicateOf(child, search->slot) == kUnbound) return;
  const auto index = reader_.geometries();
  std::vector<rdf::TermId> found;
  for (const rdf::FlatBox& box : search->boxes) {
    const std::vector<rdf::TermId> more = index->meeting(box);
    std::vector<rdf::TermId> both;
    std::set_union(found.begin(), found.end(), more.begin(), more.end(), std::back_inserter(both));
    found = std::move(both);
  }
  if (static_cast<double>(found.size()) > kWorthUsing * static_cast<double>(index->size())) return;
  NodePtr values = makeNode(Node::Kind::Values, condition.at);
  values->slots = {search->slot};
  values->rows = {found.size(), found};
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
