// SPDX-License-Identifier: Apache-2.0
// Reads manifests; docs/formats.md shows one.
#include "scan/formats/manifest.hpp"

#include <cmath>
#include <numbers>

#include "base/nearest_name.hpp"
#include "base/yaml/yaml_tree.hpp"
#include "scan/poses/pose_files.hpp"

namespace cluxel::scan {

namespace fs = std::filesystem;

namespace {

const std::vector<std::string> kManifestKeys{"map_origin", "crs", "frame", "poses", "scans"};
const std::vector<std::string> kScanKeys{"path", "pose", "time_s", "labels", "format"};
const std::vector<std::string> kPoseKeys{"xyz", "quaternion_xyzw", "rpy_deg", "rpy_rad", "matrix"};

class ManifestReader {
 public:
  ManifestReader(FaultList& faults, const fs::path& folder) : faults_(&faults), folder_(&folder) {}

  Manifest read(const YamlNode& root) {
    Manifest manifest;
    if (!checkMapping(root, kManifestKeys, *faults_)) return manifest;
    if (const YamlNode* origin = root.find("map_origin"))
      if (const auto v = numbersOf(*origin, 3, "map_origin", *faults_))
        manifest.map_origin = Eigen::Vector3d(v->data());
    if (const YamlNode* crs = root.find("crs")) manifest.crs = textOf(*crs, "crs", *faults_).value_or("");
    if (const YamlNode* frame = root.find("frame")) manifest.poses_in_outer = isOuter(*frame);
    manifest.poses = pathAt(root, "poses");
    readScans(root, manifest);
    return manifest;
  }

 private:
  bool isOuter(const YamlNode& frame) {
    if (frame.text != "map" && frame.text != "outer") faults_->error(frame.at, "frame must be 'map' or 'outer'");
    return frame.text == "outer";
  }

  std::optional<ManifestPath> pathAt(const YamlNode& mapping, const char* key) {
    const YamlNode* value = mapping.find(key);
    if (!value) return std::nullopt;
    const auto text = textOf(*value, key, *faults_);
    if (!text) return std::nullopt;
    return ManifestPath{*folder_ / *text, value->at};
  }

  void readScans(const YamlNode& root, Manifest& manifest) {
    const YamlNode* scans = root.find("scans");
    if (!scans || !scans->isSequence() || scans->items.empty()) {
      faults_->error((scans ? *scans : root).at, "a manifest needs 'scans', a list that is not empty");
      return;
    }
    for (const YamlNode& scan : scans->items) manifest.scans.push_back(readScan(scan, manifest));
  }

  ManifestEntry readScan(const YamlNode& value, const Manifest& manifest) {
    ManifestEntry entry;
    if (value.isScalar()) {
      entry.path = {*folder_ / value.text, value.at};
      return entry;
    }
    if (!checkMapping(value, kScanKeys, *faults_)) return entry;
    if (const auto path = pathAt(value, "path"))
      entry.path = *path;
    else if (!value.find("path"))
      faults_->error(value.at, "a scan needs a 'path'");
    entry.labels = pathAt(value, "labels");
    if (const YamlNode* time = value.find("time_s")) entry.time_s = numberOf(*time, "time_s", *faults_);
    if (const YamlNode* format = value.find("format")) entry.format = readFormat(*format);
    if (const YamlNode* pose = value.find("pose")) {
      entry.pose = readPose(*pose);
      if (manifest.poses)
        faults_->error(pose->at, "the scan has a pose of its own, and 'poses' names a file for all scans",
                       "keep one of them");
    }
    return entry;
  }

  std::optional<ScanFormat> readFormat(const YamlNode& value) {
    std::vector<std::string> known;
    for (int i = 0; i <= static_cast<int>(ScanFormat::Las); ++i) {
      known.emplace_back(nameOf(static_cast<ScanFormat>(i)));
      if (value.text == known.back()) return static_cast<ScanFormat>(i);
    }
    faults_->error(value.at, "unknown format '" + value.text + "'", suggestion(value.text, known));
    return std::nullopt;
  }

  std::optional<Eigen::Isometry3d> readPose(const YamlNode& value) {
    if (value.isSequence()) return checked(value, readMatrix(value));
    if (!checkMapping(value, kPoseKeys, *faults_)) return std::nullopt;
    if (const YamlNode* matrix = value.find("matrix")) {
      if (value.keys.size() > 1) faults_->error(value.at, "'matrix' is a whole pose: nothing may stand beside it");
      return checked(*matrix, readMatrix(*matrix));
    }
    const YamlNode* xyz = value.find("xyz");
    if (!xyz) faults_->error(value.at, "a pose needs 'xyz' or 'matrix'");
    const auto position = xyz ? numbersOf(*xyz, 3, "xyz", *faults_) : std::nullopt;
    const auto rotation = readRotation(value);
    if (!position || !rotation) return std::nullopt;
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = *rotation;
    pose.translation() = Eigen::Vector3d(position->data());
    return checked(value, pose);
  }

  std::optional<Eigen::Isometry3d> readMatrix(const YamlNode& value) {
    const auto v = numbersOf(value, 16, "a pose matrix", *faults_);
    if (!v) return std::nullopt;
    Eigen::Isometry3d pose;
    pose.matrix() = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(v->data());
    return pose;
  }

  std::optional<Eigen::Matrix3d> readRotation(const YamlNode& pose) {
    const YamlNode* quaternion = pose.find("quaternion_xyzw");
    const YamlNode* degrees = pose.find("rpy_deg");
    const YamlNode* radians = pose.find("rpy_rad");
    const int given = (quaternion ? 1 : 0) + (degrees ? 1 : 0) + (radians ? 1 : 0);
    if (given > 1) faults_->error(pose.at, "a pose takes one of 'quaternion_xyzw', 'rpy_deg' and 'rpy_rad'");
    if (given == 0) return Eigen::Matrix3d::Identity();
    if (quaternion) return readQuaternion(*quaternion);
    const auto v = numbersOf(degrees ? *degrees : *radians, 3, "roll pitch yaw", *faults_);
    if (!v) return std::nullopt;
    const double unit = degrees ? std::numbers::pi / 180 : 1;
    return rotationFromRpy((*v)[0] * unit, (*v)[1] * unit, (*v)[2] * unit);
  }

  std::optional<Eigen::Matrix3d> readQuaternion(const YamlNode& value) {
    const auto v = numbersOf(value, 4, "quaternion_xyzw", *faults_);
    if (!v) return std::nullopt;
    const Eigen::Quaterniond rotation((*v)[3], (*v)[0], (*v)[1], (*v)[2]);
    if (std::abs(rotation.norm() - 1) < 1e-3) return rotation.normalized().toRotationMatrix();
    faults_->error(value.at, "the quaternion does not have length 1", "its order is x y z w");
    return std::nullopt;
  }

  std::optional<Eigen::Isometry3d> checked(const YamlNode& place, const std::optional<Eigen::Isometry3d>& pose) {
    if (!pose) return std::nullopt;
    if (const auto fault = faultOfPose(*pose)) faults_->error(place.at, "the pose " + *fault);
    return pose;
  }

  FaultList* faults_;
  const fs::path* folder_;
};

}  // namespace

Manifest parseManifest(std::string_view text, const std::string& file, const fs::path& folder, FaultList& faults) {
  const auto root = parseYaml(file, text, faults);
  return root ? ManifestReader(faults, folder).read(*root) : Manifest();
}

Manifest parseManifest(std::string_view text, const std::string& file, const fs::path& folder) {
  FaultList faults(file, std::string(text));
  Manifest manifest = parseManifest(text, file, folder, faults);
  faults.throwIfErrors();
  return manifest;
}

}  // namespace cluxel::scan
