// SPDX-License-Identifier: Apache-2.0
// A set of scans that lie in files: folders in a known layout, manifests, or single files. Scans are loaded one at a
// time.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cluxel/base/progress.hpp"
#include "cluxel/scan/scan.hpp"

namespace cluxel {

enum class ScanFormat { Pcd, Ply, Kitti, Freiburg, LabelledText, Xyz, Las };
const char* nameOf(ScanFormat format);

struct ScanSetParams {
  std::filesystem::path poses;  ///< a poses file given by hand (KITTI 3x4, TUM, or 4x4 text), or empty
};

/// One scan that is known but not loaded.
struct ScanFile {
  std::filesystem::path path;
  ScanFormat format = ScanFormat::Xyz;
  std::optional<std::filesystem::path> labels;  ///< labels in a file of their own
  std::optional<double> time_s;
  Eigen::Isometry3d T_map_sensor = Eigen::Isometry3d::Identity();
  bool has_pose = false;
};

/// A scan of a set with another pose.
struct PosedScan {
  std::size_t index = 0;  ///< in the ScanSet
  Eigen::Isometry3d T_map_sensor = Eigen::Isometry3d::Identity();
};

class ScanSet {
 public:
  /// Finds the scans in files, folders and manifests, in the order given and by name inside a folder; reads poses but
  /// no points. Throws InputError (what, file, line or byte). Notes go to `sink`: lone files without a pose, for
  /// example.
  static ScanSet open(const std::vector<std::filesystem::path>& inputs, const ScanSetParams& params,
                      ProgressSink& sink);

  /// These scans alone, in this order, with the poses given here.
  ScanSet posed(const std::vector<PosedScan>& scans) const;

  std::size_t size() const { return files_.size(); }
  const ScanFile& file(std::size_t index) const { return files_.at(index); }
  /// Reads scan `index` whole and gives it its id. Throws InputError; never returns an empty or partly read scan.
  Scan load(std::size_t index) const;
  /// The origin of the map frame in the outer frame [m], from a manifest, else 0; and the CRS, when one is given.
  const Eigen::Vector3d& mapOrigin() const { return map_origin_; }
  const std::string& crs() const { return crs_; }

 private:
  std::vector<ScanFile> files_;
  Eigen::Vector3d map_origin_ = Eigen::Vector3d::Zero();
  std::string crs_;
};

}  // namespace cluxel
