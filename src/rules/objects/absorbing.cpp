// SPDX-License-Identifier: Apache-2.0
// All claims are compared before any is granted: the result is independent of arrival order.
#include "rules/objects/absorbing.hpp"

#include <algorithm>

#include "base/parallel.hpp"
#include "rules/decide/threshold_margins.hpp"
#include "rules/propose/fragment_search.hpp"
#include "rules/propose/pair_measures.hpp"

namespace cluxel::rules {

namespace {

constexpr int kRounds = 3;  // fragments next to an absorbed one may follow, but not in an unbounded chain

struct Claim {
  FragmentIndex fragment = 0;
  std::size_t object = 0;
  const AbsorbSpec* spec = nullptr;
  double share = 0, gap = 0;
};

/// Whether a condition measures more of a bound thing than its bounds and its cluxels.
bool measuresShape(const Condition& condition, const std::string& name) {
  using Kind = Condition::Kind;
  const auto does = [&name](const Condition& operand) { return measuresShape(operand, name); };
  switch (condition.kind) {
    case Kind::Label:
    case Kind::Class:
      return false;
    case Kind::Attribute:
      return condition.of == name || condition.ratio_of == name;
    case Kind::Pair:
      if (condition.of != name && condition.target->name != name) return false;
      return condition.target->kind != Target::Kind::Name || condition.measure == PairMeasure::AxisDistance ||
             condition.measure == PairMeasure::VerticalGap;
    case Kind::All:
    case Kind::Any:
    case Kind::Not:
      return std::any_of(condition.operands.begin(), condition.operands.end(), does);
    default:
      return true;
  }
}

class Absorbing {
 public:
  Absorbing(ReasoningState& state, std::size_t first, bool late) : state_(state), first_(first), late_(late) {
    for (std::size_t i = first; i < state.objects.size(); ++i) {
      budget_.push_back(pointsOf(state.objects[i]));
      traces_.push_back(state.objects[i].trace);
    }
    absorbed_.resize(budget_.size(), 0);
    claims_of_.resize(budget_.size());
    is_outdated_.resize(budget_.size(), 1);
  }

  void run() {
    state_.trace.enter(mixed(StepKind::Absorbed, std::uint64_t{late_}));
    for (int round = 0; round < kRounds; ++round) {
      state_.trace.enterRound(static_cast<std::uint64_t>(round));
      const std::vector<Claim> claims = weigh();
      keepMembers(claims);
      if (!grant(claims)) break;
    }
  }

 private:
  double pointsOf(const ObjectInMaking& object) const {
    double points = 0;
    for (FragmentIndex fragment : state_.fragmentsOf(object)) points += state_.fragments.shapeOf(fragment).points;
    return points;
  }

  /// The first member in canonical order identifies an object independently of its number.
  FragmentIndex firstMember(std::size_t object) const {
    const auto fragments = state_.fragmentsOf(state_.objects[object]);
    return *std::min_element(fragments.begin(), fragments.end(),
                             [this](FragmentIndex a, FragmentIndex b) { return state_.fragments.before(a, b); });
  }

  bool isBetter(const Claim& a, const Claim& b) const {
    if (a.share != b.share) return a.share > b.share;
    if (a.gap != b.gap) return a.gap < b.gap;
    return a.object != b.object && state_.fragments.before(firstMember(a.object), firstMember(b.object));
  }

  std::vector<Claim> weigh() {
    parallelFor(claims_of_.size(), state_.threads(), [&](std::size_t i) { renewClaims(i); });
    contests_.clear();
    std::map<FragmentIndex, Claim> best;
    for (const std::vector<Claim>& of_object : claims_of_)
      for (const Claim& claim : of_object) {
        Contest& contest = contests_[claim.fragment];
        contest.trace += traceOf(claim);
        if (state_.trace.keepsMembers()) contest.members.push_back(state_.objects[claim.object].members);
        const auto [entry, fresh] = best.try_emplace(claim.fragment, claim);
        if (!fresh && isBetter(claim, entry->second)) entry->second = claim;
      }
    std::vector<Claim> claims;
    claims.reserve(best.size());
    for (const auto& [fragment, claim] : best) claims.push_back(claim);
    std::sort(claims.begin(), claims.end(), [this](const Claim& a, const Claim& b) {
      if (a.share != b.share) return a.share > b.share;
      if (a.gap != b.gap) return a.gap < b.gap;
      return state_.fragments.before(a.fragment, b.fragment);
    });
    return claims;
  }

  std::uint64_t traceOf(const Claim& claim) const {
    const std::uint64_t of_object = traces_[claim.object - first_];
    const auto spec = static_cast<std::uint64_t>(claim.spec - state_.objects[claim.object].leaf->absorb.data());
    return mixed(mixed(mixed(of_object, spec), claim.share), claim.gap);
  }

  /// All objects that claim a fragment decide about it; and about what an object gets, all that it may get decides,
  /// because its budget is used up by it.
  void keepMembers(const std::vector<Claim>& claims) {
    if (!state_.trace.keepsMembers()) return;
    std::map<std::size_t, std::vector<MemberSet>> of_object;
    for (const Claim& claim : claims) {
      const MemberSet wanted = state_.fragments[claim.fragment].primitive;
      of_object[claim.object].push_back(wanted);
      std::vector<MemberSet> of_claim = contests_[claim.fragment].members;
      of_claim.push_back(wanted);
      state_.trace.keep(state_.trace.unionOf(std::move(of_claim)));
    }
    for (auto& [object, members] : of_object) {
      members.push_back(state_.objects[object].members);
      state_.trace.keep(state_.trace.unionOf(std::move(members)));
    }
  }

  /// A claim that was refused for the same reasons before is not noted again.
  void note(const Claim& claim, bool is_granted) {
    const std::uint64_t fragment = state_.fragments.hashOf(claim.fragment);
    const std::uint64_t trace = mixed(
        StepKind::Absorbed, mixed(mixed(contests_[claim.fragment].trace, traceOf(claim)), std::uint64_t{is_granted}));
    if (!state_.trace.isNews(fragment, trace)) return;
    state_.trace.note(state_.fragments[claim.fragment].primitive, trace);
    state_.noteGrowth(state_.objects[claim.object], mixed(fragment, trace),
                      is_granted ? state_.fragments[claim.fragment].primitive : kNobody);
    if (is_granted) granted_.push_back(claim.object);
  }

  /// An object that did not grow claims what it claimed before, as far as nobody has got it.
  void renewClaims(std::size_t i) {
    if (is_outdated_[i] != 0) {
      claims_of_[i] = claimsOf(first_ + i);
      is_outdated_[i] = looksAtObjects(state_.objects[first_ + i]) ? 1 : 0;
    } else {
      std::erase_if(claims_of_[i],
                    [this](const Claim& claim) { return state_.fragments[claim.fragment].owner != kFree; });
    }
  }

  /// Whether growing objects may change what the object claims.
  static bool looksAtObjects(const ObjectInMaking& object) {
    const auto looks = [](const Condition& condition) { return looksAtOthers(condition); };
    return std::any_of(object.leaf->absorb.begin(), object.leaf->absorb.end(),
                       [&](const AbsorbSpec& spec) { return std::any_of(spec.when.begin(), spec.when.end(), looks); });
  }
  static bool looksAtOthers(const Condition& condition) {
    using Kind = Condition::Kind;
    if (condition.kind == Kind::Ask || condition.kind == Kind::Class) return true;
    if (condition.target && condition.target->kind != Target::Kind::Name) return true;
    return std::any_of(condition.operands.begin(), condition.operands.end(), looksAtOthers);
  }

  std::vector<Claim> claimsOf(std::size_t number) {
    ObjectInMaking& object = state_.objects[number];
    const auto now = [this](const AbsorbSpec& spec) { return spec.late == late_; };
    std::vector<Claim> claims;
    if (std::none_of(object.leaf->absorb.begin(), object.leaf->absorb.end(), now)) return claims;
    if (state_.fragmentsOf(object).empty()) return claims;
    renewBindings(object);
    const Candidate whole = state_.fragments.extentOf(state_.fragmentsOf(object));
    for (const AbsorbSpec& spec : object.leaf->absorb)
      if (now(spec)) weighSpec(number, spec, whole, claims);
    return claims;
  }

  bool isMeasured(const ObjectInMaking& object, const std::string& name) const {
    return std::any_of(object.leaf->absorb.begin(), object.leaf->absorb.end(), [&](const AbsorbSpec& spec) {
      return spec.late == late_ && std::any_of(spec.when.begin(), spec.when.end(), [&](const Condition& condition) {
               return measuresShape(condition, name);
             });
    });
  }

  /// Renews the bound candidates of parts whose fragments changed. Objects grow by many fragments, and measuring costs
  /// time in all of their cluxels: a shape that no condition measures stays outdated.
  void renewBindings(ObjectInMaking& object) const {
    for (PartInMaking& part : object.parts) {
      Candidate* candidate = part.is_outdated ? object.bindings.find(part.name) : nullptr;
      if (candidate == nullptr) continue;
      part.is_outdated = !isMeasured(object, part.name);
      *candidate =
          part.is_outdated ? state_.fragments.extentOf(part.fragments) : state_.fragments.candidateOf(part.fragments);
    }
  }

  void weighSpec(std::size_t number, const AbsorbSpec& spec, const Candidate& whole, std::vector<Claim>& claims) const {
    const ObjectInMaking& object = state_.objects[number];
    auto is_eligible = [&](FragmentIndex fragment) {
      if (state_.fragments[fragment].owner != kFree) return false;
      const scan::PrimitiveLabel label = state_.fragments.labelOf(fragment);
      return spec.labels.empty() || std::find(spec.labels.begin(), spec.labels.end(), label) != spec.labels.end();
    };
    for (FragmentIndex fragment : findPassing(state_, *object.rule, spec.when, "it", object.bindings, is_eligible)) {
      const Candidate it = state_.fragments.candidateOf({fragment});
      Claim claim{fragment, number, &spec, measurePair(state_, PairMeasure::AdjacentFraction, it, whole), 0};
      if (claim.share == 0) claim.gap = measurePair(state_, PairMeasure::Gap, it, whole, 5.0);
      claims.push_back(claim);
    }
  }

  bool grant(const std::vector<Claim>& claims) {
    bool any = false;
    granted_.clear();
    for (const Claim& claim : claims) {
      ObjectInMaking& object = state_.objects[claim.object];
      const double points = state_.fragments.shapeOf(claim.fragment).points;
      double& so_far = absorbed_[claim.object - first_];
      noteBudget(claim, so_far + points);
      if (so_far + points > claim.spec->max_fraction_of_points * budget_[claim.object - first_]) {
        note(claim, false);
        continue;
      }
      note(claim, true);
      so_far += points;
      state_.setOwner(claim.fragment, static_cast<OwnerIndex>(claim.object));
      addTo(object, claim);
      is_outdated_[claim.object - first_] = 1;
      any = true;
    }
    for (const std::size_t object : granted_) traces_[object - first_] = state_.objects[object].trace;
    return any;
  }

  /// The points are compared with a share of those of the object.
  void noteBudget(const Claim& claim, double points) const {
    if (state_.context.margins == nullptr) return;
    const perception::PrimitiveIndex primitive = state_.fragments[claim.fragment].primitive;
    for (const double share :
         quotientsToNote(points, budget_[claim.object - first_], claim.spec->max_fraction_of_points))
      state_.context.margins->note(primitive, claim.spec->threshold, share);
  }

  void addTo(ObjectInMaking& object, const Claim& claim) {
    for (PartInMaking& part : object.parts) {
      if (part.name != claim.spec->into) continue;
      part.fragments.push_back(claim.fragment);
      part.is_outdated = true;
      return;
    }
    object.parts.front().fragments.push_back(claim.fragment);
  }

  ReasoningState& state_;
  std::size_t first_;
  bool late_;
  struct Contest {
    std::uint64_t trace = 0;         ///< of all claims to the fragment
    std::vector<MemberSet> members;  ///< of the objects that claim it, when they are kept
  };

  std::vector<double> budget_, absorbed_;
  std::vector<std::uint64_t> traces_;  ///< of the objects, when they grew last
  std::map<FragmentIndex, Contest> contests_;
  std::vector<std::size_t> granted_;           ///< the objects that grew in this round
  std::vector<std::vector<Claim>> claims_of_;  ///< by object from first_ on
  std::vector<char> is_outdated_;              ///< whether claims_of_ has to be found anew; bytes, written in parallel
};

}  // namespace

void absorbMisfits(ReasoningState& state, std::size_t first, bool late) {
  Absorbing(state, first, late).run();
}

}  // namespace cluxel::rules
