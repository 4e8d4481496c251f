// SPDX-License-Identifier: Apache-2.0
// Picks from lists of clouds.
#include "mapping/clouds/cloud.hpp"

namespace cluxel::mapping {

std::vector<perception::SceneView> viewsOf(const std::vector<Cloud>& clouds) {
  std::vector<perception::SceneView> views;
  for (const Cloud& cloud : clouds)
    if (cloud.sight) views.push_back({cloud.id, cloud.T_map_sensor, *cloud.sight});
  return views;
}

std::vector<scan::ScanId> idsOf(const std::vector<Cloud>& clouds) {
  std::vector<scan::ScanId> ids;
  for (const Cloud& cloud : clouds) ids.push_back(cloud.id);
  return ids;
}

}  // namespace cluxel::mapping
