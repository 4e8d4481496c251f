// SPDX-License-Identifier: Apache-2.0
// All statements look at the objects as the rules made them, so that none depends on another.
#include "mapping/statements/applied_statements.hpp"

#include <algorithm>
#include <array>

#include "mapping/facts/object_geometry.hpp"
#include "mapping/statements/stated_values.hpp"
#include "mapping/statements/statement_places.hpp"
#include "rules/objects/finished_objects.hpp"

namespace cluxel::mapping {

namespace {

using rules::ObjectPart;
using rules::SemanticObject;

bool isInside(const std::vector<Eigen::Vector2d>& polygon, const Eigen::Vector2d& p) {
  bool inside = false;
  for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Eigen::Vector2d &a = polygon[i], &b = polygon[j];
    if ((a.y() > p.y()) == (b.y() > p.y())) continue;
    if (p.x() < (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y()) + a.x()) inside = !inside;
  }
  return inside;
}

/// Parts that the new class does not have become part of the object as a whole.
SemanticObject withClass(SemanticObject object, const std::string& class_iri, const perception::Scene& scene,
                         const rules::ClassCatalogue& classes) {
  const std::vector<std::string> known = classes.partsOf(class_iri);
  std::map<std::string, ObjectPart> parts;
  for (ObjectPart& part : object.parts) {
    const bool is_kept = std::binary_search(known.begin(), known.end(), part.part_class);
    const std::string& name = is_kept ? part.part_class : class_iri;
    ObjectPart& target = parts.try_emplace(name, ObjectPart{name, {}, {}}).first->second;
    target.primitives.insert(target.primitives.end(), part.primitives.begin(), part.primitives.end());
    target.cluxels.insert(target.cluxels.end(), part.cluxels.begin(), part.cluxels.end());
  }
  object.parts.clear();
  for (auto& [name, part] : parts) {
    std::sort(part.primitives.begin(), part.primitives.end());
    part.primitives.erase(std::unique(part.primitives.begin(), part.primitives.end()), part.primitives.end());
    std::sort(part.cluxels.begin(), part.cluxels.end());
    object.parts.push_back(std::move(part));
  }
  object.class_iri = class_iri;
  object.confidence = 1;
  object.rule_id = kOperatorRule;
  object.is_class_wide = false;
  object.id = idOf(scene, object);
  return object;
}

class Application {
 public:
  Application(std::vector<SemanticObject> objects, const perception::Scene& scene, const rules::ClassCatalogue& classes,
              PointOwners& owners, const std::vector<Cloud>& clouds)
      : objects_(std::move(objects)),
        scene_(scene),
        classes_(classes),
        owners_(owners),
        clouds_(clouds),
        object_of_cluxel_(objectOfCluxel({objects_, {}}, scene.cluxels.size())),
        class_statements_(objects_.size()),
        ignored_(objects_.size(), false) {}

  AppliedStatements run(const std::vector<Statement>& statements) {
    for (const Statement& statement : statements)
      result_.outcomes.push_back({statement, StatementEffect::Dormant, std::nullopt, "", false});
    owner_of_.resize(statements.size());
    for (std::size_t i = 0; i < statements.size(); ++i) look(i);
    for (std::vector<std::size_t>& stated : class_statements_) keepCompatible(stated);
    for (std::size_t i = 0; i < statements.size(); ++i) takeIgnored(i);
    for (std::uint32_t i = 0; i < objects_.size(); ++i) finish(i);
    for (std::size_t i = 0; i < statements.size(); ++i) nameObject(i);
    for (StatementOutcome& outcome : result_.outcomes)
      outcome.lacks_scans = outcome.effect == StatementEffect::Dormant &&
                            lacksScans(outcome.statement, [&](const auto& scan) { return isThere(scan); });
    std::sort(result_.objects.begin(), result_.objects.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
    return std::move(result_);
  }

 private:
  struct Owner {
    std::uint32_t object = kNoObject;
    std::size_t points = 0;
  };

  bool isThere(const scan::ScanId& scan) const {
    return std::any_of(clouds_.begin(), clouds_.end(), [&](const Cloud& cloud) { return cloud.id == scan; });
  }

  static bool isOfClass(const Statement& statement) {
    return statement.kind == StatementKind::Is || statement.kind == StatementKind::IsNot ||
           statement.kind == StatementKind::Remove;
  }

  Owner ownerOf(const PointAnchor& anchor) {
    std::map<std::uint32_t, std::size_t> points;
    for (const std::uint32_t cluxel : owners_.cluxelsOf(anchor))
      if (object_of_cluxel_[cluxel] != kNoObject) ++points[object_of_cluxel_[cluxel]];
    Owner owner;  // objects are sorted by id: the first of equals has the smallest
    for (const auto& [object, count] : points)
      if (count > owner.points) owner = {object, count};
    if (owner.object != kNoObject && objects_[owner.object].is_class_wide) return {};
    return owner;
  }

  Owner ownerOfClass(const std::string& class_iri) const {
    for (std::uint32_t i = 0; i < objects_.size(); ++i)
      if (objects_[i].is_class_wide && objects_[i].class_iri == class_iri) return {i, 1};
    return {};
  }

  /// Finds what a statement about an object is about.
  void look(std::size_t number) {
    StatementOutcome& outcome = result_.outcomes[number];
    const Statement& statement = outcome.statement;
    if (statement.kind == StatementKind::IgnoreRegion) return;
    if (statement.kind == StatementKind::Is && !isClassOfObjects(statement.value.text, classes_)) return;
    owner_of_[number] = statement.class_iri.empty() ? ownerOf(statement.points) : ownerOfClass(statement.class_iri);
    const std::uint32_t object = owner_of_[number].object;
    if (object == kNoObject) return;
    outcome.effect = StatementEffect::Applied;
    outcome.rules_class = objects_[object].class_iri;
    if (isOfClass(statement)) class_statements_[object].push_back(number);
  }

  /// Of the statements about an object's class, those with more points count first, then those with the smaller id. One
  /// that contradicts such a statement is overruled.
  void keepCompatible(std::vector<std::size_t>& stated) {
    std::stable_sort(stated.begin(), stated.end(), [this](std::size_t a, std::size_t b) {
      return owner_of_[a].points > owner_of_[b].points;  // statements are sorted by id
    });
    std::vector<std::size_t> kept;
    for (const std::size_t number : stated) {
      const bool counts = std::all_of(kept.begin(), kept.end(), [&](std::size_t other) {
        return areCompatible(result_.outcomes[number].statement, result_.outcomes[other].statement, classes_);
      });
      if (counts)
        kept.push_back(number);
      else
        result_.outcomes[number].effect = StatementEffect::Overruled;
    }
    stated = std::move(kept);
  }

  void takeIgnored(std::size_t number) {
    StatementOutcome& outcome = result_.outcomes[number];
    if (outcome.statement.kind != StatementKind::IgnoreRegion) return;
    const std::vector<Eigen::Vector2d> polygon = cornersOf(outcome.statement.region, clouds_);
    if (polygon.empty()) return;
    for (std::uint32_t i = 0; i < objects_.size(); ++i) {
      if (objects_[i].is_class_wide || !class_statements_[i].empty() || !liesIn(polygon, objects_[i])) continue;
      ignored_[i] = true;
      outcome.effect = StatementEffect::Applied;
      outcome.contradicts = true;
    }
  }

  bool liesIn(const std::vector<Eigen::Vector2d>& polygon, const SemanticObject& object) const {
    std::uint64_t all = 0, inside = 0;
    for (const ObjectPart& part : object.parts)
      for (const std::uint32_t cluxel : part.cluxels) {
        all += scene_.cluxels.point_count[cluxel];
        if (isInside(polygon, scene_.cluxels.center[cluxel].head<2>())) inside += scene_.cluxels.point_count[cluxel];
      }
    return 2 * inside > all;
  }

  void finish(std::uint32_t i) {
    if (ignored_[i]) return overrule(i, std::nullopt);
    std::optional<std::string> stated_class;
    bool is_removed = false;
    for (const std::size_t number : class_statements_[i]) {
      StatementOutcome& outcome = result_.outcomes[number];
      const Statement& statement = outcome.statement;
      if (statement.kind == StatementKind::Is) {
        stated_class = statement.value.text;
        outcome.contradicts = objects_[i].class_iri != *stated_class;
      } else {
        outcome.contradicts =
            statement.kind == StatementKind::Remove || classes_.isA(objects_[i].class_iri, statement.value.text);
        is_removed = is_removed || outcome.contradicts;
      }
    }
    if (stated_class)
      overrule(i, withClass(objects_[i], *stated_class, scene_, classes_));
    else if (is_removed)
      overrule(i, std::nullopt);
    else
      result_.objects.push_back(objects_[i]);
  }

  void overrule(std::uint32_t i, const std::optional<SemanticObject>& now) {
    result_.overruled.push_back({objects_[i], now ? std::optional(now->id) : std::nullopt});
    if (now) result_.objects.push_back(*now);
    renamed_[i] = now ? now->id : ContentHash{};
  }

  void nameObject(std::size_t number) {
    StatementOutcome& outcome = result_.outcomes[number];
    const std::uint32_t object = owner_of_[number].object;
    if (object == kNoObject || outcome.effect == StatementEffect::Dormant) return;
    const auto renamed = renamed_.find(object);
    if (renamed == renamed_.end())
      outcome.object = objects_[object].id;
    else if (!renamed->second.isZero())
      outcome.object = renamed->second;
    else if (outcome.statement.kind == StatementKind::Fact)
      outcome.effect = StatementEffect::Dormant;  // its object was removed
  }

  std::vector<SemanticObject> objects_;  ///< as the rules made them
  const perception::Scene& scene_;
  const rules::ClassCatalogue& classes_;
  PointOwners& owners_;
  const std::vector<Cloud>& clouds_;
  std::vector<std::uint32_t> object_of_cluxel_;
  std::vector<Owner> owner_of_;                             ///< by statement
  std::vector<std::vector<std::size_t>> class_statements_;  ///< by object: the statements about its class that count
  std::vector<bool> ignored_;
  std::map<std::uint32_t, ContentHash> renamed_;  ///< overruled objects; zero: removed
  AppliedStatements result_;
};

}  // namespace

std::string_view nameOf(StatementEffect effect) {
  constexpr std::array<std::string_view, 3> kNames{"applied", "dormant", "overruled"};
  return kNames[static_cast<std::size_t>(effect)];
}

bool areCompatible(const Statement& a, const Statement& b, const rules::ClassCatalogue& classes) {
  if (a.kind == StatementKind::IsNot && b.kind == StatementKind::Is) return areCompatible(b, a, classes);
  if (a.kind == StatementKind::Is && b.kind == StatementKind::IsNot) return !classes.isA(a.value.text, b.value.text);
  if (a.kind == StatementKind::IsNot || b.kind == StatementKind::IsNot) return true;
  return a.kind == b.kind && a.value.text == b.value.text;
}

AppliedStatements applyStatements(const std::vector<Statement>& statements, std::vector<SemanticObject> objects,
                                  const perception::Scene& scene, const rules::ClassCatalogue& classes,
                                  PointOwners& owners, const std::vector<Cloud>& clouds) {
  if (statements.empty()) return {std::move(objects), {}, {}, {}};
  return Application(std::move(objects), scene, classes, owners, clouds).run(statements);
}

std::string summaryOf(const std::vector<StatementOutcome>& outcomes) {
  if (outcomes.empty()) return {};
  std::array<std::size_t, 3> counts{};
  std::size_t against = 0, without_scans = 0;
  for (const StatementOutcome& outcome : outcomes) {
    ++counts[static_cast<std::size_t>(outcome.effect)];
    against += outcome.contradicts ? 1 : 0;
    without_scans += outcome.lacks_scans ? 1 : 0;
  }
  std::string text = "operator statements: " + std::to_string(counts[0]) + " applied";
  if (without_scans > 0)
    text += ", " + std::to_string(without_scans) + " dormant until the scans that they are about are in the map again";
  if (const std::size_t others = counts[1] - without_scans; others > 0)
    text += ", " + std::to_string(others) +
            " dormant (their points belong to no object or to the ground, or their class is none of objects)";
  if (counts[2] > 0) text += ", " + std::to_string(counts[2]) + " overruled by others about the same object";
  if (against > 0) text += "; " + std::to_string(against) + " against what the rules decide";
  return text;
}

}  // namespace cluxel::mapping
