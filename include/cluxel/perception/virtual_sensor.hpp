// SPDX-License-Identifier: Apache-2.0
// Looks at a scanned place again, as another sensor would see it: training copies that carry a model over to it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cluxel/scan/scan.hpp"
#include "cluxel/scan/truth.hpp"

namespace cluxel {

/// Scans with the truth of their points.
struct LabelledScans {
  std::vector<Scan> scans;
  std::vector<PointTruth> truth;  ///< `primitive` only
};

/// A share of the points, chosen by hash: the same place, scanned more thinly.
LabelledScans thinned(std::span<const Scan> scans, std::span<const PointTruth> truth, double share, std::uint64_t seed);

/// A spinning laser with lines: it sees a band of elevations, and of each direction only the nearest surface.
struct VirtualSensor {
  double height_m = 1.7;  ///< above the ground it stands on
  double lowest_rad = -0.43, highest_rad = 0.05;
  int lines = 64;           ///< evenly between lowest and highest
  double step_rad = 0.004;  ///< between directions of one line
  double spacing_m = 15;    ///< it stands on ground points at most once per square of this edge
  double range_m = 60;
};

/// Usual kinds: 64 lines that look down from a car's roof, at one place, at another, and along a drive; and 32 lines
/// around the horizon at a robot's height.
std::vector<VirtualSensor> spinningSensors();

/// The points that the sensor keeps, of all scans together, from every place where it stands. Places are cells of the
/// map whose points are mostly true ground; without any there is nothing to see, and the copy is empty.
LabelledScans seenBy(std::span<const Scan> scans, std::span<const PointTruth> truth, const VirtualSensor& sensor);

}  // namespace cluxel
