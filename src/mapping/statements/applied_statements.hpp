// SPDX-License-Identifier: Apache-2.0
// Applies operator statements to what the rules decided: after rivals are settled, before facts are written.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mapping/statements/point_owners.hpp"
#include "mapping/statements/statement.hpp"
#include "perception/segments/scene.hpp"
#include "rules/language/class_catalogue.hpp"
#include "rules/objects/semantic_object.hpp"

namespace cluxel::mapping {

/// The rule of an object whose class an operator stated.
inline constexpr std::string_view kOperatorRule = "operator";

enum class StatementEffect : std::uint8_t {
  Applied,  ///< the map says what is stated
  /// It has no effect now: the map lacks the anchored points, no object owns them, or only one that holds all of its
  /// class does; or the ontology lacks the stated class.
  Dormant,
  Overruled,  ///< another statement about the same object comes first
};
std::string_view nameOf(StatementEffect effect);

struct StatementOutcome {
  Statement statement;
  StatementEffect effect = StatementEffect::Dormant;
  std::optional<ContentHash> object;  ///< the object it applies to, by its name in the map; none when that is gone
  std::string rules_class;            ///< the class that the rules gave to the object
  bool contradicts = false;           ///< the rules decided otherwise
  bool lacks_scans = false;           ///< dormant because the map has none of the scans that it is anchored to
};

/// An object that the rules made and a statement changed.
struct OverruledObject {
  rules::SemanticObject by_rules;
  std::optional<ContentHash> now;  ///< its name in the map; none when it was removed
};

struct AppliedStatements {
  std::vector<rules::SemanticObject> objects;        ///< of the map, sorted by id
  std::vector<OverruledObject> overruled;            ///< sorted by the rules' id
  std::vector<StatementOutcome> outcomes;            ///< in the order of the statements
  std::map<ContentHash, perception::TileSet> tiles;  ///< what each statement is about, by its id
};

/// A statement applies to the object that owns most of its anchored points (ties: the smallest id that the rules
/// gave). When that is class-wide, as the ground, it is dormant; only what is anchored to the class applies to such an
/// object. A region takes the other objects of which more than half of the points lie inside. Of several statements
/// about the class of an object the one with most points in it counts (ties: the smallest id); a region comes after
/// them. The order of `statements` means nothing.
AppliedStatements applyStatements(const std::vector<Statement>& statements, std::vector<rules::SemanticObject> objects,
                                  const perception::Scene& scene, const rules::ClassCatalogue& classes,
                                  PointOwners& owners, const std::vector<Cloud>& clouds);

/// Whether both statements about the class of one object can be true: an object is of one stated class, and may be
/// stated not to be of others that are neither this class nor above it.
bool areCompatible(const Statement& a, const Statement& b, const rules::ClassCatalogue& classes);

/// "operator statements: 3 applied, 1 dormant, 1 against the rules"; empty when there are none.
std::string summaryOf(const std::vector<StatementOutcome>& outcomes);

}  // namespace cluxel::mapping
