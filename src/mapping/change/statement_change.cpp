// SPDX-License-Identifier: Apache-2.0
// Statements stand in graph `operator`; who stated them and when stands in graph `history`.
#include "mapping/change/statement_change.hpp"

#include <algorithm>
#include <set>

#include "cluxel/error.hpp"
#include "mapping/statements/stated_values.hpp"
#include "mapping/statements/statement_facts.hpp"
#include "mapping/statements/statement_history.hpp"
#include "mapping/thing_history.hpp"
#include "rdf/map_iris.hpp"

namespace cluxel::mapping {

namespace {

using rdf::vocabulary::clx;

constexpr std::size_t kStatementDigits = 4;

/// The middle of what a scan saw from.
Eigen::Vector2d standOf(const Cloud& cloud) {
  const Eigen::Vector3d middle = 0.5 * (cloud.min + cloud.max);
  return (cloud.has_pose ? Eigen::Vector3d(cloud.T_map_sensor.translation()) : middle).head<2>();
}

}  // namespace

ChangeReport changeStatements(const std::filesystem::path& file, const StatementEdit& edit, const ChangeParams& params,
                              ProgressSink& sink) {
  MapEditor editor(file, params, sink);
  for (const Statement& statement : edit.added) {
    requireStatable(statement, editor.inputs().rules.catalogue);
    if (std::find(edit.withdrawn.begin(), edit.withdrawn.end(), statement.id()) != edit.withdrawn.end())
      throw Error(ErrorKind::InvalidArgument,
                  "the statement " + statement.id().hex() + " is both made and withdrawn; do one of them");
  }
  rdf::WriteTransaction transaction = editor.begin();
  bool has_changes = false;
  for (const ContentHash& id : std::set<ContentHash>(edit.withdrawn.begin(), edit.withdrawn.end())) {
    const bool was_there = withdrawStatement(transaction, id, edit.author);
    if (!was_there) sink.note("the statement " + id.hex() + " was withdrawn already");
    has_changes = has_changes || was_there;
  }
  for (const Statement& statement : edit.added) {
    requireNoWholeClass(transaction, statement);
    const bool is_new = addStatement(transaction, statement, edit.author);
    if (!is_new) sink.note("the statement " + statement.id().hex() + " was made already");
    has_changes = has_changes || is_new;
  }
  if (has_changes)
    editor.commit(transaction, "state", {}, {});
  else
    editor.result().statements = toldOutcomes(rdf::QuadReader(static_cast<const rdf::ReadTransaction&>(transaction)));
  return editor.takeReport();
}

RegionAnchor regionAnchor(const std::vector<Cloud>& clouds, const std::vector<Eigen::Vector2d>& corners_map) {
  if (corners_map.size() < 3) throw Error(ErrorKind::InvalidArgument, "a region needs at least three corners");
  if (clouds.empty()) throw Error(ErrorKind::InvalidArgument, "the map has no scan to anchor a region to");
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& corner : corners_map) middle += corner / static_cast<double>(corners_map.size());
  const Cloud& nearest = *std::min_element(clouds.begin(), clouds.end(), [&](const Cloud& a, const Cloud& b) {
    return std::pair((standOf(a) - middle).squaredNorm(), a.id) < std::pair((standOf(b) - middle).squaredNorm(), b.id);
  });
  RegionAnchor region{nearest.id, {}};
  const double height = nearest.T_map_sensor.translation().z();
  for (const Eigen::Vector2d& corner : corners_map)
    region.corners.emplace_back(nearest.T_map_sensor.inverse() * Eigen::Vector3d(corner.x(), corner.y(), height));
  return region;
}

std::vector<KnownStatement> knownStatements(const rdf::QuadReader& quads) {
  std::vector<KnownStatement> all;
  for (const Statement& statement : storedStatements(quads)) {
    KnownStatement known{.statement = statement};
    const std::string iri = rdf::iriOfStatement(statement.id());
    for (const Quad& quad : quadsAbout(quads, iri, rdf::vocabulary::kGraphObserved)) {
      if (quad.predicate.text == clx("statementEffect")) known.effect = quad.object.text;
      if (quad.predicate.text == clx("appliesTo")) known.object = quad.object.text;
      if (quad.predicate.text == clx("rulesSay")) known.rules_class = quad.object.text;
      if (quad.predicate.text == clx("contradictsRules")) known.contradicts = quad.object.text == "true";
    }
    known.lacks_scans = known.effect == nameOf(StatementEffect::Dormant) && lacksScans(quads, statement);
    const StatementRecord record = recordOf(quads, statement.id());
    known.author = record.author, known.stated_at = record.stated_at;
    all.push_back(std::move(known));
  }
  return all;
}

ContentHash statementNamed(const rdf::QuadReader& quads, const std::string& name) {
  const std::string digits = name.substr(name.rfind('/') + 1);
  if (digits.size() < kStatementDigits)
    throw Error(ErrorKind::InvalidArgument, "'" + name + "': write at least four digits of the statement's id");
  std::set<ContentHash> fitting;
  for (const Statement& statement : storedStatements(quads))
    if (statement.id().hex().starts_with(digits)) fitting.insert(statement.id());
  if (fitting.empty())
    for (const ContentHash& id : withdrawnStatements(quads))
      if (id.hex().starts_with(digits)) fitting.insert(id);
  if (fitting.size() != 1)
    throw Error(ErrorKind::NotFound, "'" + name + "' names " + (fitting.empty() ? "no" : "more than one") +
                                         " operator statement of the map");
  return *fitting.begin();
}

}  // namespace cluxel::mapping
