// SPDX-License-Identifier: Apache-2.0
// Runs the rules over a part of the scene, checked against the traces of the whole run.
#include "rules/explain/part_run.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <unordered_map>

#include "perception/segments/scene_part.hpp"

namespace cluxel::rules {

namespace {

using Box = Eigen::AlignedBox2d;

Box boxOf(const perception::Primitive& primitive) {
  return {Eigen::Vector2d(primitive.min.head<2>()), Eigen::Vector2d(primitive.max.head<2>())};
}

Box grown(const Box& box, double by_m) {
  return {Eigen::Vector2d(box.min().array() - by_m), Eigen::Vector2d(box.max().array() + by_m)};
}

/// For each cluxel the rule of the object that owns it; null for none.
std::vector<const Rule*> rulesOfCluxels(const std::vector<SemanticObject>& objects, const RuleSet& rules,
                                        std::size_t cluxels) {
  std::vector<const Rule*> owners(cluxels, nullptr);
  for (const SemanticObject& object : objects) {
    const Rule* rule = rules.find(object.rule_id);
    for (const ObjectPart& part : object.parts)
      for (const std::uint32_t cluxel : part.cluxels) owners[cluxel] = rule;
  }
  return owners;
}

/// Compares a run over a part with the whole run. They agree about primitives when their traces, and those of the seeds
/// of the objects that own them, are the same (an explanation tells these seeds, too), and when the same rules, or
/// none, got every cluxel around them. The traces around them may differ: the ground reaches far beyond every part.
class PartComparison {
 public:
  /// `traces` and `owners`: of the whole run, by the part's primitives and cluxels.
  PartComparison(const perception::Scene& part, const RuleSet& rules, const std::vector<std::uint64_t>& traces,
                 const std::vector<const Rule*>& owners, const ReasoningResult& result)
      : part_(part), traces_(traces), result_(result) {
    const std::vector<const Rule*> found = rulesOfCluxels(result.objects, rules, owners.size());
    for (std::size_t c = 0; c < owners.size(); ++c)
      if (owners[c] != found[c]) decided_otherwise_.emplace_back(part.cluxels.center[c].head<2>());
    for (const SemanticObject& object : result.objects)
      for (const perception::PrimitiveIndex primitive : primitivesOf(object)) owners_[primitive].push_back(&object);
  }

  bool agreesAbout(const std::vector<perception::PrimitiveIndex>& primitives) const {
    Box box;
    for (const perception::PrimitiveIndex primitive : primitives) {
      if (!hasSameTraces(primitive)) return false;
      box.extend(boxOf(part_.primitives[primitive]));
    }
    const Box checked = grown(box, kSameOwnersWithin_m);
    return std::none_of(decided_otherwise_.begin(), decided_otherwise_.end(),
                        [&](const Eigen::Vector2d& place) { return checked.contains(place); });
  }

 private:
  /// Of the primitive, and of the seeds of its owners.
  bool hasSameTraces(perception::PrimitiveIndex primitive) const {
    const auto is_same = [this](auto i) { return result_.traces[i] == traces_[i]; };
    const auto owners = owners_.find(primitive);
    return is_same(primitive) &&
           (owners == owners_.end() ||
            std::all_of(owners->second.begin(), owners->second.end(), [&](const SemanticObject* owner) {
              const std::vector<perception::PrimitiveIndex>& seeds = result_.decisions[owner->decision].seeds;
              return std::all_of(seeds.begin(), seeds.end(), is_same);
            }));
  }

  const perception::Scene& part_;
  const std::vector<std::uint64_t>& traces_;
  const ReasoningResult& result_;
  std::vector<Eigen::Vector2d> decided_otherwise_;  ///< cluxels that another rule, or none, got
  std::unordered_map<perception::PrimitiveIndex, std::vector<const SemanticObject*>> owners_;
};

class PartSearch {
 public:
  PartSearch(const perception::Scene& scene, const RuleSet& rules, const WholeRun& whole,
             const std::vector<perception::PrimitiveIndex>& primitives)
      : scene_(scene),
        rules_(rules),
        traces_(whole.traces),
        owners_(rulesOfCluxels(whole.objects, rules, scene.cluxels.size())),
        primitives_(primitives) {
    for (const perception::PrimitiveIndex primitive : primitives) box_.extend(boxOf(scene.primitives[primitive]));
  }

  /// The primitives within the margin; empty when they are most of the scene.
  std::vector<perception::PrimitiveIndex> within(double margin_m, double max_share) const {
    std::vector<perception::PrimitiveIndex> kept;
    std::size_t cluxels = 0;
    const Box around = grown(box_, margin_m);
    for (perception::PrimitiveIndex i = 0; i < scene_.primitives.size(); ++i)
      if (around.intersects(boxOf(scene_.primitives[i]))) {
        kept.push_back(i);
        cluxels += scene_.primitives[i].cluxels.size();
      }
    if (static_cast<double>(cluxels) > max_share * static_cast<double>(scene_.cluxels.size())) kept.clear();
    return kept;
  }

  /// Whether the run over the part decided as the whole run about what is explained, and around it.
  bool agrees(const std::vector<perception::PrimitiveIndex>& kept, const perception::Scene& part,
              const ReasoningResult& result) const {
    std::vector<std::uint64_t> traces;
    std::vector<const Rule*> owners(part.cluxels.size(), nullptr);
    for (std::size_t i = 0; i < kept.size(); ++i) {
      traces.push_back(traces_[kept[i]]);
      const std::vector<std::uint32_t>&here = part.primitives[i].cluxels, &there = scene_.primitives[kept[i]].cluxels;
      for (std::size_t c = 0; c < here.size(); ++c) owners[here[c]] = owners_[there[c]];
    }
    return PartComparison(part, rules_, traces, owners, result).agreesAbout(numbersIn(kept));
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
  const perception::Scene& scene_;
  const RuleSet& rules_;
  const std::vector<std::uint64_t>& traces_;
  std::vector<const Rule*> owners_;  ///< by cluxel of the whole scene
  const std::vector<perception::PrimitiveIndex>& primitives_;
  Box box_;
};

}  // namespace

std::vector<std::optional<Explanation>> explainInPart(const perception::Scene& part, const RuleSet& rules,
                                                      const WholeRun& whole, const std::vector<AskedObject>& asked) {
  std::vector<std::optional<Explanation>> explanations(asked.size());
  if (rules.asks_map || whole.traces.size() != part.primitives.size()) return explanations;
  ReasoningContext probing;
  for (const AskedObject& object : asked)
    probing.probes.insert(probing.probes.end(), object.primitives.begin(), object.primitives.end());
  std::sort(probing.probes.begin(), probing.probes.end());
  probing.probes.erase(std::unique(probing.probes.begin(), probing.probes.end()), probing.probes.end());
  probing.splits = whole.splits;
  const ReasoningResult result = reason(part, rules, probing);
  const PartComparison comparison(part, rules, whole.traces, rulesOfCluxels(whole.objects, rules, part.cluxels.size()),
                                  result);
  for (std::size_t i = 0; i < asked.size(); ++i)
    if (!asked[i].primitives.empty() && comparison.agreesAbout(asked[i].primitives))
      explanations[i] = explanationIn(result, rules, asked[i].id);
  return explanations;
}

std::optional<PartRun> runInPart(const std::shared_ptr<const perception::Scene>& scene, const RuleSet& rules,
                                 const WholeRun& whole, const std::vector<perception::PrimitiveIndex>& primitives,
                                 const TriedParts& tried) {
  if (rules.asks_map || whole.traces.size() != scene->primitives.size() || primitives.empty()) return std::nullopt;
  const PartSearch search(*scene, rules, whole, primitives);
  std::vector<perception::PrimitiveIndex> before;
  for (const double margin_m : tried.margins_m) {
    std::vector<perception::PrimitiveIndex> kept = search.within(margin_m, tried.max_share);
    if (kept.empty()) return std::nullopt;
    if (kept == before) continue;
    const bool is_all = kept.size() == scene->primitives.size();
    PartRun run{
        is_all ? scene : std::make_shared<const perception::Scene>(partOf(*scene, kept)), search.numbersIn(kept), {}};
    ReasoningContext probing;
    probing.probes = run.primitives;
    probing.splits = whole.splits;
    run.result = reason(*run.part, rules, probing);
    if (search.agrees(kept, *run.part, run.result)) return run;
    before = std::move(kept);
  }
  return std::nullopt;
}

std::optional<PartRun> runInPart(const perception::Scene& scene, const RuleSet& rules, const WholeRun& whole,
                                 const std::vector<perception::PrimitiveIndex>& primitives, const TriedParts& tried) {
  const std::shared_ptr<const perception::Scene> not_owned(std::shared_ptr<const void>(), &scene);
  return runInPart(not_owned, rules, whole, primitives, tried);
}

}  // namespace cluxel::rules
