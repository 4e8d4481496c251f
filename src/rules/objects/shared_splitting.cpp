// SPDX-License-Identifier: Apache-2.0
// Collects the claims on shared fragments, splits the crown among the trunks, and cuts the fragments accordingly.
#include "rules/objects/shared_splitting.hpp"

#include <algorithm>
#include <set>

#include "base/disjoint_sets.hpp"
#include "base/radix_order.hpp"
#include "rules/objects/crown_splitting.hpp"

namespace cluxel::rules {

namespace {

class SharedSplitting {
 public:
  explicit SharedSplitting(ReasoningState& state) : state_(state) {}

  void run() {
    if (state_.claims.empty()) return;
    state_.trace.enter(mixed(StepKind::Split, std::uint64_t{0}));
    noteClaims();
    orderClaimants();
    for (const auto& [fragment, owners] : state_.claims)
      crown_.insert(crown_.end(), state_.fragments[fragment].cluxels.begin(), state_.fragments[fragment].cluxels.end());
    sortNumbers(crown_);
    owners_of_.resize(state_.fragments.size(), nullptr);
    for (const auto& [fragment, owners] : state_.claims) owners_of_[fragment] = &owners;
    const auto sources = makeSources();
    taken_ = splitCrown(state_.scene.cluxels, crown_, sources, state_.threads(), state_.context.splits);
    const auto claims = std::move(state_.claims);
    state_.claims.clear();
    for (const auto& [fragment, owners] : claims) cutFragment(fragment);
    for (OwnerIndex owner : claimants_) renew(state_.objects[owner]);
  }

 private:
  const SplittingSpec& specOf(OwnerIndex owner) const { return *state_.objects[owner].leaf->splitting; }

  const PartInMaking& partOf(OwnerIndex owner, const std::string& name) const {
    const auto& parts = state_.objects[owner].parts;
    return *std::find_if(parts.begin(), parts.end(), [&](const PartInMaking& part) { return part.name == name; });
  }

  /// What claims connect is split in one step, of which the trunks and the crowns are members.
  void noteClaims() {
    DisjointSets sets(state_.objects.size());
    for (const auto& [fragment, owners] : state_.claims)
      for (const OwnerIndex owner : owners) sets.join(owners.front(), owner);
    struct Connected {
      std::uint64_t trace = 0;
      std::vector<MemberSet> members;
    };
    std::map<std::uint32_t, Connected> connected;
    std::set<OwnerIndex> claimants;
    for (const auto& [fragment, owners] : state_.claims) {
      Connected& with = connected[sets.find(owners.front())];
      for (const OwnerIndex owner : owners) {
        if (claimants.insert(owner).second) with.trace += mixed(StepKind::Split, state_.objects[owner].trace);
        with.trace += mixed(state_.fragments.hashOf(fragment), state_.objects[owner].trace);
        with.members.push_back(state_.objects[owner].members);
      }
      with.members.push_back(state_.fragments[fragment].primitive);
    }
    for (const auto& [fragment, owners] : state_.claims)
      state_.trace.note(state_.fragments[fragment].primitive,
                        mixed(StepKind::Split, connected[sets.find(owners.front())].trace));
    for (const OwnerIndex owner : claimants)
      state_.noteGrowth(state_.objects[owner], connected[sets.find(owner)].trace, kNobody);
    for (auto& [root, with] : connected) state_.trace.keep(state_.trace.unionOf(std::move(with.members)));
  }

  /// Sorts claimants by their trunks in canonical order, so that ties do not depend on the order of acceptance.
  void orderClaimants() {
    for (const auto& [fragment, owners] : state_.claims)
      claimants_.insert(claimants_.end(), owners.begin(), owners.end());
    std::sort(claimants_.begin(), claimants_.end());
    claimants_.erase(std::unique(claimants_.begin(), claimants_.end()), claimants_.end());
    // A trunk that is bound for reference only belongs to another object and cannot be a source.
    std::erase_if(claimants_, [this](OwnerIndex owner) { return partOf(owner, specOf(owner).from).fragments.empty(); });
    auto trunk = [this](OwnerIndex owner) {
      const auto& fragments = partOf(owner, specOf(owner).from).fragments;
      return *std::min_element(fragments.begin(), fragments.end(),
                               [this](FragmentIndex a, FragmentIndex b) { return state_.fragments.before(a, b); });
    };
    std::sort(claimants_.begin(), claimants_.end(),
              [&](OwnerIndex a, OwnerIndex b) { return a != b && state_.fragments.before(trunk(a), trunk(b)); });
  }

  std::vector<CrownSource> makeSources() const {
    std::vector<CrownSource> sources;
    for (OwnerIndex owner : claimants_) {
      const SplittingSpec& spec = specOf(owner);
      CrownSource source;
      Candidate trunk;
      trunk.fragments = partOf(owner, spec.from).fragments;
      source.trunk = state_.fragments.cluxelsOf(trunk);
      source.reach_m = spec.reach_m;
      source.jump_m = spec.jump_m;
      source.start_m = spec.start_m;
      source.clearance_m = spec.clearance_m;
      source.may_take = [this, owner](std::uint32_t cluxel) {
        const std::vector<OwnerIndex>* owners = owners_of_[state_.fragments.fragmentOf(cluxel)];
        return owners != nullptr && std::find(owners->begin(), owners->end(), owner) != owners->end();
      };
      sources.push_back(std::move(source));
    }
    return sources;
  }

  void cutFragment(FragmentIndex fragment) {
    std::vector<std::vector<std::uint32_t>> parts(claimants_.size());
    std::vector<std::uint32_t> rest;
    for (std::uint32_t cluxel : state_.fragments[fragment].cluxels) {
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
    const auto made = state_.cut(fragment, std::move(kept));
    for (std::size_t i = 0; i < owners.size(); ++i) {
      state_.setOwner(made[i], owners[i]);
      state_.noteGrowth(state_.objects[owners[i]], state_.fragments.hashOf(made[i]),
                        state_.fragments[made[i]].primitive);
      auto& parts_of_owner = state_.objects[owners[i]].parts;
      for (PartInMaking& part : parts_of_owner)
        if (part.name == specOf(owners[i]).part) part.fragments.push_back(made[i]);
    }
  }

  /// Drops fragments that were cut.
  void renew(ObjectInMaking& object) {
    object.may_gather = true;
    for (PartInMaking& part : object.parts) {
      std::erase_if(part.fragments, [this](FragmentIndex fragment) { return !state_.fragments[fragment].alive; });
      part.is_outdated = true;
    }
  }

  ReasoningState& state_;
  std::vector<OwnerIndex> claimants_;
  std::vector<std::uint32_t> crown_, taken_;
  std::vector<const std::vector<OwnerIndex>*> owners_of_;  ///< by fragment; null where none claims it
};

}  // namespace

void splitShared(ReasoningState& state) {
  SharedSplitting(state).run();
}

}  // namespace cluxel::rules
