// SPDX-License-Identifier: Apache-2.0
// How the objects of a map would differ under other rules. The map is not changed.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mapping/map_reader.hpp"
#include "rules/language/rule_set.hpp"
#include "tasks/export/map_export.hpp"

namespace cluxel::tasks {

/// How an object differs. The first that applies is given.
enum class ObjectChangeKind : std::uint8_t {
  Class,       ///< it has another class
  Parts,       ///< its cluxels, or the parts they belong to, differ
  Confidence,  ///< only its confidence differs
  Rule,        ///< only the rule that made it differs
  Added,       ///< nothing was there before
  Removed,     ///< nothing is there any more
};
inline constexpr std::size_t kObjectChangeKinds = 6;
std::string_view nameOf(ObjectChangeKind kind);

/// An object under one of the two sets of rules.
struct JudgedObject {
  ContentHash id;
  std::string class_name;  ///< as MapReader::classNames() has it
  std::string rule_id;
  double confidence = 0;
};

struct ObjectChange {
  ObjectChangeKind kind = ObjectChangeKind::Class;
  std::optional<JudgedObject> before, after;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< mean of its points [m, map], after the change where it is there
  double points = 0;
};

struct RuleDifference {
  std::vector<ObjectChange> changes;  ///< by kind, then by id
  std::size_t before = 0, after = 0;  ///< numbers of objects
  std::array<std::size_t, kObjectChangeKinds> count_of{};
  /// (class before, class after) -> objects; "" where there is none. Only objects whose class differs.
  std::map<std::pair<std::string, std::string>, std::size_t> class_changes;
  std::vector<std::optional<ObjectChangeKind>> kind_of_cluxel;  ///< absent where nothing changes

  bool isEmpty() const { return changes.empty(); }
};

/// Objects are the same thing when they share most points; pairs are made from the largest share down. Cost: one run
/// of the reasoning stage for each set of rules.
RuleDifference differenceOf(const mapping::MapReader& map, const rules::RuleSet& before, const rules::RuleSet& after);
/// The same against the map's own rules, whose objects it holds: one run.
RuleDifference trialOf(const mapping::MapReader& map, const rules::RuleSet& rules);

/// Rules as a text, checked against the map's ontology; it may include the map's own rule files by their names. Throws
/// InputError with all faults.
rules::RuleSet rulesForMap(const mapping::MapReader& map, const std::string& name, const std::string& text);

std::string textOf(const RuleDifference& difference);
std::string jsonOf(const RuleDifference& difference);
/// All points as PLY, coloured by kind of change; what does not change is grey.
void writeDifferencePly(const mapping::MapReader& map, const RuleDifference& difference, const ByteSink& out);

}  // namespace cluxel::tasks
