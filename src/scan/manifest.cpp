// SPDX-License-Identifier: Apache-2.0
// Reads manifests; docs/formats.md shows one.
#include "scan/manifest.hpp"

#include <cmath>
#include <numbers>

#include "cluxel/base/nearest_name.hpp"
#include "scan/pose_files.hpp"
#include "scan/yaml_tree.hpp"

namespace cluxel {

namespace fs = std::filesystem;

namespace {

const std::vector<std::string> kManifestKeys{"map_origin", "crs", "frame", "poses", "scans"};
const std::vector<std::string> kScanKeys{"path", "pose", "time_s", "labels", "format"};
const std::vector<std::string> kPoseKeys{"xyz", "quaternion_xyzw", "rpy_deg", "rpy_rad", "matrix"};

class ManifestReader {
 public:
  ManifestReader(YamlFaults& faults, const fs::path& folder) : faults_(&faults), folder_(&folder) {}

  Manifest read(const YamlValue& root) {
    Manifest manifest;
    if (!checkMapping(root, kManifestKeys, *faults_)) return manifest;
    if (const YamlValue* origin = root.find("map_origin"))
      if (const auto v = numbersOf(*origin, 3, "map_origin", *faults_))
        manifest.map_origin = Eigen::Vector3d(v->data());
    if (const YamlValue* crs = root.find("crs")) manifest.crs = textOf(*crs, "crs", *faults_).value_or("");
    if (const YamlValue* frame = root.find("frame")) manifest.poses_in_outer = isOuter(*frame);
    manifest.poses = pathAt(root, "poses");
    readScans(root, manifest);
    return manifest;
  }

 private:
  bool isOuter(const YamlValue& frame) {
    if (frame.scalar != "map" && frame.scalar != "outer") faults_->add(frame, "frame must be 'map' or 'outer'");
    return frame.scalar == "outer";
  }

  std::optional<fs::path> pathAt(const YamlValue& mapping, const char* key) {
    const YamlValue* value = mapping.find(key);
    if (!value) return std::nullopt;
    const auto text = textOf(*value, key, *faults_);
    if (!text) return std::nullopt;
    return *folder_ / *text;
  }

  void readScans(const YamlValue& root, Manifest& manifest) {
    const YamlValue* scans = root.find("scans");
    if (!scans || scans->kind != YamlValue::Kind::Sequence || scans->items.empty()) {
      faults_->add(scans ? *scans : root, "a manifest needs 'scans', a list that is not empty");
      return;
    }
    for (const YamlValue& scan : scans->items) manifest.scans.push_back(readScan(scan, manifest));
  }

  ManifestEntry readScan(const YamlValue& value, const Manifest& manifest) {
    ManifestEntry entry;
    if (value.kind == YamlValue::Kind::Scalar) {
      entry.path = *folder_ / value.scalar;
      return entry;
    }
    if (!checkMapping(value, kScanKeys, *faults_)) return entry;
    if (const auto path = pathAt(value, "path"))
      entry.path = *path;
    else if (!value.find("path"))
      faults_->add(value, "a scan needs a 'path'");
    entry.labels = pathAt(value, "labels");
    if (const YamlValue* time = value.find("time_s")) entry.time_s = numberOf(*time, "time_s", *faults_);
    if (const YamlValue* format = value.find("format")) entry.format = readFormat(*format);
    if (const YamlValue* pose = value.find("pose")) {
      entry.pose = readPose(*pose);
      if (manifest.poses)
        faults_->add(*pose, "the scan has a pose of its own, and 'poses' names a file for all scans",
                     "keep one of them");
    }
    return entry;
  }

  std::optional<ScanFormat> readFormat(const YamlValue& value) {
    std::vector<std::string> known;
    for (int i = 0; i <= static_cast<int>(ScanFormat::Las); ++i) {
      known.emplace_back(nameOf(static_cast<ScanFormat>(i)));
      if (value.scalar == known.back()) return static_cast<ScanFormat>(i);
    }
    faults_->add(value, "unknown format '" + value.scalar + "'", suggestion(value.scalar, known));
    return std::nullopt;
  }

  std::optional<Eigen::Isometry3d> readPose(const YamlValue& value) {
    if (value.kind == YamlValue::Kind::Sequence) return checked(value, readMatrix(value));
    if (!checkMapping(value, kPoseKeys, *faults_)) return std::nullopt;
    if (const YamlValue* matrix = value.find("matrix")) {
      if (value.entries.size() > 1) faults_->add(value, "'matrix' is a whole pose: nothing may stand beside it");
      return checked(*matrix, readMatrix(*matrix));
    }
    const YamlValue* xyz = value.find("xyz");
    if (!xyz) faults_->add(value, "a pose needs 'xyz' or 'matrix'");
    const auto position = xyz ? numbersOf(*xyz, 3, "xyz", *faults_) : std::nullopt;
    const auto rotation = readRotation(value);
    if (!position || !rotation) return std::nullopt;
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = *rotation;
    pose.translation() = Eigen::Vector3d(position->data());
    return checked(value, pose);
  }

  std::optional<Eigen::Isometry3d> readMatrix(const YamlValue& value) {
    const auto v = numbersOf(value, 16, "a pose matrix", *faults_);
    if (!v) return std::nullopt;
    Eigen::Isometry3d pose;
    pose.matrix() = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(v->data());
    return pose;
  }

  std::optional<Eigen::Matrix3d> readRotation(const YamlValue& pose) {
    const YamlValue* quaternion = pose.find("quaternion_xyzw");
    const YamlValue* degrees = pose.find("rpy_deg");
    const YamlValue* radians = pose.find("rpy_rad");
    const int given = (quaternion ? 1 : 0) + (degrees ? 1 : 0) + (radians ? 1 : 0);
    if (given > 1) faults_->add(pose, "a pose takes one of 'quaternion_xyzw', 'rpy_deg' and 'rpy_rad'");
    if (given == 0) return Eigen::Matrix3d::Identity();
    if (quaternion) return readQuaternion(*quaternion);
    const auto v = numbersOf(degrees ? *degrees : *radians, 3, "roll pitch yaw", *faults_);
    if (!v) return std::nullopt;
    const double unit = degrees ? std::numbers::pi / 180 : 1;
    return rotationFromRpy((*v)[0] * unit, (*v)[1] * unit, (*v)[2] * unit);
  }

  std::optional<Eigen::Matrix3d> readQuaternion(const YamlValue& value) {
    const auto v = numbersOf(value, 4, "quaternion_xyzw", *faults_);
    if (!v) return std::nullopt;
    const Eigen::Quaterniond rotation((*v)[3], (*v)[0], (*v)[1], (*v)[2]);
    if (std::abs(rotation.norm() - 1) < 1e-3) return rotation.normalized().toRotationMatrix();
    faults_->add(value, "the quaternion does not have length 1", "its order is x y z w");
    return std::nullopt;
  }

  std::optional<Eigen::Isometry3d> checked(const YamlValue& place, const std::optional<Eigen::Isometry3d>& pose) {
    if (!pose) return std::nullopt;
    if (const auto fault = faultOfPose(*pose)) faults_->add(place, "the pose " + *fault);
    return pose;
  }

  YamlFaults* faults_;
  const fs::path* folder_;
};

}  // namespace

Manifest parseManifest(std::string_view text, const std::string& file, const fs::path& folder) {
  YamlFaults faults(file, text);
  const YamlValue root = parseYaml(text, file, faults);
  Manifest manifest = ManifestReader(faults, folder).read(root);
  faults.throwIfAny();
  return manifest;
}

}  // namespace cluxel
