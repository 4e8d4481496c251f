// SPDX-License-Identifier: Apache-2.0
// Hands the claims of a class to the parting of crowns, and cuts the pieces along its outcome.
#include "reasoning/shared_parting.hpp"

#include <algorithm>

#include "reasoning/crown_parting.hpp"

namespace cluxel {

namespace {

class SharedParting {
 public:
  explicit SharedParting(ReasoningState& state) : state_(state) {}

  void run() {
    if (state_.claims.empty()) return;
    orderClaimants();
    for (const auto& [piece, owners] : state_.claims)
      crown_.insert(crown_.end(), state_.pieces[piece].cluxels.begin(), state_.pieces[piece].cluxels.end());
    std::sort(crown_.begin(), crown_.end());
    const auto sources = makeSources();
    taken_ = partCrown(state_.scene.cluxels, crown_, sources);
    const auto claims = std::move(state_.claims);
    state_.claims.clear();
    for (const auto& [piece, owners] : claims) cutPiece(piece);
    for (OwnerIndex owner : claimants_) renew(state_.objects[owner]);
  }

 private:
  const PartingSpec& specOf(OwnerIndex owner) const { return *state_.objects[owner].leaf->parting; }

  const PartInMaking& partOf(OwnerIndex owner, const std::string& name) const {
    const auto& parts = state_.objects[owner].parts;
    return *std::find_if(parts.begin(), parts.end(), [&](const PartInMaking& part) { return part.name == name; });
  }

  /// Claimants in the order of their trunks, so that ties do not depend on who was accepted first.
  void orderClaimants() {
    for (const auto& [piece, owners] : state_.claims) claimants_.insert(claimants_.end(), owners.begin(), owners.end());
    std::sort(claimants_.begin(), claimants_.end());
    claimants_.erase(std::unique(claimants_.begin(), claimants_.end()), claimants_.end());
    // What is bound for reference only, as the trunk of another object, is no part: nothing can begin there.
    std::erase_if(claimants_, [this](OwnerIndex owner) { return partOf(owner, specOf(owner).from).pieces.empty(); });
    auto trunk = [this](OwnerIndex owner) {
      const auto& pieces = partOf(owner, specOf(owner).from).pieces;
      return *std::min_element(pieces.begin(), pieces.end(),
                               [this](PieceIndex a, PieceIndex b) { return state_.pieces.before(a, b); });
    };
    std::sort(claimants_.begin(), claimants_.end(),
              [&](OwnerIndex a, OwnerIndex b) { return a != b && state_.pieces.before(trunk(a), trunk(b)); });
  }

  std::vector<CrownSource> makeSources() const {
    std::vector<CrownSource> sources;
    for (OwnerIndex owner : claimants_) {
      const PartingSpec& spec = specOf(owner);
      CrownSource source;
      Thing trunk;
      trunk.pieces = partOf(owner, spec.from).pieces;
      source.trunk = state_.pieces.cluxelsOf(trunk);
      source.reach_m = spec.reach_m;
      source.jump_m = spec.jump_m;
      source.start_m = spec.start_m;
      source.clearance_m = spec.clearance_m;
      source.may_take = [this, owner](std::uint32_t cluxel) {
        const auto claim = state_.claims.find(state_.pieces.pieceOf(cluxel));
        return claim != state_.claims.end() &&
               std::find(claim->second.begin(), claim->second.end(), owner) != claim->second.end();
      };
      sources.push_back(std::move(source));
    }
    return sources;
  }

  void cutPiece(PieceIndex piece) {
    std::vector<std::vector<std::uint32_t>> parts(claimants_.size());
    std::vector<std::uint32_t> rest;
    for (std::uint32_t cluxel : state_.pieces[piece].cluxels) {
      const auto place = std::lower_bound(crown_.begin(), crown_.end(), cluxel) - crown_.begin();
      const std::uint32_t source = taken_[static_cast<std::size_t>(place)];
      (source == kNoSource ? rest : parts[source]).push_back(cluxel);
    }
    std::vector<OwnerIndex> owners;
    std::vector<std::vector<std::uint32_t>> kept;
    for (std::size_t s = 0; s < parts.size(); ++s) {
      if (parts[s].empty()) continue;
      owners.push_back(claimants_[s]);
      kept.push_back(std::move(parts[s]));
    }
    for (auto& bunch : connectedBunches(state_.scene.cluxels, rest)) kept.push_back(std::move(bunch));
    const auto made = state_.pieces.cut(piece, std::move(kept));
    for (std::size_t i = 0; i < owners.size(); ++i) {
      state_.pieces.setOwner(made[i], owners[i]);
      auto& parts_of_owner = state_.objects[owners[i]].parts;
      for (PartInMaking& part : parts_of_owner)
        if (part.name == specOf(owners[i]).part) part.pieces.push_back(made[i]);
    }
  }

  /// Drops pieces that were cut, and measures what the names are bound to anew.
  void renew(ObjectInMaking& object) {
    for (PartInMaking& part : object.parts) {
      std::erase_if(part.pieces, [this](PieceIndex piece) { return !state_.pieces[piece].alive; });
      if (Thing* thing = object.bindings.find(part.name)) *thing = state_.pieces.thingOf(part.pieces);
    }
  }

  ReasoningState& state_;
  std::vector<OwnerIndex> claimants_;
  std::vector<std::uint32_t> crown_, taken_;
};

}  // namespace

void partShared(ReasoningState& state) {
  SharedParting(state).run();
}

}  // namespace cluxel
