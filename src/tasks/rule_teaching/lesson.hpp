// SPDX-License-Identifier: Apache-2.0
// Teaches a rule set one case: an exception that gives an object of a map another class, and a rule test that keeps it.
#pragma once

#include <string>
#include <vector>

#include "mapping/map_reader.hpp"
#include "tasks/rule_trial/rule_difference.hpp"

namespace cluxel::tasks {

struct LessonRequest {
  std::string object;                  ///< as explainThing() takes it
  std::string class_name;              ///< "Tree", "clx:Tree" or an IRI
  std::vector<std::string> confirmed;  ///< objects that must not change; empty: all others
  std::string rule_file;               ///< the name that the new rule file will have
};

struct Lesson {
  std::string class_name;               ///< local name
  std::string before;                   ///< local name of the class that the object has
  std::vector<std::string> conditions;  ///< what singles the case out
  std::vector<std::string> guarded;     ///< ids of rules that leave the case alone from now on
  std::string rules;                    ///< text of a rule file that includes the map's own
  std::string test;                     ///< text of a rule test file with the case
  RuleDifference difference;            ///< against the map's own rules

  double points = 0, kept_points = 0;  ///< of the object, and of these what objects of the class have then

  /// Whether the object has the class with nearly all of its points.
  bool takesTheObject() const;
  /// It does, and nothing else differs.
  bool changesNothingElse() const;
};

/// The smallest readable exception: one test of the attributes of the object's seeds, or two, that no other primitive
/// of the same label passes; if there is none, that no primitive of another (confirmed) object passes. Throws Error
/// (NotFound) for an unknown object or class, and Error (InvalidArgument) when the object has the class already, was
/// made of slices, or no two tests single it out, and for a class of parts or of a whole map. Cost: one run of the
/// reasoning stage for each rule that must leave the case alone, and two more.
Lesson teach(const mapping::MapReader& map, const LessonRequest& request);

/// What was taught and what it changes.
std::string textOf(const Lesson& lesson);
std::string jsonOf(const Lesson& lesson);

}  // namespace cluxel::tasks
