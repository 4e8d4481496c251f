// SPDX-License-Identifier: Apache-2.0
// Training places from scan files with truth: what `cluxel train` does before it trains.
#pragma once

#include <filesystem>
#include <vector>

#include "perception/training/training.hpp"
#include "perception/training/virtual_drive.hpp"
#include "perception/training/virtual_sensor.hpp"

namespace cluxel::perception {

/// Scans of one kind with their truth.
struct TrainingSource {
  std::vector<std::filesystem::path> inputs;  ///< as ScanSet::open takes them
  std::filesystem::path truth;     ///< a folder of truth files, or a label map (.yaml) for the scans' own labels
  bool only_for_training = false;  ///< used for training, never left out and scored
};

/// Settings of perception for a model that transfers to other sensors: without the features that depend on the sensor
/// more than on the object.
PerceptionParams portablePerception();

/// Simulated copies of each place as seen by other sensors; used for training only.
struct CopyParams {
  std::vector<VirtualSensor> sensors = spinningSensors();
  std::vector<VirtualDrive> drives = usualDrives();
  double thin_share = 0;  ///< if above 0: also a copy with this share of the points
};

/// Reads the sources and runs perception on them. Scans with poses in one folder form one place; a scan without a pose
/// is a place of its own. Consecutive places of a source form groups of `group_size`, which are left out together since
/// neighbours share trees and cars. Throws InputError when a scan has no truth.
std::vector<TrainingPlace> readPlaces(const std::vector<TrainingSource>& sources, const PerceptionParams& perception,
                                      const CopyParams& copies, int group_size, unsigned threads, ProgressSink& sink);

}  // namespace cluxel::perception
