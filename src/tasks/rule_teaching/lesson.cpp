// SPDX-License-Identifier: Apache-2.0
// Finds tests that only the case passes, writes the exception, and excludes the case from other rules until the
// exception takes it.
#include "tasks/rule_teaching/lesson.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <tuple>

#include "cluxel/error.hpp"
#include "mapping/facts/ask_replay.hpp"
#include "mapping/facts/object_geometry.hpp"
#include "mapping/statements/stated_values.hpp"
#include "rules/decide/reason.hpp"
#include "rules/language/rule_loader.hpp"
#include "tasks/explanation.hpp"
#include "tasks/named_class.hpp"
#include "tasks/rule_teaching/lesson_text.hpp"
#include "tasks/thing_names.hpp"

namespace cluxel::tasks {

namespace {

constexpr std::size_t kMostGuards = 8;  // rules that can want one thing; more means that something else is wrong

class Teaching {
 public:
  Teaching(const mapping::MapReader& map, const LessonRequest& request) : map_(map), request_(request) {
    rules_ = rulesForMap(map, "rules.yaml", includingText(map, ""));
    lesson_.object = objectNamed(map, request.object);
    lesson_.class_iri = classNamed(map, request.class_name);
    mapping::Statement is_class;
    is_class.value = Term::iri(lesson_.class_iri);
    mapping::requireStatable(is_class, rules_.catalogue);
    for (const rules::SemanticObject& other : map.objects())
      if (other.is_class_wide && other.class_iri == lesson_.class_iri)
        throw Error(ErrorKind::InvalidArgument, mapping::localName(lesson_.class_iri) +
                                                    " is one object of the whole map, to which no thing can be added");
    lesson_.rule_file = request.rule_file;
  }

  Lesson run() {
    findSeeds();
    lesson_.cuts = cuts();
    Lesson lesson;
    lesson.class_name = mapping::localName(lesson_.class_iri);
    lesson.before = mapping::localName(object().class_iri);
    for (const AttributeCut& cut : lesson_.cuts) lesson.conditions.push_back(conditionText(cut));
    lesson.rules = rulesThatTakeTheCase();
    lesson.guarded = lesson_.guarded;
    lesson.test = testText(map_, rules_, lesson_);
    std::tie(lesson.points, lesson.kept_points) = keptPoints();
    lesson.difference = trialOf(map_, rulesForMap(map_, request_.rule_file, lesson.rules));
    return lesson;
  }

 private:
  /// As the rules decide it, whatever an operator stated.
  const rules::SemanticObject& object() const { return map_.byRules(map_.objects()[lesson_.object]); }

  rules::ReasoningResult resultOf(const rules::RuleSet& rules) const {
    mapping::AskReplay oracle(map_);
    return reason(map_.scene(), rules, {.oracle = &oracle});
  }

  void findSeeds() {
    if (object().class_iri == lesson_.class_iri)
      throw Error(ErrorKind::InvalidArgument,
                  "the object is " + rules::withArticle(mapping::localName(lesson_.class_iri)) + " already");
    const rules::ReasoningResult result = resultOf(rules_);
    const auto same = std::find_if(result.objects.begin(), result.objects.end(),
                                   [&](const rules::SemanticObject& other) { return other.id == object().id; });
    if (same == result.objects.end())
      throw Error(ErrorKind::FaultyInput, "the map's rules do not make the object again; check the map with doctor");
    const rules::Decision& decision = result.decisions[same->decision];
    if (rules_.find(decision.rule_id)->seed.slice)
      throw Error(ErrorKind::InvalidArgument, "rule " + decision.rule_id +
                                                  " cut the object out of larger things by height; such a case cannot "
                                                  "be taught, write a rule for it");
    lesson_.seeds = decision.seeds;
  }

  std::set<perception::PrimitiveIndex> primitivesOf(const rules::SemanticObject& thing) const {
    std::set<perception::PrimitiveIndex> all;
    for (const rules::ObjectPart& part : thing.parts) all.insert(part.primitives.begin(), part.primitives.end());
    return all;
  }

  std::vector<AttributeCut> cuts() const {
    const auto& primitives = map_.scene().primitives;
    std::set<scan::PrimitiveLabel> labels;
    std::vector<AttributeValues> wanted, others;
    for (const perception::PrimitiveIndex seed : lesson_.seeds) {
      labels.insert(primitives[seed].label);
      wanted.push_back(primitives[seed].attributes);
    }
    std::vector<AttributeValues> free;
    const std::set<perception::PrimitiveIndex> kept = keptPrimitives();
    for (perception::PrimitiveIndex i = 0; i < primitives.size(); ++i) {
      const bool is_seed = std::find(lesson_.seeds.begin(), lesson_.seeds.end(), i) != lesson_.seeds.end();
      if (is_seed || !labels.contains(primitives[i].label)) continue;
      (kept.contains(i) ? others : free).push_back(primitives[i].attributes);
    }
    std::vector<AttributeValues> all = others;
    if (request_.confirmed.empty()) all.insert(all.end(), free.begin(), free.end());
    if (const auto found = separatingCuts(wanted, all)) return *found;
    if (const auto found = separatingCuts(wanted, others)) return *found;
    throw Error(ErrorKind::InvalidArgument,
                "no two tests of attributes tell the object from the " + std::to_string(others.size()) +
                    " other things of its label; confirm fewer objects, or write a rule that looks at its neighbours");
  }

  /// The primitives of the objects that must not change.
  std::set<perception::PrimitiveIndex> keptPrimitives() const {
    std::set<perception::PrimitiveIndex> kept;
    for (const std::string& name : request_.confirmed)
      kept.merge(primitivesOf(map_.objects()[objectNamed(map_, name)]));
    for (const rules::SemanticObject& other : map_.objects())
      if (request_.confirmed.empty() && map_.byRules(other).id != object().id) kept.merge(primitivesOf(other));
    return kept;
  }

  /// The object of `result` that took most points of the case.
  const rules::SemanticObject* takerIn(const rules::ReasoningResult& result) const {
    const rules::SemanticObject* best = nullptr;
    double most = 0;
    for (const rules::SemanticObject& candidate : result.objects) {
      double points = 0;
      for (const rules::ObjectPart& part : candidate.parts)
        for (const std::uint32_t cluxel : part.cluxels)
          if (std::find(lesson_.seeds.begin(), lesson_.seeds.end(), map_.scene().cluxels.primitive[cluxel]) !=
              lesson_.seeds.end())
            points += map_.scene().cluxels.point_count[cluxel];
      if (points <= most) continue;
      most = points;
      best = &candidate;
    }
    return best;
  }

  /// Points of the object, and those of them that objects of the class have with the lesson.
  std::pair<double, double> keptPoints() const {
    const perception::SceneCluxels& cluxels = map_.scene().cluxels;
    std::set<std::uint32_t> of_class;
    for (const rules::SemanticObject& made : taught_)
      if (made.class_iri == lesson_.class_iri)
        for (const std::uint32_t cluxel : mapping::cluxelsOf(made)) of_class.insert(cluxel);
    double all = 0, kept = 0;
    for (const std::uint32_t cluxel : mapping::cluxelsOf(object())) {
      all += cluxels.point_count[cluxel];
      if (of_class.contains(cluxel)) kept += cluxels.point_count[cluxel];
    }
    return {all, kept};
  }

  std::string rulesThatTakeTheCase() {
    while (true) {
      std::string text = ruleText(map_, rules_, lesson_);
      const rules::ReasoningResult result = resultOf(rulesForMap(map_, request_.rule_file, text));
      const rules::SemanticObject* taker = takerIn(result);
      if (taker != nullptr && taker->rule_id == lesson_.rule_id) {
        taught_ = result.objects;
        return text;
      }
      const std::string wants = taker == nullptr ? "no rule" : result.decisions[taker->decision].rule_id;
      const bool again = std::find(lesson_.guarded.begin(), lesson_.guarded.end(), wants) != lesson_.guarded.end();
      if (taker == nullptr || again || lesson_.guarded.size() == kMostGuards)
        throw Error(ErrorKind::InvalidArgument,
                    "the exception does not get the object: " + wants + " takes it as a part of something else");
      lesson_.guarded.push_back(wants);
    }
  }

  const mapping::MapReader& map_;
  const LessonRequest& request_;
  rules::RuleSet rules_;
  LessonCase lesson_;
  std::vector<rules::SemanticObject> taught_;  ///< objects with the lesson
};

}  // namespace

bool Lesson::takesTheObject() const {
  constexpr double kNearlyAll = 0.9;  // what it was joined with may go to what stands beside it
  return kept_points >= kNearlyAll * points;
}

bool Lesson::changesNothingElse() const {
  return takesTheObject() && difference.changes.size() == 1 &&
         difference.changes.front().kind == ObjectChangeKind::Class &&
         difference.changes.front().after->class_name == class_name;
}

Lesson teach(const mapping::MapReader& map, const LessonRequest& request) {
  return Teaching(map, request).run();
}

std::string textOf(const Lesson& lesson) {
  std::string text = rules::withArticle(lesson.class_name) + ", no " + lesson.before + ", is what has";
  for (const std::string& condition : lesson.conditions)
    text += (&condition == &lesson.conditions.front() ? " " : " and ") + condition;
  text += lesson.conditions.empty() ? " its label\n" : "\n";
  for (const std::string& rule : lesson.guarded) text += "rule " + rule + " leaves it alone\n";
  if (!lesson.takesTheObject())
    text += "of the " + std::to_string(static_cast<std::size_t>(lesson.points)) + " points of the object only " +
            std::to_string(static_cast<std::size_t>(lesson.kept_points)) + " belong to " +
            rules::withArticle(lesson.class_name) +
            " then: the new rule takes the pieces that the object grew from, not what was joined to them\n";
  if (lesson.changesNothingElse())
    text += "nothing else changes\n";
  else if (lesson.difference.changes.size() > 1)
    text += "other things change too\n";
  return text + textOf(lesson.difference);
}

std::string jsonOf(const Lesson& lesson) {
  const nlohmann::ordered_json json{{"class", lesson.class_name},
                                    {"before", lesson.before},
                                    {"conditions", lesson.conditions},
                                    {"guarded_rules", lesson.guarded},
                                    {"points", lesson.points},
                                    {"kept_points", lesson.kept_points},
                                    {"changes_nothing_else", lesson.changesNothingElse()},
                                    {"difference", nlohmann::ordered_json::parse(jsonOf(lesson.difference))}};
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace cluxel::tasks
