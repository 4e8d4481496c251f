// SPDX-License-Identifier: Apache-2.0
// Every claim is weighed before any is granted, so that who came first does not matter.
#include "reasoning/absorbing.hpp"

#include <algorithm>

#include "reasoning/candidate_search.hpp"
#include "reasoning/pair_measures.hpp"

namespace cluxel {

namespace {

constexpr int kRounds = 3;  // what an absorbed piece brings near may follow it, but not through the whole map

struct Claim {
  PieceIndex piece = 0;
  std::size_t object = 0;
  const AbsorbSpec* spec = nullptr;
  double share = 0, gap = 0;
};

class Absorbing {
 public:
  Absorbing(ReasoningState& state, std::size_t first, bool late) : state_(state), first_(first), late_(late) {
    for (std::size_t i = first; i < state.objects.size(); ++i) budget_.push_back(pointsOf(state.objects[i]));
    absorbed_.resize(budget_.size(), 0);
  }

  void run() {
    for (int round = 0; round < kRounds; ++round)
      if (!grant(weigh())) break;
  }

 private:
  double pointsOf(const ObjectInMaking& object) const {
    double points = 0;
    for (PieceIndex piece : state_.piecesOf(object)) points += state_.pieces.shapeOf(piece).points;
    return points;
  }

  /// The first member in canonical order names an object, whatever its number.
  PieceIndex firstMember(std::size_t object) const {
    const auto pieces = state_.piecesOf(state_.objects[object]);
    return *std::min_element(pieces.begin(), pieces.end(),
                             [this](PieceIndex a, PieceIndex b) { return state_.pieces.before(a, b); });
  }

  bool isBetter(const Claim& a, const Claim& b) const {
    if (a.share != b.share) return a.share > b.share;
    if (a.gap != b.gap) return a.gap < b.gap;
    return a.object != b.object && state_.pieces.before(firstMember(a.object), firstMember(b.object));
  }

  std::vector<Claim> weigh() const {
    std::map<PieceIndex, Claim> best;
    for (std::size_t i = first_; i < state_.objects.size(); ++i) {
      const ObjectInMaking& object = state_.objects[i];
      if (state_.piecesOf(object).empty()) continue;
      for (const AbsorbSpec& spec : object.leaf->absorb)
        if (spec.late == late_) weighSpec(i, spec, best);
    }
    std::vector<Claim> claims;
    for (const auto& [piece, claim] : best) claims.push_back(claim);
    std::sort(claims.begin(), claims.end(), [this](const Claim& a, const Claim& b) {
      if (a.share != b.share) return a.share > b.share;
      if (a.gap != b.gap) return a.gap < b.gap;
      return state_.pieces.before(a.piece, b.piece);
    });
    return claims;
  }

  void weighSpec(std::size_t number, const AbsorbSpec& spec, std::map<PieceIndex, Claim>& best) const {
    const ObjectInMaking& object = state_.objects[number];
    const Thing whole = state_.pieces.thingOf(state_.piecesOf(object));
    auto wanted = [&](PieceIndex piece) {
      if (state_.pieces[piece].owner != kFree) return false;
      const PrimitiveLabel label = state_.pieces.labelOf(piece);
      return spec.labels.empty() || std::find(spec.labels.begin(), spec.labels.end(), label) != spec.labels.end();
    };
    for (PieceIndex piece : findPassing(state_, *object.rule, spec.when, "it", object.bindings, wanted)) {
      const Thing it = state_.pieces.thingOf({piece});
      Claim claim{piece, number, &spec, measurePair(state_, PairMeasure::AdjacentFraction, it, whole), 0};
      if (claim.share == 0) claim.gap = measurePair(state_, PairMeasure::Gap, it, whole, 5.0);
      const auto [entry, fresh] = best.try_emplace(piece, claim);
      if (!fresh && isBetter(claim, entry->second)) entry->second = claim;
    }
  }

  bool grant(const std::vector<Claim>& claims) {
    bool any = false;
    for (const Claim& claim : claims) {
      ObjectInMaking& object = state_.objects[claim.object];
      const double points = state_.pieces.shapeOf(claim.piece).points;
      double& so_far = absorbed_[claim.object - first_];
      if (so_far + points > claim.spec->max_fraction_of_points * budget_[claim.object - first_]) continue;
      so_far += points;
      state_.pieces.setOwner(claim.piece, static_cast<OwnerIndex>(claim.object));
      addTo(object, claim);
      any = true;
    }
    return any;
  }

  void addTo(ObjectInMaking& object, const Claim& claim) {
    for (PartInMaking& part : object.parts) {
      if (part.name != claim.spec->into) continue;
      part.pieces.push_back(claim.piece);
      if (Thing* thing = object.bindings.find(part.name)) *thing = state_.pieces.thingOf(part.pieces);
      return;
    }
    object.parts.front().pieces.push_back(claim.piece);
  }

  ReasoningState& state_;
  std::size_t first_;
  bool late_;
  std::vector<double> budget_, absorbed_;
};

}  // namespace

void absorbMisfits(ReasoningState& state, std::size_t first, bool late) {
  Absorbing(state, first, late).run();
}

}  // namespace cluxel
