// SPDX-License-Identifier: Apache-2.0
// Longitude and latitude of positions in the map frame.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>

namespace cluxel::tasks {

/// Places the map frame on the earth: x points east and y north in a projected coordinate system, in metres.
class GeoReference {
 public:
  /// `crs`: as PROJ reads it ("EPSG:25832", PROJ string, WKT). `map_origin`: origin of the map frame in it [m].
  /// Throws Error (FaultyInput, Remedy::LocalFrame) when `crs` is unknown or is no projected system in metres.
  GeoReference(const std::string& crs, const Eigen::Vector3d& map_origin);
  ~GeoReference();
  GeoReference(GeoReference&&) noexcept;

  /// WGS 84 longitude and latitude [deg]. Throws Error (FaultyInput) where the projection is not defined.
  Eigen::Vector2d longitudeLatitude(const Eigen::Vector2d& p_map) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cluxel::tasks
