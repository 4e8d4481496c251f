// SPDX-License-Identifier: Apache-2.0
// Scans of chosen rays, which may start anywhere.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "scan/scan.hpp"

namespace cluxel::perception {

struct Ray {
  Eigen::Vector3d start, end;  ///< [m, map]
};

inline scan::Scan scanOfRays(const std::vector<Ray>& rays) {
  scan::Scan scan;
  for (const Ray& ray : rays) {
    const Eigen::Vector3f end = ray.end.cast<float>();
    scan.points.x.push_back(end.x()), scan.points.y.push_back(end.y()), scan.points.z.push_back(end.z());
    scan.points.origin.push_back(ray.start.cast<float>());
  }
  return scan;
}

}  // namespace cluxel::perception
