// SPDX-License-Identifier: Apache-2.0
// A set of scans in files: folders of a known layout, manifests, or single files. Scans are loaded one at a time.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cluxel/error.hpp"
#include "cluxel/progress.hpp"
#include "scan/input_frame.hpp"
#include "scan/scan.hpp"

namespace cluxel::scan {

enum class ScanFormat { Pcd, Ply, Kitti, Freiburg, LabelledText, Xyz, Las };
const char* nameOf(ScanFormat format);

/// How the user of the calling program states what a message asks for; a program names its options here.
struct InputRemedies {
  std::string poses = "name a poses file";
  std::string unit = "state the unit of the input (m, cm, mm, ft or us-ft)";
  std::string up = "state that y is the up axis of the input";
};

struct ScanSetParams {
  std::filesystem::path
      poses;              ///< poses (KITTI 3x4, TUM, or 4x4 text) instead of those found beside the scans, or empty
  InputFrame frame = {};  ///< of all inputs: points, poses, map_origin
  InputRemedies remedies = {};
  /// Scans with a fault are left out, and faulty() tells them. Otherwise the first fault refuses all.
  bool leaves_out_faulty = false;
};

/// One scan that is known but not loaded.
struct ScanFile {
  std::filesystem::path path;
  ScanFormat format = ScanFormat::Xyz;
  std::optional<std::filesystem::path> labels;  ///< labels in a file of their own
  std::optional<double> time_s;
  Eigen::Isometry3d T_map_sensor = Eigen::Isometry3d::Identity();  ///< in metres, z up
  bool has_pose = false;
  InputFrame frame;  ///< of the points in the file
};

/// A file that should be a scan, and what is wrong with it.
struct FaultyScan {
  std::filesystem::path path;
  InputError fault;
};

/// What a person should know about the reading of one scan.
struct ScanReading {
  std::string source;
  std::size_t no_return_count = 0;              ///< records without a finite position, which were skipped
  std::size_t withheld_count = 0;               ///< points that the file marks as deleted, which were skipped
  std::vector<std::string> ignored_fields;      ///< fields whose meaning another field has already
  std::vector<std::string> lone_origin_fields;  ///< fields of an origin that lacks the others
  std::vector<FrameDoubt> doubts;
};

struct LoadedScan {
  Scan scan;
  ScanReading reading;
};

/// A scan of a set with another pose.
struct PosedScan {
  std::size_t index = 0;  ///< in the ScanSet
  Eigen::Isometry3d T_map_sensor = Eigen::Isometry3d::Identity();
};

class ScanSet {
 public:
  /// Finds the scans in files, folders and manifests, in the order given and by name inside a folder; reads poses and
  /// the coordinate systems of LAS files, but no points. Throws InputError (what, file, line or byte), also with
  /// ScanSetParams::leaves_out_faulty when a folder, manifest or poses file has a fault. Notes go to `sink`, for
  /// example on files without a pose.
  static ScanSet open(const std::vector<std::filesystem::path>& inputs, const ScanSetParams& params,
                      ProgressSink& sink);

  /// Only these scans, in this order, with these poses.
  ScanSet posed(const std::vector<PosedScan>& scans) const;

  /// Only these scans, in this order.
  ScanSet only(const std::vector<std::size_t>& scans) const;

  std::size_t size() const { return files_.size(); }
  const ScanFile& file(std::size_t index) const { return files_.at(index); }
  /// Reads scan `index` completely and gives it its id. Throws InputError; never returns an empty or partly read scan.
  Scan load(std::size_t index) const { return read(index).scan; }
  /// As load(), and what was remarkable in the file.
  LoadedScan read(std::size_t index) const;
  /// The origin of the map frame in the outer frame [m], from a manifest, else 0.
  const Eigen::Vector3d& mapOrigin() const { return map_origin_; }
  /// The coordinate reference system of the outer frame, from a manifest or LAS files ("EPSG:n" or WKT); may be empty.
  const std::string& crs() const { return crs_; }
  /// Scans that were left out.
  const std::vector<FaultyScan>& faulty() const { return faulty_; }
  const InputRemedies& remedies() const { return remedies_; }

 private:
  std::vector<ScanFile> files_;
  Eigen::Vector3d map_origin_ = Eigen::Vector3d::Zero();
  std::string crs_;
  std::vector<FaultyScan> faulty_;
  InputRemedies remedies_;
};

/// Collects the readings of a set and puts them in words for the user.
class ReadingNotes {
 public:
  explicit ReadingNotes(InputRemedies remedies) : remedies_(std::move(remedies)) {}
  /// Notes that should come at once: doubts that no earlier scan had.
  std::vector<std::string> add(const ScanReading& reading);
  /// Notes on all scans together: skipped records and ignored fields.
  std::vector<std::string> totals() const;

 private:
  InputRemedies remedies_;
  std::vector<FrameDoubt> doubts_;
  std::size_t scans_ = 0, scans_with_no_return_ = 0, no_return_count_ = 0, withheld_count_ = 0;
  std::string first_with_no_return_, first_with_withheld_;
  /// Names of ignored fields, each once, and the first scan that has one.
  struct Fields {
    std::vector<std::string> names;
    std::string first;
    void add(const std::vector<std::string>& fields, const std::string& source);
    std::string note(const std::string& why) const;
  };
  Fields ignored_, lone_origins_;
};

}  // namespace cluxel::scan
