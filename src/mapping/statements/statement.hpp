// SPDX-License-Identifier: Apache-2.0
// What an operator states about a thing of the map, anchored to measured points. Statements are inputs of the map.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "cluxel/term.hpp"
#include "rdf/store/quad_store.hpp"
#include "scan/scan.hpp"

namespace cluxel::mapping {

enum class StatementKind : std::uint8_t {
  Is,            ///< the object is of this class
  IsNot,         ///< the object is not of this class
  Remove,        ///< there is no object
  IgnoreRegion,  ///< there are no objects in this region
  Fact           ///< a property of the object, such as rdfs:label
};

/// As a statement's clx:statementKind: "is", "is not", "remove", "ignore region", "fact".
std::string_view nameOf(StatementKind kind);

/// Points of scans by their numbers, ascending. They keep their names when a scan moves.
using PointAnchor = std::map<scan::ScanId, std::vector<std::uint32_t>>;

/// A prism over a polygon, in the frame of a scan so that it moves with it.
struct RegionAnchor {
  scan::ScanId scan;
  std::vector<Eigen::Vector3d> corners;  ///< in order; [m, sensor], whole tenths of a millimetre
};

struct Statement {
  StatementKind kind = StatementKind::Is;
  std::string property;  ///< of Fact: its IRI
  Term value;            ///< the class of Is and IsNot, the value of Fact
  PointAnchor points;    ///< of all but IgnoreRegion, unless class_iri is set
  RegionAnchor region;   ///< of IgnoreRegion
  /// Of a Fact about a class-wide object, such as the ground: the class whose object is meant.
  std::string class_iri = {};

  /// Hash of all that is stated.
  ContentHash id() const;
};

/// Whether it is anchored to scans, of which `has` knows none.
bool lacksScans(const Statement& statement, const std::function<bool(const scan::ScanId&)>& has);

/// "is clx:StreetSign", "ignore region", "rdfs:label \"north gate\"".
std::string textOf(const Statement& statement);

/// The quads of a statement in graph `operator`.
std::vector<Quad> quadsOf(const Statement& statement);
/// The statements among quads of graph `operator`, ascending by id. Throws Error (FaultyInput) naming the first
/// that is malformed.
std::vector<Statement> statementsAmong(const std::vector<Quad>& quads);
/// Those of graph `operator`.
std::vector<Statement> storedStatements(const rdf::QuadReader& reader);

}  // namespace cluxel::mapping
