// SPDX-License-Identifier: Apache-2.0
// Training copies of a place as a sensor on a moving vehicle would map it: many scans close together, whose poses
// drift.
#pragma once

#include <span>
#include <vector>

#include "cluxel/perception/virtual_sensor.hpp"

namespace cluxel {

/// Straight drives over true ground. What several scans see is in the copy several times, each time moved by the error
/// of that scan's pose: a registration that is a little wrong makes slabs of walls and streaks of poles.
struct VirtualDrive {
  VirtualSensor sensor{.spacing_m = 60, .range_m = 45};  ///< a drive is half-way at most once per square of `spacing_m`
  int scans = 12;                                        ///< of one drive
  double step_m = 0.9;                                   ///< between scans
  double drift_forward_m = 0.0;                          ///< of the pose per scan, along the drive
  double drift_sideways_m = 0.0;                         ///< per scan, to the left
  double drift_yaw_rad = 0.0;                            ///< per scan
  double range_noise_m = 0.02;                           ///< standard deviation along the ray
  double heading_rad = 0.0;                              ///< added to the direction in which the ground is longest
};

/// Drives with poses that fit, that drift a little, and that drift by some decimetres.
std::vector<VirtualDrive> usualDrives();

/// One scan per stop of each drive, with its (wrong) pose and the truth of its points; empty where no ground is.
LabelledScans seenAlong(std::span<const Scan> scans, std::span<const PointTruth> truth, const VirtualDrive& drive);

}  // namespace cluxel
