// SPDX-License-Identifier: Apache-2.0
// Candidates are looked up through relations, adjacency or the grid, so that a `find` costs what is near it and not the
// whole scene.
#include "rules/propose/fragment_search.hpp"

#include <algorithm>
#include <utility>

#include "rules/decide/threshold_margins.hpp"
#include "rules/propose/condition_eval.hpp"
#include "rules/propose/pair_measures.hpp"

namespace cluxel::rules {

namespace {

/// Things near an anchor that may be found, some of them more than once.
class Looking {
 public:
  Looking(const ReasoningState& state, const Candidate& anchor, const std::function<bool(FragmentIndex)>& is_eligible)
      : state_(state), anchor_(anchor), is_eligible_(is_eligible) {}

  void addRelated(perception::RelationKind kind) {
    for (FragmentIndex fragment : anchor_.fragments) {
      const perception::PrimitiveIndex primitive = state_.fragments[fragment].primitive;
      addFragments(primitive);
      for (std::uint32_t number : state_.relations_to[primitive])
        if (state_.scene.relations[number].kind == kind) addFragments(state_.scene.relations[number].from);
    }
  }

  void addAdjacent() {
    auto last = static_cast<FragmentIndex>(state_.fragments.size());
    for (FragmentIndex fragment : anchor_.fragments)
      for (std::uint32_t cluxel : state_.fragments[fragment].cluxels)
        for (std::uint32_t neighbour : state_.scene.cluxels.neighbours(cluxel))
          if (const FragmentIndex other = state_.fragments.fragmentOf(neighbour); std::exchange(last, other) != other)
            add(other);
  }

  void addNear(double reach_m) {
    for (perception::PrimitiveIndex primitive :
         state_.grid.primitivesNear(state_.fragments.cluxelsOf(anchor_), reach_m))
      addFragments(primitive);
  }

  std::vector<FragmentIndex> take() { return std::move(found_); }

 private:
  void add(FragmentIndex fragment) {
    if (is_eligible_(fragment)) found_.push_back(fragment);
  }
  void addFragments(perception::PrimitiveIndex primitive) {
    for (const FragmentIndex fragment : state_.fragments.fragmentsOf(primitive)) add(fragment);
  }

  const ReasoningState& state_;
  const Candidate& anchor_;
  const std::function<bool(FragmentIndex)>& is_eligible_;
  std::vector<FragmentIndex> found_;
};

/// What is farther away than `reach_m` was not looked at.
void noteSearch(const ReasoningState& state, const Condition& tie, const Candidate& anchor, double reach_m) {
  const std::uint32_t threshold = tie.upper ? tie.upper_threshold : tie.threshold;
  if (threshold == 0) return;
  if (anchor.fragments.empty()) return state.context.margins->noteEverywhere(threshold, reach_m);
  const perception::PrimitiveIndex primitive = state.fragments[anchor.fragments.front()].primitive;
  if (tie.measure == PairMeasure::AxisDistance)  // what is looked at follows from the threshold in another way
    state.context.margins->noteFixed(primitive, threshold);
  else
    state.context.margins->note(primitive, threshold, reach_m);
}

/// How far around the anchor a distance makes things be looked up.
double reachOf(const ReasoningState& state, const Condition& tie, const Candidate& anchor) {
  const double within = tie.upper ? tie.upper->value : tie.value->value;
  const double searched = state.context.margins != nullptr ? searchedAround(within) : within;
  if (state.context.margins != nullptr) noteSearch(state, tie, anchor, searched);
  // The axis distance is measured from the centroid, which may be far from the nearest cluxel.
  return tie.measure == PairMeasure::AxisDistance ? within + 5 : searched;
}

}  // namespace

std::vector<FragmentIndex> tiedFragments(const ReasoningState& state, const std::vector<Condition>& conditions,
                                         const std::string& name, const Bindings& bindings,
                                         const std::function<bool(FragmentIndex)>& is_eligible) {
  const auto tie =
      std::find_if(conditions.begin(), conditions.end(), [&](const Condition& c) { return looksNearby(c, name); });
  if (tie == conditions.end()) return {};
  const Candidate& anchor = bindings.at(tie->target->name);
  Looking looking(state, anchor, is_eligible);
  if (tie->kind == Condition::Kind::Relation)
    looking.addRelated(tie->relation);
  else if (tie->measure == PairMeasure::AdjacentFraction)
    looking.addAdjacent();
  else
    looking.addNear(reachOf(state, *tie, anchor));
  std::vector<FragmentIndex> found = looking.take();
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  std::sort(found.begin(), found.end(), [&](FragmentIndex a, FragmentIndex b) { return state.fragments.before(a, b); });
  return found;
}

std::vector<FragmentIndex> findPassing(const ReasoningState& state, const Rule& rule,
                                       const std::vector<Condition>& conditions, const std::string& name,
                                       const Bindings& bindings,
                                       const std::function<bool(FragmentIndex)>& is_eligible) {
  std::vector<FragmentIndex> passing;
  Bindings with_fragment = bindings;
  with_fragment.candidates.emplace_back(name, Candidate{});
  for (FragmentIndex fragment : tiedFragments(state, conditions, name, bindings, is_eligible)) {
    with_fragment.candidates.back().second = state.fragments.candidateOf({fragment});
    if (ConditionEvaluator(state, rule, with_fragment).allHold(conditions)) passing.push_back(fragment);
  }
  return passing;
}

std::vector<FragmentIndex> choose(const ReasoningState& state, Choice choice,
                                  const std::vector<FragmentIndex>& fragments, const Candidate* nearest_to) {
  if (choice == Choice::All) return fragments;
  auto value = [&](FragmentIndex fragment) {
    const Shape& shape = state.fragments.shapeOf(fragment);
    switch (choice) {
      case Choice::MostPoints:
        return shape.points;
      case Choice::Highest:
        return shape[perception::Attribute::Top];
      case Choice::Lowest:
        return -shape[perception::Attribute::Bottom];
      case Choice::Nearest:
        return nearest_to == nullptr
                   ? 0.0
                   : -measurePair(state, PairMeasure::Gap, state.fragments.candidateOf({fragment}), *nearest_to);
      case Choice::MostAdjacent:
        return nearest_to == nullptr ? 0.0
                                     : measurePair(state, PairMeasure::AdjacentFraction,
                                                   state.fragments.candidateOf({fragment}), *nearest_to);
      default:
        return shape[perception::Attribute::Volume];
    }
  };
  FragmentIndex best = fragments.front();
  double best_value = value(best);
  for (FragmentIndex fragment : fragments) {
    const double mine = value(fragment);
    if (mine > best_value || (mine == best_value && fragment != best && state.fragments.before(fragment, best))) {
      best = fragment;
      best_value = mine;
    }
  }
  return {best};
}

}  // namespace cluxel::rules
