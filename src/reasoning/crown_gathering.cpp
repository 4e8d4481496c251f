// SPDX-License-Identifier: Apache-2.0
// Every round looks at all fragments before any is handed out, so that who came first does not matter.
#include "reasoning/crown_gathering.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <optional>

#include "reasoning/crown_parting.hpp"

namespace cluxel {

namespace {

class Gathering {
 public:
  Gathering(ReasoningState& state, const std::string& class_iri) : state_(state) {
    for (OwnerIndex owner = 0; owner < state.objects.size(); ++owner) {
      const ObjectInMaking& object = state.objects[owner];
      if (object.rule->class_iri != class_iri || !object.leaf->parting || !object.leaf->parting->gather) continue;
      if (const PartInMaking* from = partOf(object, object.leaf->parting->from)) add(owner, *from);
    }
    std::sort(gatherers_.begin(), gatherers_.end(), [this](const Gatherer& a, const Gatherer& b) {
      return a.owner != b.owner && state_.pieces.before(a.first_piece, b.first_piece);
    });
  }

  void run() {
    while (!gatherers_.empty()) {
      const std::vector<Fragment> fragments = reached();
      if (fragments.empty()) break;
      bool any = false;
      for (const Fragment& fragment : fragments) any = hand(fragment) || any;
      if (!any) break;
    }
    for (const Gatherer& gatherer : gatherers_) renew(gatherer);
  }

 private:
  struct Gatherer {
    OwnerIndex owner = 0;
    PieceIndex first_piece = 0;  ///< the first of its `from` in canonical order
    const PartingSpec* spec = nullptr;
    Eigen::Vector2d top = Eigen::Vector2d::Zero();
    std::vector<PrimitiveLabel> labels;  ///< of what was parted
  };
  struct Fragment {
    PieceIndex piece = 0;
    std::map<std::size_t, double> near;  ///< number in gatherers_ → gap to its object [m]
  };

  static const PartInMaking* partOf(const ObjectInMaking& object, const std::string& name) {
    for (const PartInMaking& part : object.parts)
      if (part.name == name && !part.pieces.empty()) return &part;
    return nullptr;
  }

  void add(OwnerIndex owner, const PartInMaking& from) {
    Gatherer gatherer{owner, from.pieces.front(), &*state_.objects[owner].leaf->parting, {}, {}};
    for (PieceIndex piece : from.pieces)
      if (state_.pieces.before(piece, gatherer.first_piece)) gatherer.first_piece = piece;
    Thing foot;
    foot.pieces = from.pieces;
    gatherer.top = topOf(state_.scene.cluxels, state_.pieces.cluxelsOf(foot));
    if (const PartInMaking* crown = partOf(state_.objects[owner], gatherer.spec->part))
      for (PieceIndex piece : crown->pieces) gatherer.labels.push_back(state_.pieces.labelOf(piece));
    gatherers_.push_back(std::move(gatherer));
  }

  bool mayTake(const Gatherer& gatherer, PieceIndex piece) const {
    return state_.pieces.shapeOf(piece)[Attribute::Bottom] >= gatherer.spec->gather->above_m &&
           std::find(gatherer.labels.begin(), gatherer.labels.end(), state_.pieces.labelOf(piece)) !=
               gatherer.labels.end();
  }

  /// The free pieces that gatherers come near to, as things stand.
  std::vector<Fragment> reached() const {
    std::vector<std::vector<std::size_t>> of_owner(state_.objects.size());
    for (std::size_t g = 0; g < gatherers_.size(); ++g) of_owner[gatherers_[g].owner].push_back(g);
    std::vector<Fragment> fragments;
    for (PieceIndex piece = 0; piece < state_.pieces.size(); ++piece) {
      if (!state_.pieces[piece].alive || state_.pieces[piece].owner != kFree) continue;
      Fragment fragment{piece, {}};
      double widest = 0;
      for (const Gatherer& gatherer : gatherers_)
        if (mayTake(gatherer, piece)) widest = std::max(widest, gatherer.spec->gather->within_m);
      if (widest == 0) continue;
      for (std::uint32_t cluxel : state_.pieces[piece].cluxels)
        state_.grid.near(cluxel, widest, [&](std::uint32_t other) {
          const OwnerIndex owner = state_.pieces[state_.pieces.pieceOf(other)].owner;
          if (owner >= of_owner.size()) return;
          for (std::size_t g : of_owner[owner]) consider(g, cluxel, other, fragment);
        });
      if (!fragment.near.empty()) fragments.push_back(std::move(fragment));
    }
    std::sort(fragments.begin(), fragments.end(), [this](const Fragment& a, const Fragment& b) {
      return a.piece != b.piece && state_.pieces.before(a.piece, b.piece);
    });
    return fragments;
  }

  void consider(std::size_t number, std::uint32_t cluxel, std::uint32_t other, Fragment& fragment) const {
    const Gatherer& gatherer = gatherers_[number];
    if (!mayTake(gatherer, fragment.piece)) return;
    const double gap = gapBetween(state_.scene.cluxels, cluxel, other).gap();
    if (gap > gatherer.spec->gather->within_m) return;
    double& smallest = fragment.near.try_emplace(number, gap).first->second;
    smallest = std::min(smallest, gap);
  }

  /// Cuts the fragment among those it is near to; false when it lies out of everybody's reach.
  bool hand(const Fragment& fragment) {
    std::map<std::size_t, std::vector<std::uint32_t>> parts;  // by gatherer
    std::vector<std::uint32_t> rest;
    for (std::uint32_t cluxel : state_.pieces[fragment.piece].cluxels) {
      const auto taker = nearestOf(fragment, cluxel);
      (taker ? parts[*taker] : rest).push_back(cluxel);
    }
    if (parts.empty()) return false;
    std::vector<std::vector<std::uint32_t>> kept;
    for (auto& [taker, cluxels] : parts) kept.push_back(std::move(cluxels));
    for (auto& bunch : connectedBunches(state_.scene.cluxels, rest)) kept.push_back(std::move(bunch));
    const auto made = state_.pieces.cut(fragment.piece, std::move(kept));
    std::size_t next = 0;
    for (const auto& [taker, cluxels] : parts) give(made[next++], gatherers_[taker], fragment.near.at(taker));
    return true;
  }

  /// Of those the fragment is near to and that reach the cluxel, the one with the nearest top in plan view.
  std::optional<std::size_t> nearestOf(const Fragment& fragment, std::uint32_t cluxel) const {
    double nearest = std::numeric_limits<double>::infinity();
    std::optional<std::size_t> taker;
    for (const auto& [number, gap] : fragment.near) {
      const double distance = (state_.scene.cluxels.center[cluxel].head<2>() - gatherers_[number].top).norm();
      if (distance <= gatherers_[number].spec->reach_m && distance < nearest) nearest = distance, taker = number;
    }
    return taker;
  }

  void give(PieceIndex piece, const Gatherer& gatherer, double gap_m) {
    state_.pieces.setOwner(piece, gatherer.owner);
    ObjectInMaking& object = state_.objects[gatherer.owner];
    for (PartInMaking& part : object.parts)
      if (part.name == gatherer.spec->part) part.pieces.push_back(piece);
    record(piece, gatherer, gap_m);
  }

  /// So that `explain` can say why the primitive is where it is.
  void record(PieceIndex piece, const Gatherer& gatherer, double gap_m) {
    const ObjectInMaking& object = state_.objects[gatherer.owner];
    const PartingSpec& spec = *gatherer.spec;
    Decision decision;
    decision.rule_id = object.rule->id;
    decision.seed = state_.pieces[piece].primitive;
    decision.seeds = {decision.seed};
    decision.accepted = true;
    decision.leaf = state_.decisions[object.decision].leaf;
    decision.reason = "gathered into " + spec.part + " of the " + state_.rules.shorten(object.rule->class_iri) +
                      " whose " + spec.from + " is nearest in plan view";
    DecisionStep step;
    step.rule_id = object.rule->id;
    step.test = "gap to the object <= gather's `within`";
    step.file = spec.at.file;
    step.line = spec.at.line;
    step.measured = gap_m;
    step.threshold = spec.gather->within_m;
    step.unit = "m";
    step.passed = true;
    decision.path.push_back(std::move(step));
    state_.decisions.push_back(std::move(decision));
  }

  void renew(const Gatherer& gatherer) {
    ObjectInMaking& object = state_.objects[gatherer.owner];
    const PartInMaking* crown = partOf(object, gatherer.spec->part);
    Thing* thing = object.bindings.find(gatherer.spec->part);
    if (crown != nullptr && thing != nullptr) *thing = state_.pieces.thingOf(crown->pieces);
  }

  ReasoningState& state_;
  std::vector<Gatherer> gatherers_;
};

}  // namespace

void gatherFragments(ReasoningState& state, const std::string& class_iri) {
  Gathering(state, class_iri).run();
}

}  // namespace cluxel
