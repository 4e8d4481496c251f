// SPDX-License-Identifier: Apache-2.0
// Training places from scan files with truth: what `cluxel train` does before it trains.
#pragma once

#include <filesystem>
#include <vector>

#include "cluxel/perception/training.hpp"
#include "cluxel/perception/virtual_drive.hpp"
#include "cluxel/perception/virtual_sensor.hpp"

namespace cluxel {

/// Scans of one kind with their truth.
struct TrainingSource {
  std::vector<std::filesystem::path> inputs;  ///< as ScanSet::open takes them
  std::filesystem::path truth;     ///< a folder of truth files, or a label map (.yaml) for the scans' own labels
  bool only_for_training = false;  ///< helps to train, but is never left out and measured on
};

/// Settings of perception for a model that carries over to other sensors: without the features that tell one sensor
/// from another rather than one thing from another.
PerceptionParams portablePerception();

/// Copies of each place that other sensors would have seen; they only train.
struct CopyParams {
  std::vector<VirtualSensor> sensors = spinningSensors();
  std::vector<VirtualDrive> drives = usualDrives();
  double thin_share = 0;  ///< above 0: also a copy with this share of the points
};

/// Reads and perceives the sources. Scans with poses in one folder make one place together; a scan without a pose is a
/// place of its own. Consecutive places of a source form groups of `group_size`, which are left out together:
/// neighbours share trees and cars. Throws InputError when a scan has no truth.
std::vector<TrainingPlace> readPlaces(const std::vector<TrainingSource>& sources, const PerceptionParams& perception,
                                      const CopyParams& copies, int group_size, unsigned threads, ProgressSink& sink);

}  // namespace cluxel
