// SPDX-License-Identifier: Apache-2.0
// The one coordinate system of a set of scans, which LAS files or manifests state.
#pragma once

#include <filesystem>
#include <string>

#include "cluxel/progress.hpp"
#include "scan/formats/las_crs.hpp"
#include "scan/formats/manifest.hpp"
#include "scan/scan_set.hpp"

namespace cluxel::scan {

/// The coordinate system of a manifest as a map has it: empty when the coordinates are converted from its unit to
/// metres. Warnings go to `sink`, as for LAS files: on degrees, on another unit than that of the inputs where
/// these lie in the outer frame, and on a system that is unknown or has no plane coordinates. Cost: some milliseconds.
std::string keptCrs(const Manifest& manifest, const std::filesystem::path& path, const ScanSetParams& params,
                    ProgressSink& sink);

class LasFrame {
 public:
  /// Both must outlive it. Notes on units, and on a coordinate system that is not kept, go to `sink`.
  LasFrame(const ScanSetParams& params, ProgressSink& sink) : params_(&params), sink_(&sink) {}

  /// Reads what a scan states. Throws InputError when an earlier scan states another coordinate system: only poses and
  /// map_origin of a manifest lead out of it, so that scans of different ones do not fit in one map.
  void read(const ScanFile& file);
  /// Empty when no scan states one, or the coordinates are converted.
  std::string crs() const;

 private:
  void noteUnit(const LasCrs& stated, const std::filesystem::path& path) const;

  const ScanSetParams* params_;
  ProgressSink* sink_;
  std::string crs_;
  std::filesystem::path first_;  ///< the scan that states it
  bool unit_noted_ = false;
};

}  // namespace cluxel::scan
