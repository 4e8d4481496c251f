// SPDX-License-Identifier: Apache-2.0
// Lists folders. File names decide; contents are read only to distinguish text formats.
#include "scan/scan_layouts.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

#include "base/ascii.hpp"
#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "scan/formats/pcd_format.hpp"
#include "scan/formats/text_formats.hpp"

namespace cluxel::scan {

namespace fs = std::filesystem;

namespace {

constexpr const char* kKnownFormats =
    "known are .pcd, .ply, .las, .bin (KITTI), .xyz, .asc, .txt (x y z [intensity], or x y z label confidence), "
    ".xyz_label_conf, and the folders of KITTI odometry and Freiburg/Behley";

std::string lowerExtension(const fs::path& path) {
  return lowerCase(path.extension().string());
}

bool isScanOfPlainFolder(const fs::path& path) {
  constexpr std::array known{".pcd", ".ply", ".las", ".laz", ".xyz", ".asc", ".xyz_label_conf"};
  const std::string extension = lowerExtension(path);
  return std::find(known.begin(), known.end(), extension) != known.end();
}

bool isBrokenLink(const fs::path& path) {
  std::error_code error;
  return fs::is_symlink(path, error) && !fs::exists(path, error);
}

/// Whether an entry of a folder is read. A broken link with the name of a scan counts: without it, the scans that
/// follow would get the poses of their predecessors.
bool isShownFile(const fs::path& path) {
  if (path.filename().string().starts_with('.')) return false;
  std::error_code error;
  return fs::is_regular_file(path, error) || (isScanOfPlainFolder(path) && isBrokenLink(path));
}

/// The files of a folder in natural order of their names, without hidden ones (names that begin with a dot).
std::vector<fs::path> filesOf(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> files;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (isShownFile(it->path())) files.push_back(it->path());
  if (error) throw InputError({.file = folder.string()}, "the folder cannot be read: " + error.message());
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return naturalLess(a.filename().string(), b.filename().string());
  });
  return files;
}

std::optional<fs::path> existing(const fs::path& path) {
  std::error_code unreadable;
  if (fs::is_regular_file(path, unreadable)) return path;
  return std::nullopt;
}

ScanFormat textFormatOf(const fs::path& path) {
  constexpr std::size_t kSniffedBytes = 65536;
  std::string head = readBeginning(path, kSniffedBytes);
  if (head.size() == kSniffedBytes) head.resize(head.rfind('\n') + 1);
  const std::size_t columns = columnsOfFirstLine(head);
  if (columns == 5) return ScanFormat::LabelledText;
  if (columns == 3 || columns == 4 || columns == 0) return ScanFormat::Xyz;
  throw InputError({.file = path.string(), .line = 1}, std::to_string(columns) + " columns are no known form of a scan",
                   "known are x y z, x y z intensity, and x y z label confidence");
}

bool isKnownSideFile(const fs::path& path) {
  constexpr std::array known{"poses.txt", "times.txt", "calib.txt"};
  const std::string name = path.filename().string();
  return std::any_of(known.begin(), known.end(), [&](const char* n) { return name == n; }) ||
         name.starts_with("README");
}

std::optional<std::size_t> frameNumberOf(const fs::path& path) {
  const std::string stem = path.stem().string();
  std::size_t frame = 0;
  const auto [end, error] = std::from_chars(stem.data(), stem.data() + stem.size(), frame);
  if (error != std::errc() || end != stem.data() + stem.size()) return std::nullopt;
  return frame;
}

/// The .bin files among `files`, with labels from `labels`; `frame` is the rank.
FolderLayout binLayout(const std::vector<fs::path>& files, const fs::path& labels) {
  FolderLayout layout;
  for (const fs::path& path : files) {
    if (lowerExtension(path) != ".bin") continue;
    LayoutScan scan;
    scan.file.path = path;
    scan.file.format = ScanFormat::Kitti;
    scan.file.labels = existing(labels / path.stem().concat(".label"));
    scan.frame = layout.scans.size();
    layout.scans.push_back(scan);
  }
  return layout;
}

void addKittiPoses(FolderLayout& layout, const fs::path& folder) {
  layout.poses_file = existing(folder / "poses.txt");
  layout.times_file = existing(folder / "times.txt");
  layout.poses_in_camera = true;
  if (const auto calibration = existing(folder / "calib.txt"))
    layout.T_camera_sensor = parseKittiCalibration(readFile(*calibration), calibration->string());
}

FolderLayout kittiLayout(const fs::path& folder) {
  FolderLayout layout = binLayout(filesOf(folder / "velodyne"), folder / "labels");
  layout.frames_are_numbers = true;
  for (LayoutScan& scan : std::exchange(layout.scans, {})) {
    if (const auto frame = frameNumberOf(scan.file.path)) {
      scan.frame = *frame;
      layout.scans.push_back(std::move(scan));
    } else {
      const fs::path& path = scan.file.path;
      layout.misnamed.push_back(
          {path, InputError({.file = path.string()},
                            "the name of a KITTI scan must be its frame number, such as 000042.bin")});
    }
  }
  addKittiPoses(layout, folder);
  return layout;
}

/// "scan_7_points.dat" to "scan_7"; absent for other names.
std::optional<std::string> freiburgStem(const fs::path& path) {
  constexpr std::string_view kEnd = "_points.dat";
  const std::string name = path.filename().string();
  if (!name.starts_with("scan_") || !name.ends_with(kEnd)) return std::nullopt;
  return name.substr(0, name.size() - kEnd.size());
}

/// Poses lie in a file for each scan; when one has a pose, all must.
void attachFreiburgPoses(const fs::path& folder, std::vector<LayoutScan>& scans) {
  const auto poseFile = [&](const LayoutScan& scan) {
    return folder / (*freiburgStem(scan.file.path) + "_robotPoses.dat");
  };
  if (std::none_of(scans.begin(), scans.end(), [&](const LayoutScan& scan) { return fs::exists(poseFile(scan)); }))
    return;
  for (LayoutScan& scan : scans) {
    const fs::path file = poseFile(scan);
    if (!fs::exists(file))
      throw InputError({.file = file.string()}, "the pose of " + scan.file.path.filename().string() + " is missing",
                       "other scans of the folder have a pose: add it, or move the scan elsewhere");
    scan.file.T_map_sensor = parseFreiburgPose(readFile(file), file.string());
    scan.file.has_pose = true;
  }
}

FolderLayout freiburgLayout(const fs::path& folder, const std::vector<fs::path>& files) {
  FolderLayout layout;
  for (const fs::path& path : files) {
    const auto stem = freiburgStem(path);
    if (!stem) continue;
    LayoutScan scan;
    scan.file.path = path;
    scan.file.format = ScanFormat::Freiburg;
    scan.file.labels = existing(folder / (*stem + "_labels.dat"));
    scan.frame = layout.scans.size();
    layout.scans.push_back(scan);
  }
  attachFreiburgPoses(folder, layout.scans);
  return layout;
}

/// poses.txt first, then .tum files.
std::vector<fs::path> posesFilesOf(const std::vector<fs::path>& files) {
  std::vector<fs::path> found;
  for (const fs::path& path : files) {
    if (path.filename() == "poses.txt") found.insert(found.begin(), path);
    if (lowerExtension(path) == ".tum") found.push_back(path);
  }
  return found;
}

void addPlainPoses(FolderLayout& layout, const fs::path& folder, const std::vector<fs::path>& files) {
  layout.other_poses_files = posesFilesOf(files);
  if (!layout.other_poses_files.empty()) {
    layout.poses_file = layout.other_poses_files.front();
    layout.other_poses_files.erase(layout.other_poses_files.begin());
  }
  layout.times_file = existing(folder / "times.txt");
}

/// KITTI scans without the folder velodyne/. Each is in its own sensor frame, so several need poses. Poses beside a
/// calib.txt are those of the camera.
FolderLayout looseBinLayout(const fs::path& folder, const std::vector<fs::path>& files) {
  FolderLayout layout = binLayout(files, folder);
  for (LayoutScan& scan : layout.scans) scan.needs_pose = layout.scans.size() > 1;
  if (existing(folder / "calib.txt"))
    addKittiPoses(layout, folder);
  else
    addPlainPoses(layout, folder, files);
  const auto isNumbered = [](const LayoutScan& scan) { return frameNumberOf(scan.file.path).has_value(); };
  layout.frames_are_numbers = std::all_of(layout.scans.begin(), layout.scans.end(), isNumbered);
  if (layout.frames_are_numbers)
    for (LayoutScan& scan : layout.scans) scan.frame = *frameNumberOf(scan.file.path);
  return layout;
}

bool holdsOnlyBins(const std::vector<fs::path>& files) {
  return std::none_of(files.begin(), files.end(), isScanOfPlainFolder) &&
         std::any_of(files.begin(), files.end(), [](const fs::path& path) { return lowerExtension(path) == ".bin"; });
}

/// A scan of a folder of any scans.
LayoutScan plainScan(const fs::path& path, std::size_t frame) {
  LayoutScan scan;
  scan.file.path = path;
  scan.frame = frame;
  try {
    if (isBrokenLink(path)) throw InputError({.file = path.string()}, "the link leads nowhere", "correct or delete it");
    scan.file.format = formatOf(path);
  } catch (const InputError& fault) {
    scan.fault = fault;
  }
  return scan;
}

FolderLayout plainLayout(const fs::path& folder, const std::vector<fs::path>& files) {
  FolderLayout layout;
  std::vector<fs::path> scans, texts;
  for (const fs::path& path : files) {
    if (isScanOfPlainFolder(path))
      scans.push_back(path);
    else if (lowerExtension(path) == ".txt" && !isKnownSideFile(path))
      texts.push_back(path);
  }
  for (const fs::path& path : scans.empty() ? texts : scans)
    layout.scans.push_back(plainScan(path, layout.scans.size()));
  addPlainPoses(layout, folder, files);
  return layout;
}

}  // namespace

FolderLayout layoutOfFolder(const fs::path& folder) {
  FolderLayout layout;
  const std::vector<fs::path> files = filesOf(folder);
  if (fs::is_directory(folder / "velodyne"))
    layout = kittiLayout(folder);
  else if (std::any_of(files.begin(), files.end(), freiburgStem))
    layout = freiburgLayout(folder, files);
  else
    layout = holdsOnlyBins(files) ? looseBinLayout(folder, files) : plainLayout(folder, files);
  if (layout.scans.empty() && layout.misnamed.empty())
    throw InputError({.file = folder.string()}, "the folder holds no scans", kKnownFormats);
  return layout;
}

std::optional<OuterLayout> layoutFolderOf(const fs::path& scan) {
  const fs::path folder = scan.has_parent_path() ? scan.parent_path() : fs::path(".");
  if (lowerExtension(scan) == ".bin" && fs::absolute(folder).lexically_normal().filename() == "velodyne")
    return OuterLayout{folder / ".."};
  if (freiburgStem(scan)) return OuterLayout{folder};
  const std::vector<fs::path> poses = posesFilesOf(filesOf(folder));
  if (poses.empty()) return existing(folder / "times.txt") ? std::optional(OuterLayout{folder}) : std::nullopt;
  return OuterLayout{.folder = folder, .is_guess = poses.front().filename() != "poses.txt"};
}

ScanFormat formatOf(const fs::path& scan) {
  if (freiburgStem(scan)) return ScanFormat::Freiburg;
  const std::string extension = lowerExtension(scan);
  if (extension == ".pcd") return ScanFormat::Pcd;
  if (extension == ".ply") return ScanFormat::Ply;
  if (extension == ".bin") return ScanFormat::Kitti;
  if (extension == ".las" || extension == ".laz") return ScanFormat::Las;
  if (extension == ".xyz_label_conf") return ScanFormat::LabelledText;
  if (extension == ".xyz" || extension == ".asc" || extension == ".txt") return textFormatOf(scan);
  throw InputError({.file = scan.string()}, "the format of this file is not known", kKnownFormats);
}

bool naturalLess(const std::string& a, const std::string& b) {
  const auto isDigit = [](char c) { return c >= '0' && c <= '9'; };
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (isDigit(a[i]) && isDigit(b[j])) {
      const auto digits = [&](const std::string& text, std::size_t& at) {
        while (at < text.size() && text[at] == '0') ++at;
        const std::size_t from = at;
        while (at < text.size() && isDigit(text[at])) ++at;
        return std::string_view(text).substr(from, at - from);
      };
      const std::string_view da = digits(a, i);
      const std::string_view db = digits(b, j);
      if (da.size() != db.size()) return da.size() < db.size();
      if (da != db) return da < db;
    } else {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i;
      ++j;
    }
  }
  const bool a_ended = i == a.size();
  const bool b_ended = j == b.size();
  return a_ended != b_ended ? a_ended : a < b;
}

}  // namespace cluxel::scan
