// SPDX-License-Identifier: Apache-2.0
// All fragments are collected before any is assigned in a round: the result is independent of their order.
#include "rules/objects/crown_gathering.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "base/parallel.hpp"
#include "rules/objects/crown_splitting.hpp"
#include "rules/objects/fragment_gaps.hpp"

namespace cluxel::rules {

namespace {

class Gathering {
 public:
  Gathering(ReasoningState& state, const std::string& class_iri) : state_(state), class_iri_(class_iri) {
    for (OwnerIndex owner = 0; owner < state.objects.size(); ++owner) {
      ObjectInMaking& object = state.objects[owner];
      if (object.rule->class_iri != class_iri || !std::exchange(object.may_gather, false)) continue;
      if (!object.leaf->splitting->gather) continue;
      if (const PartInMaking* from = partOf(object, object.leaf->splitting->from)) add(owner, *from);
    }
    std::sort(gatherers_.begin(), gatherers_.end(), [this](const Gatherer& a, const Gatherer& b) {
      return a.owner != b.owner && state_.fragments.before(a.first_fragment, b.first_fragment);
    });
    of_owner_.resize(state.objects.size());
    for (std::size_t g = 0; g < gatherers_.size(); ++g) {
      of_owner_[gatherers_[g].owner].push_back(g);
      for (const scan::PrimitiveLabel label : gatherers_[g].labels) {
        const GatherSpec& spec = *gatherers_[g].spec->gather;
        const Demand demand{label, spec.above_m, spec.within_m};
        if (std::find(demands_.begin(), demands_.end(), demand) == demands_.end()) demands_.push_back(demand);
      }
    }
  }

  void run() {
    if (gatherers_.empty()) return;
    state_.trace.enter(mixed(StepKind::Gathered, hashOf(class_iri_)));
    const CluxelGrid theirs(state_.scene.cluxels, cluxelsOfGatherers());
    lookAround(0, theirs);
    for (std::uint64_t round = 1;; ++round) {
      state_.trace.enterRound(round);
      std::vector<FragmentIndex> given;
      const auto before = static_cast<FragmentIndex>(state_.fragments.size());
      for (const ReachedFragment& found : reached()) hand(found, given);
      if (given.empty()) break;
      lookAround(before, state_.grid);
      spreadFrom(given);
    }
    for (const Gatherer& gatherer : gatherers_)
      for (PartInMaking& part : state_.objects[gatherer.owner].parts)
        if (part.name == gatherer.spec->part) part.is_outdated = true;
  }

 private:
  struct Gatherer {
    OwnerIndex owner = 0;
    FragmentIndex first_fragment = 0;  ///< the first of its `from` in canonical order
    const SplittingSpec* spec = nullptr;
    std::uint64_t trace = 0;  ///< of the object
    Eigen::Vector2d top = Eigen::Vector2d::Zero();
    Eigen::AlignedBox3d bounds = {};           ///< of the boxes of the object's cluxels
    std::vector<scan::PrimitiveLabel> labels;  ///< of the split crown
  };
  /// A gatherer and its smallest gap to a fragment so far; at first the largest that counts.
  struct Nearing {
    std::size_t gatherer = 0;
    double gap_m = 0;
    bool is_near = false;
  };
  /// What some gatherer takes: fragments of a label, at or above a height, within a distance.
  struct Demand {
    scan::PrimitiveLabel label;
    double above_m = 0, within_m = 0;
    bool operator==(const Demand&) const = default;
  };
  struct ReachedFragment {
    FragmentIndex fragment = 0;
    std::map<std::size_t, double> near;  ///< number in gatherers_ → gap to its object [m]
  };

  static const PartInMaking* partOf(const ObjectInMaking& object, const std::string& name) {
    for (const PartInMaking& part : object.parts)
      if (part.name == name && !part.fragments.empty()) return &part;
    return nullptr;
  }

  void add(OwnerIndex owner, const PartInMaking& from) {
    const ObjectInMaking& object = state_.objects[owner];
    Gatherer gatherer{owner, from.fragments.front(), &*object.leaf->splitting, object.trace, {}, {}, {}};
    for (FragmentIndex fragment : from.fragments)
      if (state_.fragments.before(fragment, gatherer.first_fragment)) gatherer.first_fragment = fragment;
    Candidate foot;
    foot.fragments = from.fragments;
    gatherer.top = topOf(state_.scene.cluxels, state_.fragments.cluxelsOf(foot));
    if (const PartInMaking* crown = partOf(state_.objects[owner], gatherer.spec->part))
      for (FragmentIndex fragment : crown->fragments) gatherer.labels.push_back(state_.fragments.labelOf(fragment));
    for (const FragmentIndex fragment : state_.fragmentsOf(state_.objects[owner]))
      gatherer.bounds.extend(boundsOf(fragment));
    gatherers_.push_back(std::move(gatherer));
  }

  bool mayTake(const Gatherer& gatherer, FragmentIndex fragment) const {
    return state_.fragments.shapeOf(fragment)[perception::Attribute::Bottom] >= gatherer.spec->gather->above_m &&
           std::find(gatherer.labels.begin(), gatherer.labels.end(), state_.fragments.labelOf(fragment)) !=
               gatherer.labels.end();
  }

  bool isFree(FragmentIndex fragment) const {
    return state_.fragments[fragment].alive && state_.fragments[fragment].owner == kFree;
  }

  /// The gatherers of the object that owns the cluxel; null when there are none.
  const std::vector<std::size_t>* gatherersAt(std::uint32_t cluxel) const {
    const OwnerIndex owner = state_.fragments[state_.fragments.fragmentOf(cluxel)].owner;
    return owner < of_owner_.size() && !of_owner_[owner].empty() ? &of_owner_[owner] : nullptr;
  }

  /// The largest distance at which some gatherer may take the fragment [m]; 0 when none may.
  double widestFor(FragmentIndex fragment) const {
    double widest = 0;
    const double bottom = state_.fragments.shapeOf(fragment)[perception::Attribute::Bottom];
    for (const Demand& demand : demands_)
      if (demand.label == state_.fragments.labelOf(fragment) && bottom >= demand.above_m)
        widest = std::max(widest, demand.within_m);
    return widest;
  }

  std::vector<std::uint32_t> cluxelsOfGatherers() const {
    std::vector<std::uint32_t> all;
    for (const Gatherer& gatherer : gatherers_)
      for (const FragmentIndex fragment : state_.fragmentsOf(state_.objects[gatherer.owner])) {
        const std::vector<std::uint32_t>& cluxels = state_.fragments[fragment].cluxels;
        all.insert(all.end(), cluxels.begin(), cluxels.end());
      }
    return all;
  }

  /// Notes which gatherers are near the free ones among the fragments from `first` on. The grid holds all of their
  /// cluxels.
  void lookAround(FragmentIndex first, const CluxelGrid& grid) {
    std::vector<std::vector<Nearing>> near(state_.fragments.size() - first);
    parallelFor(near.size(), state_.threads(),
                [&](std::size_t i) { near[i] = nearTo(first + static_cast<FragmentIndex>(i), grid); });
    for (std::size_t i = 0; i < near.size(); ++i)
      for (const Nearing& one : near[i])
        if (one.is_near) note(first + static_cast<FragmentIndex>(i), one.gatherer, one.gap_m);
  }

  /// The search narrows to the largest of the gaps that are known so far: most fragments touch what they are near. It
  /// leaves out the cluxels that are farther from the bounds of a gatherer than some other one.
  std::vector<Nearing> nearTo(FragmentIndex fragment, const CluxelGrid& grid) const {
    if (!isFree(fragment) || widestFor(fragment) == 0) return {};
    std::vector<Nearing> nearing = possibleFor(fragment);
    for (const std::uint32_t cluxel : state_.fragments[fragment].cluxels) {
      const double search_m = searchFrom(cluxel, nearing);
      if (search_m <= 0) continue;
      grid.near(cluxel, search_m, [&](std::uint32_t other) {
        const auto* numbers = gatherersAt(other);
        if (numbers == nullptr) return;
        const double gap = gapBetween(state_.scene.cluxels, cluxel, other).gap();
        for (Nearing& one : nearing)
          if (std::binary_search(numbers->begin(), numbers->end(), one.gatherer) &&
              (gap < one.gap_m || (gap == one.gap_m && !one.is_near)))
            one.gap_m = gap, one.is_near = true;
      });
    }
    return nearing;
  }

  /// How far from a cluxel some gatherer may be nearer than it is known to be [m]; not positive when none can.
  double searchFrom(std::uint32_t cluxel, const std::vector<Nearing>& nearing) const {
    const Eigen::AlignedBox3d box = boxAround(state_.scene.cluxels, std::span(&cluxel, 1));
    double search_m = -1;
    for (const Nearing& one : nearing)
      if (one.gap_m > search_m && isWithin(gatherers_[one.gatherer].bounds, box, one.gap_m)) search_m = one.gap_m;
    return search_m;
  }

  /// The gatherers that may take the fragment and whose bounds are near its own.
  std::vector<Nearing> possibleFor(FragmentIndex fragment) const {
    const Eigen::AlignedBox3d bounds = boundsOf(fragment);
    std::vector<Nearing> possible;
    for (std::size_t g = 0; g < gatherers_.size(); ++g) {
      const double within = gatherers_[g].spec->gather->within_m;
      if (isWithin(gatherers_[g].bounds, bounds, within) && mayTake(gatherers_[g], fragment))
        possible.push_back({g, within, false});
    }
    return possible;
  }

  Eigen::AlignedBox3d boundsOf(FragmentIndex fragment) const { return rules::boundsOf(state_.fragments, fragment); }

  /// Notes which free fragments are near those that objects have just got. The smallest gap counts, so that the order
  /// does not matter.
  void spreadFrom(const std::vector<FragmentIndex>& given) {
    std::vector<std::vector<FragmentGap>> gaps(given.size());
    parallelFor(given.size(), state_.threads(), [&](std::size_t i) { gaps[i] = gapsFrom(given[i]); });
    for (std::size_t i = 0; i < given.size(); ++i)
      for (const FragmentGap& to : gaps[i])
        for (const std::size_t g : of_owner_[state_.fragments[given[i]].owner])
          if (to.gap_m <= gatherers_[g].spec->gather->within_m && mayTake(gatherers_[g], to.fragment))
            note(to.fragment, g, to.gap_m);
  }

  /// The gaps from a fragment to free ones that gatherers of its object may take.
  std::vector<FragmentGap> gapsFrom(FragmentIndex fragment) const {
    const auto& numbers = of_owner_[state_.fragments[fragment].owner];
    double widest = 0;
    for (std::size_t g : numbers) widest = std::max(widest, gatherers_[g].spec->gather->within_m);
    return gapsTo(state_, state_.fragments[fragment].cluxels, wantedNear(fragment, widest, numbers), widest);
  }

  /// The free fragments near one that one of the gatherers may take.
  std::vector<FragmentIndex> wantedNear(FragmentIndex fragment, double within_m,
                                        const std::vector<std::size_t>& numbers) const {
    const Eigen::AlignedBox3d bounds = boundsOf(fragment);
    std::vector<FragmentIndex> wanted;
    for (const perception::PrimitiveIndex primitive :
         state_.grid.primitivesNear(state_.fragments[fragment].cluxels, within_m))
      for (const FragmentIndex other : state_.fragments.fragmentsOf(primitive))
        if (isFree(other) && isWithin(boundsOf(other), bounds, within_m) &&
            std::any_of(numbers.begin(), numbers.end(), [&](std::size_t g) { return mayTake(gatherers_[g], other); }))
          wanted.push_back(other);
    return wanted;
  }

  void note(FragmentIndex fragment, std::size_t number, double gap_m) {
    double& smallest = near_[fragment].try_emplace(number, gap_m).first->second;
    smallest = std::min(smallest, gap_m);
  }

  /// The free fragments within reach of a gatherer in the current state, in canonical order.
  std::vector<ReachedFragment> reached() const {
    std::vector<ReachedFragment> in_reach;
    for (const auto& [fragment, near] : near_)
      if (isFree(fragment)) in_reach.push_back({fragment, near});
    std::sort(in_reach.begin(), in_reach.end(), [this](const ReachedFragment& a, const ReachedFragment& b) {
      return a.fragment != b.fragment && state_.fragments.before(a.fragment, b.fragment);
    });
    return in_reach;
  }

  /// Cuts the fragment among the gatherers that are near and reach it. Adds the fragments that were given away to
  /// `given`.
  void hand(const ReachedFragment& found, std::vector<FragmentIndex>& given) {
    std::map<std::size_t, std::vector<std::uint32_t>> parts;  // by gatherer
    std::vector<std::uint32_t> rest;
    for (std::uint32_t cluxel : state_.fragments[found.fragment].cluxels) {
      const auto taker = nearestOf(found, cluxel);
      (taker ? parts[*taker] : rest).push_back(cluxel);
    }
    noteNear(found);
    if (parts.empty()) return;
    std::vector<std::vector<std::uint32_t>> kept;
    for (auto& [taker, cluxels] : parts) kept.push_back(std::move(cluxels));
    for (auto& bunch : connectedBunches(state_.scene.cluxels, rest)) kept.push_back(std::move(bunch));
    const auto made = state_.cut(found.fragment, std::move(kept));
    std::size_t next = 0;
    for (const auto& [taker, cluxels] : parts) {
      given.push_back(made[next]);
      give(made[next++], gatherers_[taker], found.near.at(taker));
    }
  }

  /// The gatherers that are near decide about the fragment, also when none reaches it.
  void noteNear(const ReachedFragment& found) {
    std::uint64_t trace = 0;
    std::vector<MemberSet> members{state_.fragments[found.fragment].primitive};
    for (const auto& [number, gap] : found.near) {
      trace += mixed(gatherers_[number].trace, gap);
      members.push_back(state_.objects[gatherers_[number].owner].members);
    }
    state_.trace.keep(state_.trace.unionOf(std::move(members)));
    if (state_.trace.isNews(state_.fragments.hashOf(found.fragment), trace))
      state_.trace.note(state_.fragments[found.fragment].primitive, mixed(StepKind::Gathered, trace));
  }

  /// Of the gatherers that are near the fragment and reach the cluxel, the one with the nearest top in plan view.
  std::optional<std::size_t> nearestOf(const ReachedFragment& found, std::uint32_t cluxel) const {
    double nearest = std::numeric_limits<double>::infinity();
    std::optional<std::size_t> taker;
    for (const auto& [number, gap] : found.near) {
      const double distance = (state_.scene.cluxels.center[cluxel].head<2>() - gatherers_[number].top).norm();
      if (distance <= gatherers_[number].spec->reach_m && distance < nearest) nearest = distance, taker = number;
    }
    return taker;
  }

  void give(FragmentIndex fragment, const Gatherer& gatherer, double gap_m) {
    state_.setOwner(fragment, gatherer.owner);
    state_.noteGrowth(state_.objects[gatherer.owner], mixed(state_.fragments.hashOf(fragment), gap_m),
                      state_.fragments[fragment].primitive);
    for (const std::size_t g : of_owner_[gatherer.owner]) gatherers_[g].bounds.extend(boundsOf(fragment));
    ObjectInMaking& object = state_.objects[gatherer.owner];
    for (PartInMaking& part : object.parts)
      if (part.name == gatherer.spec->part) part.fragments.push_back(fragment);
    record(fragment, gatherer, gap_m);
  }

  /// Adds a decision, so that `explain` can report why the primitive belongs to the object.
  void record(FragmentIndex fragment, const Gatherer& gatherer, double gap_m) {
    const ObjectInMaking& object = state_.objects[gatherer.owner];
    const SplittingSpec& spec = *gatherer.spec;
    Decision decision;
    decision.rule_id = object.rule->id;
    decision.seed = state_.fragments[fragment].primitive;
    decision.seeds = {decision.seed};
    decision.accepted = decision.is_gathered = true;
    decision.leaf = state_.decisions[object.decision].leaf;
    if (state_.context.keeps_paths) describe(object, spec, gap_m, decision);
    state_.decisions.push_back(std::move(decision));
  }

  void describe(const ObjectInMaking& object, const SplittingSpec& spec, double gap_m, Decision& decision) const {
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
  }

  ReasoningState& state_;
  const std::string& class_iri_;
  std::vector<Gatherer> gatherers_;
  std::vector<std::vector<std::size_t>> of_owner_;               ///< numbers in gatherers_
  std::vector<Demand> demands_;                                  ///< each once
  std::map<FragmentIndex, std::map<std::size_t, double>> near_;  ///< see ReachedFragment::near
};

}  // namespace

void gatherFragments(ReasoningState& state, const std::string& class_iri) {
  Gathering(state, class_iri).run();
}

}  // namespace cluxel::rules
