// SPDX-License-Identifier: Apache-2.0
// Operator statements added to a map and withdrawn from it.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "mapping/change/map_editor.hpp"
#include "mapping/map_reader.hpp"
#include "mapping/statements/statement.hpp"

namespace cluxel::mapping {

struct StatementEdit {
  std::vector<Statement> added;
  std::vector<ContentHash> withdrawn;
  std::string author;  ///< for the history
};

/// States and withdraws in one commit, with the objects that follow. Statements that are there, and withdrawn ones that
/// were withdrawn before, are noted; when there are no others, nothing is written. Throws Error: NotFound for a
/// statement to withdraw that was never there, or a class that the ontology does not know; InvalidArgument for a
/// property that the map computes itself; and as MapEditor does.
ChangeReport changeStatements(const std::filesystem::path& file, const StatementEdit& edit, const ChangeParams& params,
                              ProgressSink& sink);

/// A region of the map frame, anchored to the scan whose sensor stood nearest to its middle (ties: the smallest id; a
/// scan without a pose counts by the middle of its points). Throws Error (InvalidArgument) for fewer than three corners
/// or a map without scans.
RegionAnchor regionAnchor(const std::vector<Cloud>& clouds, const std::vector<Eigen::Vector2d>& corners_map);

/// A statement of a map with what is known of it.
struct KnownStatement {
  Statement statement;
  std::string effect = {};                  ///< nameOf(StatementEffect)
  std::string object = {};                  ///< IRI of the object it applies to; empty when there is none
  std::string rules_class = {};             ///< IRI of the class that the rules gave it
  bool contradicts = false;                 ///< the rules decided otherwise
  bool lacks_scans = false;                 ///< dormant because the map has none of the scans that it is anchored to
  std::string author = {}, stated_at = {};  ///< from the history; may be empty
};
std::vector<KnownStatement> knownStatements(const rdf::QuadReader& quads);

/// The statement with these first digits of its id; when there is none, one that was withdrawn. Throws Error (NotFound)
/// when there is none, or several.
ContentHash statementNamed(const rdf::QuadReader& quads, const std::string& name);

}  // namespace cluxel::mapping
