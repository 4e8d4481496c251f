// SPDX-License-Identifier: Apache-2.0
// Resamples a scanned place as another sensor would see it: training copies that help a model transfer to that sensor.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "scan/scan.hpp"
#include "scan/truth/truth.hpp"

namespace cluxel::perception {

/// Scans with the truth of their points.
struct LabelledScans {
  std::vector<scan::Scan> scans;
  std::vector<scan::PointTruth> truth;  ///< `primitive` only
};

/// A share of the points, chosen by hash: the same place, scanned with a lower density.
LabelledScans thinned(std::span<const scan::Scan> scans, std::span<const scan::PointTruth> truth, double share,
                      std::uint64_t seed);

/// A spinning multi-line laser: it sees a band of elevations, and in each direction only the nearest surface.
struct VirtualSensor {
  double height_m = 1.7;  ///< above the ground it stands on
  double lowest_rad = -0.43, highest_rad = 0.05;
  int lines = 64;           ///< evenly between lowest and highest
  double step_rad = 0.004;  ///< between directions of one line
  double spacing_m = 15;    ///< at most one sensor position per square of this edge
  double range_m = 60;
};

/// Common configurations: 64 lines looking down from a car's roof with different spacings, and 32 lines around the
/// horizon at a robot's height.
std::vector<VirtualSensor> spinningSensors();

/// The points of all scans that are visible from any of the sensor's positions. Positions are cells of the map whose
/// points are mostly true ground; without such cells the copy is empty.
LabelledScans seenBy(std::span<const scan::Scan> scans, std::span<const scan::PointTruth> truth,
                     const VirtualSensor& sensor);

}  // namespace cluxel::perception
