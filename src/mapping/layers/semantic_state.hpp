// SPDX-License-Identifier: Apache-2.0
// What the layers above the tiles were last made of: the next change compares itself with it.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

#include "mapping/clouds/cloud.hpp"
#include "rdf/file/environment.hpp"

namespace cluxel::mapping {

/// A cloud as far as facts about objects follow from it.
struct SeenCloud {
  ContentHash id;
  ContentHash content;  ///< hash of pose and bounds of rays
  std::optional<double> time_s;
  bool has_pose = false;
  Eigen::AlignedBox3d rays;  ///< as in Cloud
};

/// Whether lists, each ascending by id, name the same clouds with the same poses and times.
bool areSame(const std::vector<SeenCloud>& a, const std::vector<SeenCloud>& b);

/// Whether a cloud of both lists has another time. Observations anywhere tell it.
bool haveOtherTimes(const std::vector<SeenCloud>& before, const std::vector<SeenCloud>& now);

struct SemanticState {
  std::uint64_t cluxels = 0, primitives = 0, objects = 0;
  std::vector<ContentHash> statements;  ///< of operators, ascending by id
  std::vector<SeenCloud> clouds;        ///< ascending by id
};
/// Whether two states follow from the same clouds, poses, times and statements.
bool haveSameSources(const SemanticState& a, const SemanticState& b);

void storeSemanticState(rdf::WriteTransaction& transaction, const SemanticState& state);
/// Absent in a map of which these layers were never made.
std::optional<SemanticState> storedSemanticState(const rdf::ReadTransaction& transaction);

std::vector<SeenCloud> seenClouds(const std::vector<Cloud>& clouds);
/// Whether facts about presence are told of objects: when two clouds or more have a time and a pose.
bool tellsPresence(const std::vector<SeenCloud>& clouds);
/// The bounds of the rays of clouds that came, went or changed: those of before and those of now.
std::vector<Eigen::AlignedBox3d> changedRays(const std::vector<SeenCloud>& before, const std::vector<SeenCloud>& now);

}  // namespace cluxel::mapping
