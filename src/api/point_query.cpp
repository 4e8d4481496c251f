// SPDX-License-Identifier: Apache-2.0
// Points of scans and objects in the map frame.
#include "api/point_query.hpp"

#include <functional>
#include <optional>

#include "cluxel/error.hpp"
#include "mapping/facts/object_geometry.hpp"
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

/// Appends the points of a scan whose object number is accepted.
void append(const mapping::MapReader& map, const mapping::Cloud& cloud,
            const std::function<bool(std::uint32_t)>& accept, bool with_intensity, PointCloud& out) {
  const scan::ScanPoints points = map.pointsOf(cloud.id);
  const mapping::PointAnswers answers = map.answersFor(cloud);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!accept(answers.object[i])) continue;
    const Eigen::Vector3d p_map = scan::toMap(cloud.T_map_sensor, {points.x[i], points.y[i], points.z[i]});
    out.x.push_back(p_map.x());
    out.y.push_back(p_map.y());
    out.z.push_back(p_map.z());
    if (with_intensity && !points.intensity.empty()) out.intensity.push_back(points.intensity[i]);
    out.label.push_back(static_cast<PrimitiveLabel>(answers.label[i]));
    out.object.push_back(answers.object[i]);
  }
  if (out.intensity.size() != out.size()) out.intensity.clear();
}

bool meets(const mapping::Cloud& cloud, const mapping::ObjectGeometry& object) {
  return (cloud.min.array() <= object.max.array()).all() && (object.min.array() <= cloud.max.array()).all();
}

}  // namespace

std::vector<Cloud> cloudsOf(const mapping::MapReader& map) {
  std::vector<Cloud> clouds;
  for (const mapping::Cloud& cloud : map.clouds()) clouds.push_back(valueOf(cloud));
  return clouds;
}

PointCloud pointsOf(const mapping::MapReader& map, const Cloud& cloud) {
  PointCloud points;
  for (const mapping::Cloud& stored : map.clouds())
    if (stored.id.hex() == cloud.id) {
      append(
          map, stored, [](std::uint32_t) { return true; }, true, points);
      return points;
    }
  throw Error(ErrorKind::NotFound, "the map has no scan '" + cloud.id + "' (any more)");
}

PointCloud pointsOf(const mapping::MapReader& map, const std::string& object) {
  const auto number = static_cast<std::uint32_t>(tasks::objectNamed(map, object));
  const mapping::ObjectGeometry geometry =
      mapping::geometryOf(map.scene().cluxels, mapping::cluxelsOf(map.objects()[number]));
  PointCloud points;
  bool with_intensity = true;
  for (const mapping::Cloud& cloud : map.clouds()) {
    if (!meets(cloud, geometry)) continue;
    append(
        map, cloud, [number](std::uint32_t found) { return found == number; }, with_intensity, points);
    with_intensity = with_intensity && (points.size() == 0 || !points.intensity.empty());
  }
  return points;
}

}  // namespace cluxel
