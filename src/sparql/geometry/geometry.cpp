// SPDX-License-Identifier: Apache-2.0
// Geometry in the plane with Boost.Geometry.
#include "sparql/geometry/geometry.hpp"

// GCC 12 reports boxes of Boost.Geometry 1.74 as maybe uninitialised (a false positive); Clang lacks this warning.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#include <algorithm>
#include <array>
#include <charconv>
#include <limits>

#include "base/proj_reference_system.hpp"
#include "rdf/wkt_reader.hpp"
#include "sparql/geometry/geometry_parts.hpp"
#include "sparql/geometry/search_frame.hpp"
#include "sparql/values/value.hpp"

namespace cluxel::sparql {
namespace bg = boost::geometry;
namespace {

using Point = PlanePoint;
using Line = PlaneLine;
using Polygon = PlanePolygon;
constexpr std::size_t kMaxCached = 200'000;

Line lineOf(const rdf::WktPath& path) {
  Line line;
  for (const auto& [x, y] : path) line.emplace_back(x, y);
  return line;
}

void addParts(const rdf::WktShape& shape, Geometry& out) {
  for (const auto& [x, y] : shape.points) out.points.emplace_back(x, y);
  for (const rdf::WktPath& path : shape.lines) out.lines.push_back(lineOf(path));
  for (const auto& rings : shape.polygons) {
    Polygon polygon;
    for (std::size_t i = 0; i < rings.size(); ++i) {
      const Line ring = lineOf(rings[i]);
      if (i > 0) polygon.inners().emplace_back();
      auto& target = i == 0 ? polygon.outer() : polygon.inners().back();
      target.assign(ring.begin(), ring.end());
    }
    bg::correct(polygon);
    out.polygons.push_back(std::move(polygon));
  }
}

/// True when `test` is true for some pair of parts.
template <typename Test>
bool anyPair(const Geometry& a, const Geometry& b, Test test) {
  const auto against = [&](const auto& part) {
    return (!b.points.empty() && test(part, b.points)) || (!b.lines.empty() && test(part, b.lines)) ||
           (!b.polygons.empty() && test(part, b.polygons));
  };
  return (!a.points.empty() && against(a.points)) || (!a.lines.empty() && against(a.lines)) ||
         (!a.polygons.empty() && against(a.polygons));
}

/// True when `test` is true for some part of the geometry.
template <typename Test>
bool anyKind(const Geometry& geometry, Test test) {
  return (!geometry.polygons.empty() && test(geometry.polygons)) || (!geometry.lines.empty() && test(geometry.lines)) ||
         (!geometry.points.empty() && test(geometry.points));
}

/// The point of a geometry that is one point; else null.
const Point* onlyPoint(const Geometry& geometry) {
  const bool is_point = geometry.points.size() == 1 && geometry.lines.empty() && geometry.polygons.empty();
  return is_point ? &geometry.points.front() : nullptr;
}

/// Tests a part against the outer parts of at least its dimension.
struct Within {
  const Geometry& outer;

  /// Includes the boundary.
  bool covers(const Point& point) const {
    return anyKind(outer, [&point](const auto& parts) { return bg::covered_by(point, parts); });
  }
  bool covers(const Line& line) const {
    return (!outer.polygons.empty() && bg::covered_by(line, outer.polygons)) ||
           (!outer.lines.empty() && bg::covered_by(line, outer.lines));
  }
  bool covers(const Polygon& polygon) const {
    return !outer.polygons.empty() && bg::covered_by(polygon, outer.polygons);
  }

  /// The interior intersects the part.
  bool holds(const Point& point) const {
    return anyKind(outer, [&point](const auto& parts) { return bg::within(point, parts); });
  }
  bool holds(const Line& line) const {
    return (!outer.polygons.empty() && bg::within(line, outer.polygons)) ||
           (!outer.lines.empty() && bg::within(line, outer.lines));
  }
  bool holds(const Polygon& polygon) const { return covers(polygon); }
};

}  // namespace

std::shared_ptr<const Geometry> parseWkt(std::string_view text) {
  const auto parts = rdf::splitWkt(text);
  if (!parts) return nullptr;
  const auto shape = rdf::readWkt(parts->shape);
  if (!shape) return nullptr;
  auto geometry = std::make_shared<Geometry>();
  geometry->crs = parts->reference_system;
  addParts(*shape, *geometry);
  geometry->has_height = shape->has_height;
  return geometry;
}

Box2 planeBoxOf(const Geometry& geometry) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  Box2 box{kFar, kFar, -kFar, -kFar};
  const auto grow = [&box](const Point& point) {
    box = {std::min(box.min_x, point.x()), std::min(box.min_y, point.y()), std::max(box.max_x, point.x()),
           std::max(box.max_y, point.y())};
  };
  bg::for_each_point(geometry.points, grow);
  bg::for_each_point(geometry.lines, grow);
  bg::for_each_point(geometry.polygons, grow);
  return box;
}

std::optional<std::string> envelopeWkt(const Geometry& geometry) {
  const Box2 box = planeBoxOf(geometry);
  if (box.min_x > box.max_x) return std::nullopt;
  const auto corner = [](double x, double y) {
    std::array<char, 64> buffer{};
    char* end = std::to_chars(buffer.data(), buffer.data() + 31, x).ptr;
    *end++ = ' ';
    end = std::to_chars(end, buffer.data() + buffer.size(), y).ptr;
    return std::string(buffer.data(), end);
  };
  return (geometry.crs.empty() ? "" : geometry.crs + " ") + "POLYGON((" + corner(box.min_x, box.min_y) + ", " +
         corner(box.max_x, box.min_y) + ", " + corner(box.max_x, box.max_y) + ", " + corner(box.min_x, box.max_y) +
         ", " + corner(box.min_x, box.min_y) + "))";
}

const std::string& systemOf(const Geometry& geometry) {
  return geometry.crs;
}

bool hasHeight(const Geometry& geometry) {
  return geometry.has_height;
}

bool namesReferenceSystem(const Geometry& geometry) {
  return !geometry.crs.empty();
}

double distanceBetween(const Geometry& a, const Geometry& b) {
  if (const auto p = onlyPoint(a), q = onlyPoint(b); p && q) return bg::distance(*p, *q);
  double min_distance = std::numeric_limits<double>::infinity();
  anyPair(a, b, [&min_distance](const auto& part, const auto& other) {
    min_distance = std::min(min_distance, static_cast<double>(bg::distance(part, other)));
    return min_distance == 0;
  });
  return min_distance;
}

bool intersects(const Geometry& a, const Geometry& b) {
  return anyPair(a, b, [](const auto& part, const auto& other) { return bg::intersects(part, other); });
}

/// No point lies outside, and some interior point lies inside.
bool within(const Geometry& a, const Geometry& b) {
  const Within test{b};
  const auto all = [&test](const auto& parts) {
    return std::all_of(parts.begin(), parts.end(), [&test](const auto& part) { return test.covers(part); });
  };
  const auto any = [&test](const auto& parts) {
    return std::any_of(parts.begin(), parts.end(), [&test](const auto& part) { return test.holds(part); });
  };
  return all(a.points) && all(a.lines) && all(a.polygons) && (any(a.points) || any(a.lines) || any(a.polygons));
}

bool touches(const Geometry& a, const Geometry& b) {
  bool any = false;
  const bool overlap = anyPair(a, b, [&any](const auto& part, const auto& other) {
    if (!bg::intersects(part, other)) return false;
    any = true;
    return !bg::touches(part, other);
  });
  return any && !overlap;
}

struct GeometryCache::NumberedFrame {
  std::string name;
  SearchFrame frame;
};

GeometryCache::GeometryCache() = default;
GeometryCache::~GeometryCache() = default;

const std::shared_ptr<const Geometry>* GeometryCache::known(std::uint32_t id) const {
  const auto found = stored_.find(id);
  return found == stored_.end() ? nullptr : &found->second;
}

std::shared_ptr<const Geometry> GeometryCache::add(std::uint32_t id, std::string_view text) {
  if (stored_.size() >= kMaxCached) stored_.clear();
  return stored_.emplace(id, parseWkt(text)).first->second;
}

std::shared_ptr<const Geometry> GeometryCache::find(std::string_view text) {
  const auto known = parsed_.find(text);
  if (known != parsed_.end()) return known->second;
  if (parsed_.size() >= kMaxCached) parsed_.clear();
  return parsed_.emplace(std::string(text), parseWkt(text)).first->second;
}

const ReferenceSystem& GeometryCache::system(const std::string& name) {
  auto& known = systems_[name];
  if (!known) known = std::make_unique<const ReferenceSystem>(referenceSystem(name));
  return *known;
}

std::optional<SearchBox> GeometryCache::searchBox(const Geometry& geometry) {
  if (geometry.crs.empty()) return SearchBox{planeBoxOf(geometry), SearchBox::kMapFrame};
  auto known = std::find_if(frames_.begin(), frames_.end(),
                            [&](const NumberedFrame& numbered) { return numbered.name == geometry.crs; });
  if (known == frames_.end())
    known = frames_.insert(frames_.end(), NumberedFrame{geometry.crs, SearchFrame(system(geometry.crs))});
  const auto box = known->frame.boxOf(geometry);
  if (!box) return std::nullopt;
  return SearchBox{*box, static_cast<std::uint32_t>(known - frames_.begin() + 1)};
}

const std::string& GeometryCache::systemName(std::uint32_t number) const {
  static const std::string map_frame;
  return number == SearchBox::kMapFrame ? map_frame : frames_.at(number - 1).name;
}

}  // namespace cluxel::sparql
