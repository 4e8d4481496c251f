// SPDX-License-Identifier: Apache-2.0
// Gathers the scans of files, folders and manifests, with their poses, in one list.
#include "scan/scan_set.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <map>

#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "scan/formats/manifest.hpp"
#include "scan/formats/pcd_format.hpp"
#include "scan/input_paths.hpp"
#include "scan/las_frame.hpp"
#include "scan/scan_layouts.hpp"
#include "scan/scan_loader.hpp"

namespace cluxel::scan {

namespace fs = std::filesystem;

namespace {

/// The VIEWPOINT of a PCD file; its header must lie in the first 64 KiB.
std::optional<Eigen::Isometry3d> viewpointOf(const fs::path& path) {
  constexpr std::size_t kHeaderBytes = 65536;
  return pcdViewpoint(readBeginning(path, kHeaderBytes), path.string());
}

/// Collects scans, poses and the map frame from the inputs, one after the other.
class ScanGatherer {
 public:
  ScanGatherer(const ScanSetParams& params, ProgressSink& sink) : params_(&params), sink_(&sink) {}

  void add(const fs::path& input) {
    requireInput(input);
    if (fs::is_directory(input))
      addFolder(input);
    else if (isManifest(input))
      addManifest(input);
    else
      scans_.push_back(singleScan(input));
  }

  /// Assigns the poses of the parameters, then those inside PCD files, brings them into the map frame, and notes which
  /// scans have none.
  std::vector<ScanFile> finish() {
    if (!params_->poses.empty()) assignGivenPoses();
    std::vector<ScanFile> files;
    LasFrame las(*params_, *sink_);
    for (LayoutScan& scan : scans_) {
      if (scan.needs_pose && !scan.file.has_pose)
        throw InputError({.file = scan.file.path.string()},
                         "has no pose: the KITTI scans (.bin) of a folder lie each in the frame of its sensor",
                         params_->remedies.poses + ", or put poses.txt beside the scans");
      try {
        if (scan.fault) throw InputError(*scan.fault);
        bringToMapFrame(scan);
        las.read(scan.file);
        files.push_back(std::move(scan.file));
      } catch (const InputError& fault) {
        leaveOut({scan.file.path, fault});
      }
    }
    noteScansWithoutPose(files);
    if (stated_crs_.empty()) crs_ = las.crs();
    return files;
  }

  const std::vector<FaultyScan>& faulty() const { return faulty_; }

  Eigen::Vector3d mapOrigin() const {
    return toMetresZUp(map_origin_.value_or(Eigen::Vector3d::Zero()), params_->frame);
  }
  const std::string& crs() const { return crs_; }

 private:
  void addFolder(const fs::path& folder) {
    // A manifest that lists its own folder means the scans there.
    if (const auto manifest = manifestIn(folder); manifest && !isReading(*manifest)) return addManifest(*manifest);
    const fs::path root = isVelodyneFolder(folder) ? folder / ".." : folder;
    const FolderLayout& layout = layoutAt(root);
    for (const FaultyScan& scan : layout.misnamed) leaveOut(scan);
    scans_.insert(scans_.end(), layout.scans.begin(), layout.scans.end());
  }

  void leaveOut(const FaultyScan& scan) {
    if (!params_->leaves_out_faulty) throw InputError(scan.fault);
    faulty_.push_back(scan);
  }

  void bringToMapFrame(LayoutScan& scan) const {
    if (!scan.file.has_pose && scan.file.format == ScanFormat::Pcd) {
      if (const auto viewpoint = viewpointOf(scan.file.path)) {
        scan.file.T_map_sensor = *viewpoint;
        scan.file.has_pose = true;
      }
    }
    if (scan.outer_origin) scan.file.T_map_sensor.pretranslate(Eigen::Vector3d(-*scan.outer_origin));
    scan.file.T_map_sensor = toMetresZUp(scan.file.T_map_sensor, params_->frame);
    scan.file.frame = params_->frame;
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
    if (params_->poses.empty()) {
      if (!layout.other_poses_files.empty())
        throw InputError({.file = folder.string()},
                         "the folder has several poses files: " + layout.poses_file->filename().string() + " and " +
                             layout.other_poses_files.front().filename().string(),
                         "keep one, or " + params_->remedies.poses);
      attachPoses(layout, *sink_);
    }
    return layouts_.emplace(name, std::move(layout)).first->second;
  }

  /// A single file has the pose and time that it has as a part of its folder.
  LayoutScan singleScan(const fs::path& path) {
    const auto outer = layoutFolderOf(path);
    if (!outer) return plainScan(path);
    if (!outer->is_guess) return scanOf(layoutAt(outer->folder), path);
    try {
      return scanOf(layoutAt(outer->folder), path);
    } catch (const InputError& e) {
      sink_->note(path.string() + ": a .tum file lies beside it, but is not used: " + e.diagnostics().front().message +
                  "; if it holds the pose of this scan, " + params_->remedies.poses);
      return plainScan(path);
    }
  }

  static LayoutScan scanOf(const FolderLayout& layout, const fs::path& path) {
    for (const LayoutScan& scan : layout.scans) {
      if (scan.file.path.filename() != path.filename()) continue;
      LayoutScan found = scan;
      found.file.path = path;
      found.needs_pose = false;
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

  /// Whether the innermost manifest being read is this one. One further out would lead to an endless recursion.
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
    const Manifest manifest = readManifest(path, folder);
    adoptFrame(manifest, path);
    const std::size_t first = scans_.size();
    for (const ManifestEntry& entry : manifest.scans) addEntry(entry);
    if (manifest.poses) assignPosesFrom(manifest.poses->path, first);
    for (std::size_t i = first; manifest.poses_in_outer && i < scans_.size(); ++i)
      scans_[i].outer_origin = manifest.map_origin;
  }

  /// With all faults of its text and of the paths in it.
  static Manifest readManifest(const fs::path& path, const fs::path& folder) {
    const std::string text = readFile(path);
    FaultList faults(path.string(), text);
    Manifest manifest = parseManifest(text, path.string(), folder, faults);
    checkPaths(manifest, faults);
    faults.throwIfErrors();
    return manifest;
  }

  void adoptFrame(const Manifest& manifest, const fs::path& path) {
    const bool other_origin = manifest.map_origin && map_origin_ && *manifest.map_origin != *map_origin_;
    const bool other_crs = !manifest.crs.empty() && !stated_crs_.empty() && manifest.crs != stated_crs_;
    if (other_origin || other_crs)
      throw InputError({.file = path.string()}, "has another map_origin or crs than an earlier manifest",
                       "one map has one frame");
    if (manifest.map_origin) map_origin_ = manifest.map_origin;
    if (manifest.crs.empty() || manifest.crs == stated_crs_) return;
    stated_crs_ = manifest.crs;
    crs_ = keptCrs(manifest, path, *params_, *sink_);
  }

  void addEntry(const ManifestEntry& entry) {
    const fs::path& path = entry.path.path;
    if (fs::is_directory(path)) return addFolder(path);
    LayoutScan scan = entry.pose || entry.format ? plainScan(path, entry.format) : singleScan(path);
    if (entry.pose) scan.file.T_map_sensor = *entry.pose;
    if (entry.pose) scan.file.has_pose = true;
    if (entry.time_s) scan.file.time_s = entry.time_s;
    if (entry.labels) scan.file.labels = entry.labels->path;
    scans_.push_back(std::move(scan));
  }

  /// Assigns the poses of a file to the scans from `first` on, in their order.
  void assignPosesFrom(const fs::path& poses, std::size_t first) {
    std::vector<LayoutScan*> scans;
    for (std::size_t i = first; i < scans_.size(); ++i) {
      scans_[i].frame = i - first;
      scans.push_back(&scans_[i]);
    }
    assignPoses(scans, parsePoses(readFile(poses), poses.string()), poses.string(), false);
  }

  /// For one KITTI sequence, a given poses file is that of the whole sequence: by frame number, and of its camera.
  void assignGivenPoses() {
    if (layouts_.size() != 1 || !layouts_.begin()->second.frames_are_numbers) return assignPosesFrom(params_->poses, 0);
    if (without_layout_)
      throw InputError({.file = params_->poses.string()},
                       "holds the poses of a KITTI sequence by frame number; " + without_layout_->string() +
                           " does not belong to that sequence",
                       "list it with its pose in a manifest, beside the folder of the sequence");
    FolderLayout sequence = layouts_.begin()->second;
    sequence.poses_file = params_->poses;
    sequence.scans = scans_;
    attachPoses(sequence, *sink_);
    scans_ = sequence.scans;
  }

  void noteScansWithoutPose(const std::vector<ScanFile>& files) const {
    const auto posed = [](const ScanFile& file) { return file.has_pose; };
    const auto first = std::find_if_not(files.begin(), files.end(), posed);
    if (first == files.end()) return;
    const auto unposed = std::count_if(files.begin(), files.end(), std::not_fn(posed));
    // Whether points have origins shows only when they are read.
    const bool may_have_origins = std::any_of(first, files.end(), [](const ScanFile& file) {
      return !file.has_pose && (file.format == ScanFormat::Pcd || file.format == ScanFormat::Ply);
    });
    sink_->note(
        std::to_string(unposed) + " of " + std::to_string(files.size()) +
        " scans have no pose and are taken as given in the map frame (" + first->path.string() +
        (unposed > 1 ? ", ..." : "") +
        "): they tell neither when something was there nor what changed, and the position of the sensor is unknown" +
        (may_have_origins ? " unless the points state where rays start (vp_x, vp_y, vp_z)" : ""));
  }

  const ScanSetParams* params_;
  ProgressSink* sink_;
  std::vector<LayoutScan> scans_;
  std::map<fs::path, FolderLayout> layouts_;  ///< by absolute path
  std::vector<fs::path> open_manifests_;      ///< being read, outermost first
  std::optional<fs::path> without_layout_;    ///< the first scan without a folder that states poses or times
  std::vector<FaultyScan> faulty_;
  std::optional<Eigen::Vector3d> map_origin_;
  std::string stated_crs_;  ///< by a manifest
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
  set.faulty_ = gatherer.faulty();
  set.map_origin_ = gatherer.mapOrigin();
  set.crs_ = gatherer.crs();
  set.remedies_ = params.remedies;
  return set;
}

ScanSet ScanSet::only(const std::vector<std::size_t>& scans) const {
  ScanSet set(*this);
  set.files_.clear();
  for (const std::size_t index : scans) set.files_.push_back(files_.at(index));
  return set;
}

ScanSet ScanSet::posed(const std::vector<PosedScan>& scans) const {
  std::vector<std::size_t> indices;
  for (const PosedScan& scan : scans) indices.push_back(scan.index);
  ScanSet set = only(indices);
  for (std::size_t i = 0; i < scans.size(); ++i)
    set.files_[i].T_map_sensor = scans[i].T_map_sensor, set.files_[i].has_pose = true;
  return set;
}

LoadedScan ScanSet::read(std::size_t index) const {
  return loadScan(files_.at(index));
}

}  // namespace cluxel::scan
