// SPDX-License-Identifier: Apache-2.0
// Runs the rules over a part of the scene, checked against the digests of the whole run.
#include <Eigen/Geometry>
#include <algorithm>
#include <array>

#include "perception/segments/scene_part.hpp"
#include "rules/explain/decision_digests.hpp"
#include "rules/explain/part_run.hpp"

namespace cluxel::rules {

namespace {

constexpr double kChecked_m = 5;  ///< around what is explained
constexpr std::array<double, 3> kMargins_m{12, 30, 75};
constexpr double kMaxShare = 0.6;  ///< of the scene's cluxels: larger parts take as long as the whole

using Box = Eigen::AlignedBox2d;

Box boxOf(const perception::Primitive& primitive) {
  return {Eigen::Vector2d(primitive.min.head<2>()), Eigen::Vector2d(primitive.max.head<2>())};
}

Box grown(const Box& box, double by_m) {
  return {Eigen::Vector2d(box.min().array() - by_m), Eigen::Vector2d(box.max().array() + by_m)};
}

/// For each primitive the rules of the objects that own some of it, ascending.
std::vector<std::vector<std::string>> ownersOf(const std::vector<SemanticObject>& objects, std::size_t primitives) {
  std::vector<std::vector<std::string>> owners(primitives);
  for (const SemanticObject& object : objects)
    for (const perception::PrimitiveIndex primitive : primitivesOf(object)) owners[primitive].push_back(object.rule_id);
  for (std::vector<std::string>& rules : owners) std::sort(rules.begin(), rules.end());
  return owners;
}

class PartSearch {
 public:
  PartSearch(const perception::Scene& scene, const WholeRun& whole,
             const std::vector<perception::PrimitiveIndex>& primitives)
      : scene_(scene),
        digests_(whole.digests),
        owners_(ownersOf(whole.objects, scene.primitives.size())),
        primitives_(primitives) {
    for (const perception::PrimitiveIndex primitive : primitives) box_.extend(boxOf(scene.primitives[primitive]));
  }

  /// The primitives within the margin; empty when they are most of the scene.
  std::vector<perception::PrimitiveIndex> within(double margin_m) const {
    std::vector<perception::PrimitiveIndex> kept;
    std::size_t cluxels = 0;
    const Box around = grown(box_, margin_m);
    for (perception::PrimitiveIndex i = 0; i < scene_.primitives.size(); ++i)
      if (around.intersects(boxOf(scene_.primitives[i]))) {
        kept.push_back(i);
        cluxels += scene_.primitives[i].cluxels.size();
      }
    if (static_cast<double>(cluxels) > kMaxShare * static_cast<double>(scene_.cluxels.size())) kept.clear();
    return kept;
  }

  /// Whether the run over the part took the decisions of the whole run about what is explained and about the seeds of
  /// the objects that own it, and gave what touches the box around it to the same rules. The digests there may differ:
  /// the ground reaches far beyond every part.
  bool agrees(const std::vector<perception::PrimitiveIndex>& kept, const perception::Scene& part,
              const ReasoningResult& result) const {
    const std::vector<std::uint64_t> found = decisionDigests(part, result);
    const auto owners = ownersOf(result.objects, kept.size());
    const Box checked = grown(box_, kChecked_m);
    const std::vector<perception::PrimitiveIndex> told = toldAbout(numbersIn(kept), result);
    return std::all_of(told.begin(), told.end(), [&](auto i) { return found[i] == digests_[kept[i]]; }) &&
           std::all_of(owners.begin(), owners.end(), [&](const std::vector<std::string>& rules) {
             const auto i = static_cast<std::size_t>(&rules - owners.data());
             return rules == owners_[kept[i]] || !checked.intersects(boxOf(scene_.primitives[kept[i]]));
           });
  }

  /// The explained primitives by their numbers in the part.
  std::vector<perception::PrimitiveIndex> numbersIn(const std::vector<perception::PrimitiveIndex>& kept) const {
    std::vector<perception::PrimitiveIndex> numbers;
    for (const perception::PrimitiveIndex primitive : primitives_)
      numbers.push_back(static_cast<perception::PrimitiveIndex>(std::lower_bound(kept.begin(), kept.end(), primitive) -
                                                                kept.begin()));
    return numbers;
  }

 private:
  /// Those that are explained, and the seeds of their owners' decisions: an explanation tells these too.
  static std::vector<perception::PrimitiveIndex> toldAbout(std::vector<perception::PrimitiveIndex> explained,
                                                           const ReasoningResult& result) {
    std::vector<perception::PrimitiveIndex> told = explained;
    for (const SemanticObject& object : result.objects) {
      const std::vector<perception::PrimitiveIndex> own = primitivesOf(object);
      const std::vector<perception::PrimitiveIndex>& seeds = result.decisions[object.decision].seeds;
      if (std::find_first_of(own.begin(), own.end(), explained.begin(), explained.end()) != own.end())
        told.insert(told.end(), seeds.begin(), seeds.end());
    }
    return told;
  }

  const perception::Scene& scene_;
  const std::vector<std::uint64_t>& digests_;
  std::vector<std::vector<std::string>> owners_;
  const std::vector<perception::PrimitiveIndex>& primitives_;
  Box box_;
};

}  // namespace

std::optional<PartRun> runInPart(const perception::Scene& scene, const RuleSet& rules, const WholeRun& whole,
                                 const std::vector<perception::PrimitiveIndex>& primitives) {
  if (rules.asks_map || whole.digests.size() != scene.primitives.size() || primitives.empty()) return std::nullopt;
  const PartSearch search(scene, whole, primitives);
  for (const double margin_m : kMargins_m) {
    const std::vector<perception::PrimitiveIndex> kept = search.within(margin_m);
    if (kept.empty()) return std::nullopt;
    PartRun run{partOf(scene, kept), search.numbersIn(kept), {}};
    ReasoningContext probing;
    probing.probes = run.primitives;
    run.result = reason(run.part, rules, probing);
    if (search.agrees(kept, run.part, run.result)) return run;
  }
  return std::nullopt;
}

}  // namespace cluxel::rules
