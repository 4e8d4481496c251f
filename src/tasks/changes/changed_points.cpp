// SPDX-License-Identifier: Apache-2.0
// Regions without a changed cluxel are passed over.
#include "tasks/changes/changed_points.hpp"

#include <algorithm>
#include <map>
#include <tuple>
#include <unordered_map>

#include "base/csv_text.hpp"
#include "mapping/presence/ray_pass.hpp"
#include "mapping/regions/map_regions.hpp"

namespace cluxel::tasks {

namespace {

/// Means of cells, of which boxes of parts are made, lie inside of them.
constexpr double kBesideBox_m = 0.1;

struct ThingOfChange {
  const ChangedThing* thing = nullptr;
  std::uint32_t change = 0;
  bool is_gone = false;
};

/// By cluxel: sheets that stand side by side may share one.
using ThingsOfCluxels = std::unordered_map<std::uint32_t, std::vector<ThingOfChange>>;

ThingsOfCluxels thingsOfCluxels(const std::vector<SiteChange>& changes) {
  ThingsOfCluxels things;
  const auto add = [&](const ChangedThing& thing, std::size_t change, bool is_gone) {
    for (const std::uint32_t cluxel : thing.cluxels)
      things[cluxel].push_back({&thing, static_cast<std::uint32_t>(change), is_gone});
  };
  for (std::size_t i = 0; i < changes.size(); ++i) {
    add(changes[i].thing, i, changes[i].kind != SiteChange::Kind::Appeared);
    if (changes[i].now) add(*changes[i].now, i, false);
  }
  return things;
}

}  // namespace

std::vector<ChangedPoint> changedPoints(const mapping::MapReader& map, const SiteChanges& changes,
                                        std::size_t max_cluxels) {
  const ThingsOfCluxels things = thingsOfCluxels(changes.changes);
  const std::vector<mapping::Cloud> clouds = cloudsWithin(map.clouds(), changes.times);
  std::vector<ChangedPoint> points;
  mapping::MapRegions regions(map, max_cluxels);
  for (std::size_t r = 0; r < regions.size(); ++r) {
    const mapping::MapRegion region = regions.read(r);
    std::vector<const std::vector<ThingOfChange>*> of_cluxel(region.number.size(), nullptr);
    bool has_changes = false;
    for (std::size_t i = 0; i < region.number.size(); ++i) {
      const auto found = things.find(region.number[i]);
      if (found == things.end()) continue;
      of_cluxel[i] = &found->second;
      has_changes = has_changes || region.is_own[i];
    }
    if (!has_changes) continue;
    for (const mapping::Cloud* cloud : mapping::timedClouds(clouds)) {
      const bool is_before = *cloud->time_s < changes.times.since_s;
      regions.forEachPoint(region, *cloud, [&](const Eigen::Vector3d& p_map, std::uint32_t cluxel, std::size_t point) {
        if (of_cluxel[cluxel] == nullptr) return;
        for (const ThingOfChange& of : *of_cluxel[cluxel]) {
          if (of.is_gone != is_before || of.thing->box.exteriorDistance(p_map) > kBesideBox_m) continue;
          points.push_back({cloud->id, static_cast<std::uint32_t>(point), of.change, of.is_gone});
          return;
        }
      });
    }
  }
  std::sort(points.begin(), points.end(), [](const ChangedPoint& a, const ChangedPoint& b) {
    return std::tie(a.cloud, a.point) < std::tie(b.cloud, b.point);
  });
  return points;
}

void writeChangedPoints(const std::vector<ChangedPoint>& points, const std::vector<mapping::Cloud>& clouds,
                        const std::function<void(std::string_view)>& write) {
  std::map<scan::ScanId, std::string> start_of_line;
  for (const mapping::Cloud& cloud : clouds)
    start_of_line[cloud.id] = cloud.id.hex() + "," + csvField(cloud.source) + ",";
  write("cloud,source,point,change,kind\r\n");
  for (const ChangedPoint& point : points)
    write(start_of_line.at(point.cloud) + std::to_string(point.point) + "," + std::to_string(point.change) +
          (point.is_gone ? ",vanished\r\n" : ",appeared\r\n"));
}

}  // namespace cluxel::tasks
