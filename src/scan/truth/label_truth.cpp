// SPDX-License-Identifier: Apache-2.0
// Truth from labels: a table look-up per point, and for posts of signs a look around.
#include <algorithm>
#include <cmath>
#include <tuple>

#include "cluxel/error.hpp"
#include "scan/truth/truth.hpp"

namespace cluxel::scan {

namespace {

constexpr std::size_t kMaxClasses = 127;

struct Point2 {
  std::int64_t cell_x, cell_y;
  double x, y;
};

/// The points of one label in square cells as wide as the search radius, sorted by cell.
class NearPoints {
 public:
  NearPoints(const Scan& scan, std::uint32_t label, double radius_m) : radius_m_(radius_m) {
    for (std::size_t i = 0; i < scan.points.size(); ++i)
      if (scan.points.label[i] == label) points_.push_back(pointAt(scan, i));
    std::sort(points_.begin(), points_.end(), before);
  }

  /// Whether a point of the label is horizontally nearer to point `i` than the radius, in the map frame.
  bool isNear(const Scan& scan, std::size_t i) const {
    const Point2 p = pointAt(scan, i);
    for (std::int64_t column = p.cell_x - 1; column <= p.cell_x + 1; ++column) {
      auto q = std::lower_bound(points_.begin(), points_.end(), Point2{column, p.cell_y - 1, 0, 0}, before);
      for (; q != points_.end() && q->cell_x == column && q->cell_y <= p.cell_y + 1; ++q)
        if (std::hypot(q->x - p.x, q->y - p.y) < radius_m_) return true;
    }
    return false;
  }

 private:
  static bool before(const Point2& a, const Point2& b) {
    return std::tie(a.cell_x, a.cell_y) < std::tie(b.cell_x, b.cell_y);
  }

  Point2 pointAt(const Scan& scan, std::size_t i) const {
    const Eigen::Vector3d p = toMap(scan.T_map_sensor, {scan.points.x[i], scan.points.y[i], scan.points.z[i]});
    return {cellOf(p.x()), cellOf(p.y()), p.x(), p.y()};
  }

  /// Coordinates beyond any place on earth share the outermost cells.
  std::int64_t cellOf(double coordinate_m) const {
    return static_cast<std::int64_t>(std::floor(std::clamp(coordinate_m, -1e12, 1e12) / radius_m_));
  }

  double radius_m_;
  std::vector<Point2> points_;
};

/// What one label id gives, with its class as an index.
struct LabelCode {
  std::int8_t primitive = -1;
  std::int8_t object_class = -1;
  std::int8_t class_when_near = -1;
  std::optional<NearPoints> others;
};

std::int8_t classIndex(const std::vector<std::string>& names, const std::optional<std::string>& name) {
  if (!name) return -1;
  return static_cast<std::int8_t>(std::find(names.begin(), names.end(), *name) - names.begin());
}

std::map<std::uint32_t, LabelCode> codesOf(const Scan& scan, const LabelMap& map,
                                           const std::vector<std::string>& class_names) {
  std::map<std::uint32_t, LabelCode> codes;
  for (const auto& [id, meaning] : map.entries()) {
    LabelCode& code = codes[id];
    if (meaning.primitive) code.primitive = static_cast<std::int8_t>(*meaning.primitive);
    code.object_class = classIndex(class_names, meaning.object_class);
    if (!meaning.near) continue;
    code.class_when_near = classIndex(class_names, meaning.near->object_class);
    code.others.emplace(scan, meaning.near->other_id, meaning.near->within_m);
  }
  return codes;
}

}  // namespace

const std::vector<std::string>& truthClassNames() {
  static const std::vector<std::string> names{"Ground",     "Building",    "Tree",    "Bush",       "StreetLamp",
                                              "StreetSign", "UtilityPole", "Vehicle", "SmallObject"};
  return names;
}

std::vector<std::string> truthClassNames(const LabelMap& map) {
  std::vector<std::string> names = truthClassNames();
  const auto enter = [&](const std::string& name) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  };
  for (const auto& [id, meaning] : map.entries()) {
    if (meaning.object_class) enter(*meaning.object_class);
    if (meaning.near) enter(meaning.near->object_class);
  }
  if (names.size() > kMaxClasses) throw Error(ErrorKind::FaultyInput, "a label map names more than 127 object classes");
  return names;
}

PointTruth truthFromLabels(const Scan& scan, const LabelMap& map) {
  const std::size_t count = scan.points.size();
  if (scan.points.label.size() != count)
    throw InputError({.file = scan.source}, "the scan has no labels", "give a folder of truth files",
                     Remedy::NameTruth);
  PointTruth truth;
  truth.class_names = truthClassNames(map);
  const auto codes = codesOf(scan, map, truth.class_names);
  truth.primitive.assign(count, -1);
  truth.object_class.assign(count, -1);
  truth.instance.assign(count, -1);
  for (std::size_t i = 0; i < count; ++i) {
    const auto code = codes.find(scan.points.label[i]);
    if (code == codes.end()) continue;
    truth.primitive[i] = code->second.primitive;
    const bool near = code->second.others && code->second.others->isNear(scan, i);
    truth.object_class[i] = near ? code->second.class_when_near : code->second.object_class;
  }
  return truth;
}

}  // namespace cluxel::scan
