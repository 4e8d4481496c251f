// SPDX-License-Identifier: Apache-2.0
// A generated campus as a place to search: true ground, what can be found, and the map of its first scans.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "mapping/map_reader.hpp"
#include "simulation/laser/laser.hpp"
#include "tasks/search/search_tour.hpp"

namespace cluxel::bench {

struct WorldParams {
  std::uint64_t seed = 1;
  double size_m = 100, points_per_stop = 60'000;
  double known_share = 0.3;  ///< of the scans along the route, the first ones, that the map holds
  std::string class_name = "StreetSign";
  double view_m = 10, eye_m = 1.2, cell_m = 0.5;
};

/// Something to find: found from a place when a ray from the eye to one of its points meets it first.
struct SearchTarget {
  std::int32_t instance = -1;
  Eigen::Vector2d at;
  std::vector<Eigen::Vector3d> points;  ///< on its surfaces [m, map]
};

class SearchWorld {
 public:
  /// Generates the campus, scans it and builds the map in `folder`.
  SearchWorld(const WorldParams& params, const std::filesystem::path& folder, const std::filesystem::path& home);

  const WorldParams& params() const { return params_; }
  const mapping::MapReader& map() const { return *map_; }
  /// The grid over the site; true closure: Thing where something stands or the site ends, else Open.
  const tasks::GridFrame& frame() const { return frame_; }
  const LargeArray<tasks::Closure>& closure() const { return closure_; }
  const tasks::SightGrid& sight() const { return sight_; }
  /// Of the class, not in the map, and visible from reachable ground.
  const std::vector<SearchTarget>& targets() const { return targets_; }
  std::size_t objectsOfClass() const { return objects_of_class_; }
  bool isSeenFrom(const SearchTarget& target, std::uint32_t cell) const;
  /// The map's belief of what is passable: unobserved ground is open, the site's border closed.
  tasks::PassableGrid belief() const;
  tasks::TerrainGrid terrain() const;
  Eigen::Vector2d start() const;
  bool isInSite(std::uint32_t cell) const { return isInSite(frame_.centreOf(cell)); }

 private:
  void rasterise();
  void buildMap(const std::filesystem::path& folder, const std::filesystem::path& home);
  void chooseTargets();
  bool isInSite(const Eigen::Vector2d& p) const;
  tasks::PassableGrid trueGrid() const;

  WorldParams params_;
  simulation::Campus campus_;
  std::unique_ptr<simulation::Laser> laser_;
  std::unique_ptr<mapping::MapReader> map_;
  tasks::GridFrame frame_;
  std::vector<float> height_;
  LargeArray<tasks::Closure> closure_;
  tasks::SightGrid sight_;
  std::vector<SearchTarget> targets_;
  std::size_t objects_of_class_ = 0;
};

/// Builds a map of the first `share` of the scans of a campus and returns its file.
std::filesystem::path buildCampusMap(const simulation::Campus& campus, const simulation::Laser& laser, double share,
                                     const std::filesystem::path& folder, const std::filesystem::path& home);

}  // namespace cluxel::bench
