// SPDX-License-Identifier: Apache-2.0
// Training copies of a place as mapped from a moving vehicle: many scans close together, with drifting poses.
#pragma once

#include <span>
#include <vector>

#include "perception/training/virtual_sensor.hpp"

namespace cluxel::perception {

/// Straight drives over true ground. A surface seen by several scans appears several times, displaced by the error of
/// each scan's pose: small registration errors make walls thick and poles elongated.
struct VirtualDrive {
  VirtualSensor sensor{.spacing_m = 60, .range_m = 45};  ///< at most one drive's middle per square of `spacing_m`
  int scans = 12;                                        ///< of one drive
  double step_m = 0.9;                                   ///< between scans
  double drift_forward_m = 0.0;                          ///< of the pose per scan, along the drive
  double drift_sideways_m = 0.0;                         ///< per scan, to the left
  double drift_yaw_rad = 0.0;                            ///< per scan
  double range_noise_m = 0.02;                           ///< standard deviation along the ray
  double heading_rad = 0.0;                              ///< added to the direction in which the ground is longest
};

/// Drives with exact poses, with a small drift, and with a drift of some decimetres.
std::vector<VirtualDrive> usualDrives();

/// One scan per stop of each drive, with its drifted pose and the truth of its points; empty without ground.
LabelledScans seenAlong(std::span<const scan::Scan> scans, std::span<const scan::PointTruth> truth,
                        const VirtualDrive& drive);

}  // namespace cluxel::perception
