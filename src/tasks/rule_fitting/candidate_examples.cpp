// SPDX-License-Identifier: Apache-2.0
// Looks up the truth of every cluxel once, then sums it over the cluxels of each candidate.
#include "tasks/rule_fitting/candidate_examples.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "mapping/clouds/scan_store.hpp"
#include "mapping/damaged_map.hpp"
#include "mapping/facts/ask_replay.hpp"
#include "mapping/layers/stored_layers.hpp"
#include "mapping/map_tables.hpp"
#include "mapping/regions/answered_clouds.hpp"
#include "perception/segments/summary_tile.hpp"
#include "rules/decide/decision_record.hpp"
#include "rules/decide/reason.hpp"

namespace cluxel::tasks {

namespace {

using Votes = std::map<std::size_t, double>;  ///< points by class number

std::size_t cluxelCountOf(const mapping::MapReader& map) {
  std::size_t count = 0;
  for (const perception::TileKey& tile : mapping::storedTiles(map.transaction()))
    count += perception::cluxelsIn(mapping::requiredBlock(map.transaction(), mapping::tables::kSummaries, tile));
  return count;
}

/// The truth of the points of each cluxel. Nearly all cluxels have points of one class only, so what a map of votes for
/// each would take is spared.
class CluxelTruth {
 public:
  CluxelTruth(const mapping::MapReader& map, const TruthSource& truth)
      : points_(cluxelCountOf(map)), first_count_(points_.size()), first_class_(points_.size(), -1) {
    mapping::forEachAnsweredCloud(
        map, [&](const mapping::Cloud& cloud, const scan::ScanPoints& points, const mapping::PointAnswers& answers) {
          const scan::PointTruth of_points = truth.truthOf(scanOf(cloud, points));
          for (std::size_t i = 0; i < points.size(); ++i) add(answers.cluxel[i], of_points.object_class[i]);
        });
  }

  /// All points, with truth or without.
  double pointsOf(std::uint32_t cluxel) const { return points_.at(cluxel); }

  void addVotes(std::uint32_t cluxel, Votes& votes) const {
    if (first_count_.at(cluxel) > 0) votes[static_cast<std::size_t>(first_class_[cluxel])] += first_count_[cluxel];
    for (auto other = others_.lower_bound({cluxel, 0}); other != others_.end() && other->first.first == cluxel; ++other)
      votes[static_cast<std::size_t>(other->first.second)] += other->second;
  }

 private:
  void add(std::uint32_t cluxel, std::int8_t object_class) {
    ++points_.at(cluxel);
    if (object_class < 0) return;
    if (first_class_[cluxel] < 0) first_class_[cluxel] = object_class;
    if (first_class_[cluxel] == object_class)
      ++first_count_[cluxel];
    else
      ++others_[{cluxel, object_class}];
  }

  std::vector<std::uint32_t> points_, first_count_;
  std::vector<std::int8_t> first_class_;  ///< the class of the first point that has one; -1: none
  std::map<std::pair<std::uint32_t, std::int8_t>, std::uint32_t> others_;  ///< by cluxel and class
};

class ExampleCollector {
 public:
  ExampleCollector(const mapping::MapReader& map, const TruthSource& truth, const rules::RuleSet& rules,
                   bool attributes)
      : rules_(rules),
        class_names_(namesOf(rules.catalogue)),
        classes_(truth.classes()),
        truth_(map, truth),
        attributes_(attributes) {}

  void see(const rules::ReasoningState& state, const rules::Rule& rule, const rules::Verdict& verdict) {
    const auto cluxels = cluxelsOf(state, *verdict.accept, verdict.bindings);
    Votes votes;
    double with_truth = 0, all = 0;
    for (std::uint32_t cluxel : cluxels) {
      all += truth_.pointsOf(cluxel);
      truth_.addVotes(cluxel, votes);
    }
    for (const auto& [class_number, count] : votes) with_truth += count;
    if (votes.empty() || 2 * with_truth < all) return;
    const auto winner =
        std::max_element(votes.begin(), votes.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
    CandidateExample example;
    example.truth_class = classes_.names[winner->first];
    const Match match = matchOf(rule.class_iri, example.truth_class);
    if (match == Match::Unknown) return;
    example.is_right = match != Match::None && 2 * winner->second > with_truth;
    example.is_named = hasWordFor(rule.class_iri);
    example.class_iri = rule.class_iri;
    example.rule_id = rule.id;
    example.leaf = verdict.decision.leaf;
    example.points = with_truth;
    example.log_odds = verdict.decision.log_odds;
    const auto& scene = state.scene.cluxels;
    example.place = scene.scans[scene.seed[cluxels.front()].scan].hex();
    readEvidence(verdict.decision, example);
    if (attributes_) describe(state, verdict, example);
    examples.push_back(std::move(example));
  }

  std::vector<CandidateExample> examples;

 private:
  static std::vector<std::uint32_t> cluxelsOf(const rules::ReasoningState& state, const rules::AcceptLeaf& accept,
                                              const rules::Bindings& bindings) {
    std::vector<std::uint32_t> cluxels;
    for (const auto& [name, part_class] : accept.parts) {
      const auto own = state.fragments.cluxelsOf(bindings.at(name));
      cluxels.insert(cluxels.end(), own.begin(), own.end());
    }
    std::sort(cluxels.begin(), cluxels.end());
    cluxels.erase(std::unique(cluxels.begin(), cluxels.end()), cluxels.end());
    return cluxels;
  }

  enum class Match : std::uint8_t { Named, Counted, None, Unknown };

  /// How a candidate's class fits the true one. Named: the true class is the candidate's or a subclass. Counted: the
  /// evaluation counts the candidate's class as the true one. Unknown: the truth has no such class.
  Match matchOf(const std::string& class_iri, const std::string& truth_class) const {
    const auto truth_entry =
        std::find_if(rules_.catalogue.classes.begin(), rules_.catalogue.classes.end(),
                     [&](const rules::ClassEntry& entry) { return class_names_.nameOf(entry.iri) == truth_class; });
    if (truth_entry != rules_.catalogue.classes.end() && rules_.catalogue.isA(truth_entry->iri, class_iri))
      return Match::Named;
    const std::size_t counted = countedAs(class_iri);
    if (counted == classes_.names.size()) return Match::Unknown;
    return classes_.names[counted] == truth_class ? Match::Counted : Match::None;
  }

  /// Whether the truth tells this class, or one below it, from others.
  bool hasWordFor(const std::string& class_iri) const {
    return std::any_of(rules_.catalogue.classes.begin(), rules_.catalogue.classes.end(), [&](const auto& entry) {
      return rules_.catalogue.isA(entry.iri, class_iri) && classes_.meant.contains(class_names_.nameOf(entry.iri));
    });
  }

  std::size_t countedAs(const std::string& class_iri) const {
    rules::SemanticObject object;
    object.class_iri = class_iri;
    return truthClassesOf({object}, classes_, rules_.catalogue).front();
  }

  static void readEvidence(const rules::Decision& decision, CandidateExample& example) {
    example.confidence = decision.evidence.front().log_odds;
    for (std::size_t i = 1; i < decision.evidence.size(); ++i) {
      const rules::EvidenceStep& step = decision.evidence[i];
      example.values.push_back(step.holds ? std::optional(*step.holds ? 1.0 : 0.0) : step.measured);
    }
  }

  void describe(const rules::ReasoningState& state, const rules::Verdict& verdict, CandidateExample& example) const {
    static constexpr std::array<rules::SliceSpec, 7> kSlices{
        {{0.2, 0.7}, {0.7, 1.3}, {1.3, 2}, {2, 3}, {3, 4.5}, {4.5, 7}, {7, 12}}};
    rules::Candidate all;
    for (const auto& [name, part_class] : verdict.accept->parts) {
      const rules::Candidate& part = verdict.bindings.at(name);
      addShape(name, part.shape, example);
      all.fragments.insert(all.fragments.end(), part.fragments.begin(), part.fragments.end());
    }
    all = state.fragments.candidateOf(all.fragments);
    addShape("all", all.shape, example);
    for (const rules::SliceSpec& slice : kSlices) {
      char text[32];
      std::snprintf(text, sizeof text, "slice%.1f", slice.from_m);
      const auto shape = state.fragments.shapeOfSlice(all, slice);
      if (shape) addShape(text, *shape, example);
    }
  }

  static void addShape(const std::string& name, const rules::Shape& shape, CandidateExample& example) {
    for (const perception::AttributeInfo& info : perception::attributeInfos())
      example.attributes.push_back({name + "." + std::string(info.name), shape[info.attribute]});
  }

  const rules::RuleSet& rules_;
  rdf::ClassNames class_names_;
  TruthClasses classes_;
  CluxelTruth truth_;
  bool attributes_;
};

}  // namespace

std::vector<CandidateExample> candidateExamples(const mapping::MapReader& map, const rules::RuleSet& rules,
                                                const TruthSource& truth, bool with_attributes) {
  ExampleCollector collector(map, truth, rules, with_attributes);
  mapping::AskReplay oracle(map);
  rules::ReasoningContext context{.oracle = &oracle};
  context.onCandidate = [&](const auto&... seen) { collector.see(seen...); };
  reason(map.scene(), rules, context);
  return std::move(collector.examples);
}

}  // namespace cluxel::tasks
