// SPDX-License-Identifier: Apache-2.0
// A find costs what is near it, never the whole scene.
#include "reasoning/candidate_search.hpp"

#include <algorithm>

#include "reasoning/condition_eval.hpp"
#include "reasoning/pair_measures.hpp"

namespace cluxel {

namespace {

void addPieces(const ReasoningState& state, PrimitiveIndex primitive, std::vector<PieceIndex>& found) {
  const auto& pieces = state.pieces.piecesOf(primitive);
  found.insert(found.end(), pieces.begin(), pieces.end());
}

void addRelated(const ReasoningState& state, RelationKind kind, const Thing& anchor, std::vector<PieceIndex>& found) {
  for (PieceIndex piece : anchor.pieces) {
    const PrimitiveIndex primitive = state.pieces[piece].primitive;
    addPieces(state, primitive, found);
    for (std::uint32_t number : state.relations_to[primitive])
      if (state.scene.relations[number].kind == kind) addPieces(state, state.scene.relations[number].from, found);
  }
}

void addAdjacent(const ReasoningState& state, const Thing& anchor, std::vector<PieceIndex>& found) {
  for (PieceIndex piece : anchor.pieces)
    for (std::uint32_t cluxel : state.pieces[piece].cluxels)
      for (std::uint32_t neighbour : state.scene.cluxels.neighbours(cluxel)) {
        const PieceIndex other = state.pieces.pieceOf(neighbour);
        if (found.empty() || found.back() != other) found.push_back(other);
      }
}

void addNear(const ReasoningState& state, const Condition& tie, const Thing& anchor, std::vector<PieceIndex>& found) {
  const double within = tie.upper ? tie.upper->value : tie.value->value;
  // The axis distance is measured from the centroid, which may be far from the nearest cluxel.
  const double reach = within + (tie.measure == PairMeasure::AxisDistance ? 5.0 : 0.0);
  for (PrimitiveIndex primitive : state.grid.primitivesNear(state.pieces.cluxelsOf(anchor), reach))
    addPieces(state, primitive, found);
}

}  // namespace

std::vector<PieceIndex> candidatesFor(const ReasoningState& state, const std::vector<Condition>& conditions,
                                      const std::string& name, const Bindings& bindings,
                                      const std::function<bool(PieceIndex)>& wanted) {
  std::vector<PieceIndex> found;
  const auto tie =
      std::find_if(conditions.begin(), conditions.end(), [&](const Condition& c) { return looksNearby(c, name); });
  if (tie == conditions.end()) return found;
  const Thing& anchor = bindings.at(tie->target->name);
  if (tie->kind == Condition::Kind::Relation)
    addRelated(state, tie->relation, anchor, found);
  else if (tie->measure == PairMeasure::AdjacentFraction)
    addAdjacent(state, anchor, found);
  else
    addNear(state, *tie, anchor, found);
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  std::erase_if(found, [&](PieceIndex piece) { return !wanted(piece); });
  std::sort(found.begin(), found.end(), [&](PieceIndex a, PieceIndex b) { return state.pieces.before(a, b); });
  return found;
}

std::vector<PieceIndex> findPassing(const ReasoningState& state, const Rule& rule,
                                    const std::vector<Condition>& conditions, const std::string& name,
                                    const Bindings& bindings, const std::function<bool(PieceIndex)>& wanted) {
  std::vector<PieceIndex> passing;
  Bindings with_candidate = bindings;
  with_candidate.things.emplace_back(name, Thing{});
  for (PieceIndex piece : candidatesFor(state, conditions, name, bindings, wanted)) {
    with_candidate.things.back().second = state.pieces.thingOf({piece});
    if (ConditionEvaluator(state, rule, with_candidate).allHold(conditions)) passing.push_back(piece);
  }
  return passing;
}

std::vector<PieceIndex> choose(const ReasoningState& state, Choice choice, const std::vector<PieceIndex>& candidates,
                               const Thing* nearest_to) {
  if (choice == Choice::All) return candidates;
  auto value = [&](PieceIndex piece) {
    const Shape& shape = state.pieces.shapeOf(piece);
    switch (choice) {
      case Choice::MostPoints:
        return shape.points;
      case Choice::Highest:
        return shape[Attribute::Top];
      case Choice::Lowest:
        return -shape[Attribute::Bottom];
      case Choice::Nearest:
        return nearest_to == nullptr
                   ? 0.0
                   : -measurePair(state, PairMeasure::Gap, state.pieces.thingOf({piece}), *nearest_to);
      case Choice::MostAdjacent:
        return nearest_to == nullptr
                   ? 0.0
                   : measurePair(state, PairMeasure::AdjacentFraction, state.pieces.thingOf({piece}), *nearest_to);
      default:
        return shape[Attribute::Volume];
    }
  };
  PieceIndex best = candidates.front();
  double best_value = value(best);
  for (PieceIndex piece : candidates) {
    const double mine = value(piece);
    if (mine > best_value || (mine == best_value && piece != best && state.pieces.before(piece, best))) {
      best = piece;
      best_value = mine;
    }
  }
  return {best};
}

}  // namespace cluxel
