// SPDX-License-Identifier: Apache-2.0
// The visible part of each object in the scans: the rows of truth/instances.csv.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "simulation/laser/laser.hpp"

namespace cluxel::simulation {

/// The points of one object in one scan or in all.
struct InstanceSight {
  std::size_t points = 0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();  ///< of the points [m, map]
  Eigen::AlignedBox3d box;                        ///< around the points [m, map]
  std::vector<Eigen::Vector2d> outline;           ///< convex hull of the points from above [m, map]
  std::map<std::uint32_t, std::size_t> points_of_label;
};
using InstanceSights = std::map<std::int32_t, InstanceSight>;  ///< by instance id

InstanceSights sightsOf(const SimulatedScan& scan);

/// What several scans saw of one object.
struct SeenObject {
  InstanceSight sight;
  std::vector<std::pair<std::string, std::size_t>> points_in_scan;  ///< by the name of the scan, in the order added
};

/// Sights of all objects, collected scan by scan.
class SeenObjects {
 public:
  void add(const InstanceSights& sights, const std::string& scan);
  const std::map<std::int32_t, SeenObject>& all() const { return objects_; }
  void forget(std::int32_t id) { objects_.erase(id); }

 private:
  std::map<std::int32_t, SeenObject> objects_;
};

/// The names of the columns, which are those of `oakland3d_truth/instances.csv`, and the row of one object. Ambiguous
/// objects are too occluded, too long or too sparsely sampled to score a map by them.
std::string instanceHeader();
std::string instanceRow(std::int32_t id, const CampusObject& object, const SeenObject& seen);

/// The table: one row per object with a point.
std::string instanceTable(const Campus& campus, const SeenObjects& seen);

}  // namespace cluxel::simulation
