// SPDX-License-Identifier: Apache-2.0
// Matches the objects of two runs by the points they share.
#include "tasks/rule_trial/rule_difference.hpp"

#include <algorithm>
#include <cmath>

#include "mapping/facts/ask_replay.hpp"
#include "mapping/facts/map_oracle.hpp"
#include "rules/decide/reason.hpp"
#include "rules/language/rule_loader.hpp"

namespace cluxel::tasks {

namespace {

using Objects = std::vector<rules::SemanticObject>;

constexpr std::uint32_t kNoOwner = 0xffffffffU;
constexpr double kSameConfidence = 1e-9;

Objects objectsBy(const mapping::MapReader& map, const rules::RuleSet& rules) {
  mapping::AskReplay oracle(map);
  return reason(map.scene(), rules, {.oracle = &oracle}).objects;
}

JudgedObject judged(const rules::SemanticObject& object, const rdf::ClassNames& names) {
  return {object.id, names.nameOf(object.class_iri), object.rule_id, object.confidence};
}

template <typename See>
void forEachCluxel(const rules::SemanticObject& object, const See& see) {
  for (const rules::ObjectPart& part : object.parts)
    for (const std::uint32_t cluxel : part.cluxels) see(cluxel);
}

class ObjectComparison {
 public:
  ObjectComparison(const mapping::MapReader& map, const Objects& before, const Objects& after)
      : cluxels_(map.scene().cluxels), class_names_(map.classNames()), before_(before), after_(after) {
    result_.before = before.size();
    result_.after = after.size();
    result_.kind_of_cluxel.resize(cluxels_.size());
  }

  RuleDifference compare() {
    match();
    for (std::size_t i = 0; i < before_.size(); ++i)
      if (after_of_[i] == kNoOwner) add(ObjectChangeKind::Removed, &before_[i], nullptr);
    for (std::size_t j = 0; j < after_.size(); ++j) {
      if (before_of_[j] == kNoOwner)
        add(ObjectChangeKind::Added, nullptr, &after_[j]);
      else if (const auto kind = kindOf(before_[before_of_[j]], after_[j]))
        add(*kind, &before_[before_of_[j]], &after_[j]);
    }
    std::sort(result_.changes.begin(), result_.changes.end(), [](const ObjectChange& a, const ObjectChange& b) {
      const auto key = [](const ObjectChange& c) { return std::pair(c.kind, (c.before ? c.before : c.after)->id); };
      return key(a) < key(b);
    });
    return std::move(result_);
  }

 private:
  struct Overlap {
    double points = 0;
    std::uint32_t before = 0, after = 0;
  };

  void match() {
    std::vector<std::uint32_t> owner(cluxels_.size(), kNoOwner);
    for (std::uint32_t i = 0; i < before_.size(); ++i)
      forEachCluxel(before_[i], [&](std::uint32_t cluxel) { owner[cluxel] = i; });
    std::vector<Overlap> overlaps;
    for (std::uint32_t j = 0; j < after_.size(); ++j) {
      std::map<std::uint32_t, double> shared;
      forEachCluxel(after_[j], [&](std::uint32_t cluxel) {
        if (owner[cluxel] != kNoOwner) shared[owner[cluxel]] += cluxels_.point_count[cluxel];
      });
      for (const auto& [i, points] : shared) overlaps.push_back({points, i, j});
    }
    std::sort(overlaps.begin(), overlaps.end(), [this](const Overlap& a, const Overlap& b) {
      if (a.points != b.points) return a.points > b.points;
      return std::pair(before_[a.before].id, after_[a.after].id) < std::pair(before_[b.before].id, after_[b.after].id);
    });
    after_of_.assign(before_.size(), kNoOwner);
    before_of_.assign(after_.size(), kNoOwner);
    for (const Overlap& overlap : overlaps) {
      if (after_of_[overlap.before] != kNoOwner || before_of_[overlap.after] != kNoOwner) continue;
      after_of_[overlap.before] = overlap.after;
      before_of_[overlap.after] = overlap.before;
    }
  }

  static bool sameParts(const rules::SemanticObject& a, const rules::SemanticObject& b) {
    return std::equal(a.parts.begin(), a.parts.end(), b.parts.begin(), b.parts.end(),
                      [](const rules::ObjectPart& x, const rules::ObjectPart& y) {
                        return x.part_class == y.part_class && x.cluxels == y.cluxels;
                      });
  }

  static std::optional<ObjectChangeKind> kindOf(const rules::SemanticObject& a, const rules::SemanticObject& b) {
    if (a.class_iri != b.class_iri) return ObjectChangeKind::Class;
    if (!sameParts(a, b)) return ObjectChangeKind::Parts;
    if (std::abs(a.confidence - b.confidence) > kSameConfidence) return ObjectChangeKind::Confidence;
    return a.rule_id != b.rule_id ? std::optional(ObjectChangeKind::Rule) : std::nullopt;
  }

  void add(ObjectChangeKind kind, const rules::SemanticObject* before, const rules::SemanticObject* after) {
    ObjectChange change;
    change.kind = kind;
    if (before != nullptr) change.before = judged(*before, class_names_);
    if (after != nullptr) change.after = judged(*after, class_names_);
    for (const auto* object : {before, after})
      if (object != nullptr)
        forEachCluxel(*object, [&](std::uint32_t cluxel) { result_.kind_of_cluxel[cluxel] = kind; });
    place(after != nullptr ? *after : *before, change);
    ++result_.count_of[static_cast<std::size_t>(kind)];
    const std::string from = before == nullptr ? "" : change.before->class_name,
                      to = after == nullptr ? "" : change.after->class_name;
    if (from != to) ++result_.class_changes[{from, to}];
    result_.changes.push_back(std::move(change));
  }

  void place(const rules::SemanticObject& object, ObjectChange& change) const {
    forEachCluxel(object, [&](std::uint32_t cluxel) {
      const double points = cluxels_.point_count[cluxel];
      change.points += points;
      change.place += points * cluxels_.center[cluxel];
    });
    if (change.points > 0) change.place /= change.points;
  }

  const perception::SceneCluxels& cluxels_;
  const rdf::ClassNames& class_names_;
  const Objects &before_, &after_;
  std::vector<std::uint32_t> after_of_, before_of_;  ///< the partner, or kNoOwner
  RuleDifference result_;
};

}  // namespace

RuleDifference differenceOf(const mapping::MapReader& map, const rules::RuleSet& before, const rules::RuleSet& after) {
  const Objects first = objectsBy(map, before), second = objectsBy(map, after);
  return ObjectComparison(map, first, second).compare();
}

RuleDifference trialOf(const mapping::MapReader& map, const rules::RuleSet& rules) {
  return ObjectComparison(map, map.objectsByRules(), objectsBy(map, rules)).compare();
}

rules::RuleSet rulesForMap(const mapping::MapReader& map, const std::string& name, const std::string& text) {
  const mapping::MapInputs inputs = map.inputs();
  std::vector<rules::RuleSource> sources{{name, text}};
  if (!inputs.rules.empty()) {
    // Messages must not show the folders of the machine that built the map.
    const std::filesystem::path folder = std::filesystem::path(inputs.rules.front().name).parent_path();
    for (const mapping::NamedText& own : inputs.rules) {
      sources.push_back({mapping::nameWithin(folder, own.name).string(), own.text});
    }
  }
  return loadRuleTexts(sources, 1, classCatalogueOf(inputs.ontology), mapping::withCheckedQueries()).require();
}

}  // namespace cluxel::tasks
