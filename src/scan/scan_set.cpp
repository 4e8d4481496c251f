// SPDX-License-Identifier: Apache-2.0
// Puts files, folders and manifests together to one list of scans with poses.
#include "cluxel/scan/scan_set.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <functional>
#include <map>

#include "cluxel/base/diagnostic.hpp"
#include "cluxel/base/file_bytes.hpp"
#include "scan/manifest.hpp"
#include "scan/pcd_format.hpp"
#include "scan/scan_layouts.hpp"
#include "scan/scan_loader.hpp"

namespace cluxel {

namespace fs = std::filesystem;

namespace {

bool isManifest(const fs::path& path) {
  return path.extension() == ".yaml" || path.extension() == ".yml";
}

std::optional<fs::path> manifestIn(const fs::path& folder) {
  for (const char* name : {"manifest.yaml", "manifest.yml"})
    if (fs::is_regular_file(folder / name)) return folder / name;
  return std::nullopt;
}

/// The VIEWPOINT of a PCD file; its header must lie in the first 64 KiB.
std::optional<Eigen::Isometry3d> viewpointOf(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  std::string head(65536, '\0');
  stream.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(stream.gcount()));
  return pcdViewpoint(head, path.string());
}

/// What is gathered while the inputs are gone through.
class ScanGatherer {
 public:
  ScanGatherer(const ScanSetParams& params, ProgressSink& sink) : params_(&params), sink_(&sink) {}

  void add(const fs::path& input) {
    if (!fs::exists(input)) throw InputError({.file = input.string()}, "there is no such file or folder");
    if (fs::is_directory(input))
      addFolder(input);
    else if (isManifest(input))
      addManifest(input);
    else
      scans_.push_back(loneScan(input));
  }

  /// Poses given by hand, then those of PCD files themselves; says which scans are left without.
  std::vector<ScanFile> finish() {
    if (!params_->poses.empty()) assignGivenPoses();
    std::vector<ScanFile> files;
    for (LayoutScan& scan : scans_) {
      if (!scan.file.has_pose && scan.file.format == ScanFormat::Pcd) {
        if (const auto viewpoint = viewpointOf(scan.file.path)) {
          scan.file.T_map_sensor = *viewpoint;
          scan.file.has_pose = true;
        }
      }
      files.push_back(std::move(scan.file));
    }
    noteLoneScans(files);
    return files;
  }

  const std::optional<Eigen::Vector3d>& mapOrigin() const { return map_origin_; }
  const std::string& crs() const { return crs_; }

 private:
  void addFolder(const fs::path& folder) {
    // A manifest that lists its own folder means the scans there.
    if (const auto manifest = manifestIn(folder); manifest && !isReading(*manifest)) return addManifest(*manifest);
    const fs::path root = isVelodyneFolder(folder) ? folder / ".." : folder;
    for (const LayoutScan& scan : layoutAt(root).scans) scans_.push_back(scan);
  }

  static bool isVelodyneFolder(const fs::path& folder) {
    const fs::path plain = fs::absolute(folder / "").lexically_normal().parent_path();
    return plain.filename() == "velodyne";
  }

  /// The layout of a folder with times and poses, kept for the next file of the same folder.
  const FolderLayout& layoutAt(const fs::path& folder) {
    const fs::path name = fs::absolute(folder).lexically_normal();
    const auto known = layouts_.find(name);
    if (known != layouts_.end()) return known->second;
    FolderLayout layout = layoutOfFolder(folder);
    attachTimes(layout);
    if (params_->poses.empty()) attachPoses(layout, *sink_);
    return layouts_.emplace(name, std::move(layout)).first->second;
  }

  LayoutScan loneScan(const fs::path& path) {
    const auto folder = layoutFolderOf(path);
    if (!folder) return plainScan(path);
    const FolderLayout& layout = layoutAt(*folder);
    for (const LayoutScan& scan : layout.scans) {
      if (scan.file.path.filename() != path.filename()) continue;
      LayoutScan found = scan;
      found.file.path = path;
      return found;
    }
    throw InputError({.file = path.string()}, "is not among the scans of its folder, which have poses or times there",
                     "move it to another folder, or list it in a manifest");
  }

  LayoutScan plainScan(const fs::path& path, std::optional<ScanFormat> format = {}) {
    LayoutScan scan;
    scan.file.path = path;
    scan.file.format = format ? *format : formatOf(path);
    if (!without_layout_) without_layout_ = path;
    return scan;
  }

  /// Whether the innermost manifest that is being read is this one; one further out would never end.
  bool isReading(const fs::path& manifest) const {
    for (std::size_t i = open_manifests_.size(); i-- > 0;) {
      if (!fs::equivalent(manifest, open_manifests_[i])) continue;
      if (i + 1 == open_manifests_.size()) return true;
      throw InputError({.file = manifest.string()},
                       "this manifest and " + open_manifests_.back().string() + " list each other's folders",
                       "list the scan files in one of them");
    }
    return false;
  }

  void addManifest(const fs::path& path) {
    open_manifests_.push_back(path);
    addScansOf(path);
    open_manifests_.pop_back();
  }

  void addScansOf(const fs::path& path) {
    const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
    const Manifest manifest = parseManifest(readFile(path), path.string(), folder);
    adoptFrame(manifest, path);
    const std::size_t first = scans_.size();
    for (const ManifestEntry& entry : manifest.scans) addEntry(entry, path);
    if (manifest.poses) assignPosesFrom(*manifest.poses, first);
    if (!manifest.poses_in_outer || !manifest.map_origin) return;
    for (std::size_t i = first; i < scans_.size(); ++i)
      scans_[i].file.T_map_sensor.pretranslate(Eigen::Vector3d(-*manifest.map_origin));
  }

  void adoptFrame(const Manifest& manifest, const fs::path& path) {
    const bool other_origin = manifest.map_origin && map_origin_ && *manifest.map_origin != *map_origin_;
    const bool other_crs = !manifest.crs.empty() && !crs_.empty() && manifest.crs != crs_;
    if (other_origin || other_crs)
      throw InputError({.file = path.string()}, "has another map_origin or crs than an earlier manifest",
                       "one map has one frame");
    if (manifest.map_origin) map_origin_ = manifest.map_origin;
    if (!manifest.crs.empty()) crs_ = manifest.crs;
  }

  void addEntry(const ManifestEntry& entry, const fs::path& manifest) {
    if (!fs::exists(entry.path))
      throw InputError({.file = entry.path.string()},
                       "there is no such file or folder; " + manifest.string() + " lists it");
    if (fs::is_directory(entry.path)) {
      if (entry.pose || entry.time_s || entry.labels || entry.format)
        throw InputError({.file = manifest.string()},
                         entry.path.string() + " is a folder: only a file takes pose, time_s, labels or format");
      return addFolder(entry.path);
    }
    if (isManifest(entry.path))
      throw InputError({.file = manifest.string()}, "a manifest cannot list the manifest " + entry.path.string());
    LayoutScan scan = entry.pose || entry.format ? plainScan(entry.path, entry.format) : loneScan(entry.path);
    if (entry.pose) scan.file.T_map_sensor = *entry.pose;
    if (entry.pose) scan.file.has_pose = true;
    if (entry.time_s) scan.file.time_s = entry.time_s;
    if (entry.labels) scan.file.labels = entry.labels;
    scans_.push_back(std::move(scan));
  }

  /// The poses of a file for the scans from `first` on, in their order.
  void assignPosesFrom(const fs::path& poses, std::size_t first) {
    std::vector<LayoutScan*> scans;
    for (std::size_t i = first; i < scans_.size(); ++i) {
      scans_[i].frame = i - first;
      scans.push_back(&scans_[i]);
    }
    assignPoses(scans, parsePoses(readFile(poses), poses.string()), poses.string(), false);
  }

  /// Poses given by hand for one KITTI sequence are those of the whole sequence, by frame number, and of its
  /// camera.
  void assignGivenPoses() {
    if (layouts_.size() != 1 || !layouts_.begin()->second.frames_are_numbers) return assignPosesFrom(params_->poses, 0);
    if (without_layout_)
      throw InputError({.file = params_->poses.string()},
                       "holds poses of a KITTI sequence, by the numbers of its frames; " + without_layout_->string() +
                           " is not of that sequence",
                       "list it with its pose in a manifest, beside the folder of the sequence");
    FolderLayout sequence = layouts_.begin()->second;
    sequence.poses_file = params_->poses;
    sequence.scans = scans_;
    attachPoses(sequence, *sink_);
    scans_ = sequence.scans;
  }

  void noteLoneScans(const std::vector<ScanFile>& files) const {
    const auto posed = [](const ScanFile& file) { return file.has_pose; };
    const auto first = std::find_if_not(files.begin(), files.end(), posed);
    if (first == files.end()) return;
    const auto lone = std::count_if(files.begin(), files.end(), std::not_fn(posed));
    sink_->note(std::to_string(lone) + " of " + std::to_string(files.size()) +
                " scans have no pose and are taken as given in the map frame (" + first->path.string() +
                (lone > 1 ? ", ..." : "") +
                "): where the sensor stood is not known, so questions of visibility answer \"not observed\"");
  }

  const ScanSetParams* params_;
  ProgressSink* sink_;
  std::vector<LayoutScan> scans_;
  std::map<fs::path, FolderLayout> layouts_;  ///< by whole paths
  std::vector<fs::path> open_manifests_;      ///< those that are being read, outermost first
  std::optional<fs::path> without_layout_;    ///< the first scan of no folder that explains it
  std::optional<Eigen::Vector3d> map_origin_;
  std::string crs_;
};

}  // namespace

const char* nameOf(ScanFormat format) {
  constexpr std::array names{"pcd", "ply", "kitti", "freiburg", "labelled_text", "xyz", "las"};
  return names[static_cast<std::size_t>(format)];
}

ScanSet ScanSet::open(const std::vector<fs::path>& inputs, const ScanSetParams& params, ProgressSink& sink) {
  ScanGatherer gatherer(params, sink);
  for (const fs::path& input : inputs) gatherer.add(input);
  ScanSet set;
  set.files_ = gatherer.finish();
  set.map_origin_ = gatherer.mapOrigin().value_or(Eigen::Vector3d::Zero());
  set.crs_ = gatherer.crs();
  return set;
}

ScanSet ScanSet::posed(const std::vector<PosedScan>& scans) const {
  ScanSet set(*this);
  set.files_.clear();
  for (const PosedScan& scan : scans) {
    ScanFile file = files_.at(scan.index);
    file.T_map_sensor = scan.T_map_sensor;
    file.has_pose = true;
    set.files_.push_back(std::move(file));
  }
  return set;
}

Scan ScanSet::load(std::size_t index) const {
  return loadScan(files_.at(index));
}

}  // namespace cluxel
