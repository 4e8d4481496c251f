// SPDX-License-Identifier: Apache-2.0
// Points of scans and objects in the map frame.
#include "api/point_query.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "cluxel/error.hpp"
#include "rdf/map_iris.hpp"
#include "scan/truth/primitive_label.hpp"
#include "tasks/thing_names.hpp"

namespace cluxel {

static_assert(static_cast<std::uint8_t>(PrimitiveLabel::Scatter) ==
                  static_cast<std::uint8_t>(scan::PrimitiveLabel::Scatter) &&
              kNoObject == mapping::kNoObjectOfPoint);

std::string_view nameOf(PrimitiveLabel label) {
  return scan::nameOf(static_cast<scan::PrimitiveLabel>(label));
}

namespace {

Position positionOf(const Eigen::Vector3d& p_map) {
  return {p_map.x(), p_map.y(), p_map.z()};
}

Cloud valueOf(const mapping::Cloud& stored) {
  Cloud cloud;
  cloud.id = stored.id.hex();
  cloud.iri = rdf::iriOfCloud(stored.id);
  cloud.source = stored.source;
  cloud.time_s = stored.time_s;
  cloud.has_pose = stored.has_pose;
  Eigen::Map<Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(cloud.T_map_sensor.data()) = stored.T_map_sensor.matrix();
  cloud.point_count = stored.point_count;
  cloud.min = positionOf(stored.min);
  cloud.max = positionOf(stored.max);
  return cloud;
}

/// Appends one point of a scan.
void append(const mapping::Cloud& cloud, const scan::ScanPoints& points, std::size_t i, std::uint8_t label,
            std::uint32_t object, PointCloud& out) {
  const Eigen::Vector3d p_map = scan::toMap(cloud.T_map_sensor, {points.x[i], points.y[i], points.z[i]});
  out.x.push_back(p_map.x());
  out.y.push_back(p_map.y());
  out.z.push_back(p_map.z());
  if (!points.intensity.empty()) out.intensity.push_back(points.intensity[i]);
  out.label.push_back(static_cast<PrimitiveLabel>(label));
  out.object.push_back(object);
}

/// Points of scans with and without intensities have none.
PointCloud withWholeIntensity(PointCloud points) {
  if (points.intensity.size() != points.size()) points.intensity.clear();
  return points;
}

}  // namespace

std::vector<Cloud> cloudsOf(const mapping::MapReader& map) {
  std::vector<Cloud> clouds;
  for (const mapping::Cloud& cloud : map.clouds()) clouds.push_back(valueOf(cloud));
  return clouds;
}

PointCloud pointsOf(const mapping::MapReader& map, mapping::KeptAnswers& kept, const Cloud& cloud) {
  const std::vector<mapping::Cloud> clouds = map.clouds();
  const auto stored =
      std::find_if(clouds.begin(), clouds.end(), [&](const mapping::Cloud& one) { return one.id.hex() == cloud.id; });
  if (stored == clouds.end()) throw Error(ErrorKind::NotFound, "the map has no scan '" + cloud.id + "' (any more)");
  const scan::ScanPoints measured = map.pointsOf(stored->id);
  const mapping::PointAnswers answers = kept.answersFor(map, *stored, measured);
  PointCloud points;
  for (std::size_t i = 0; i < measured.size(); ++i)
    append(*stored, measured, i, answers.label[i], answers.object[i], points);
  return withWholeIntensity(std::move(points));
}

PointCloud pointsOf(const mapping::MapReader& map, mapping::KeptAnswers& kept, const std::string& object) {
  const auto number = static_cast<std::uint32_t>(tasks::objectNamed(map, object));
  PointCloud points;
  kept.forEachCloud(
      map, number,
      [&](const mapping::Cloud& stored, const scan::ScanPoints& measured, const mapping::LabelledPoints& labelled) {
        for (const auto& [i, label] : labelled) append(stored, measured, i, label, number, points);
      });
  return withWholeIntensity(std::move(points));
}

}  // namespace cluxel
