// SPDX-License-Identifier: Apache-2.0
// The name of a scan is a hash of what was measured.
#include "scan/scan.hpp"

#include <span>

namespace cluxel::scan {

namespace {

/// Three floats a ray origin, without whatever padding a vector type may have.
std::vector<float> flattened(const std::vector<Eigen::Vector3f>& origins) {
  std::vector<float> flat;
  flat.reserve(3 * origins.size());
  for (const Eigen::Vector3f& origin : origins) flat.insert(flat.end(), origin.data(), origin.data() + 3);
  return flat;
}

}  // namespace

ScanId contentIdOf(const Scan& scan) {
  const ScanPoints& points = scan.points;
  ContentHasher hasher;
  hasher.addText("cluxel scan 2");
  hasher.addSpan(std::span<const float>(points.x));
  hasher.addSpan(std::span<const float>(points.y));
  hasher.addSpan(std::span<const float>(points.z));
  hasher.addSpan(std::span<const float>(points.intensity));
  hasher.addSpan(std::span<const float>(flattened(points.origin)));
  return hasher.finish();
}

}  // namespace cluxel::scan
