// SPDX-License-Identifier: Apache-2.0
// Listing of folders. Names decide; file contents are read only to tell text formats apart.
#include "scan/scan_layouts.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>

#include "cluxel/base/diagnostic.hpp"
#include "cluxel/base/file_bytes.hpp"
#include "scan/pcd_format.hpp"
#include "scan/text_formats.hpp"

namespace cluxel {

namespace fs = std::filesystem;

namespace {

constexpr const char* kKnownFormats =
    "known are .pcd, .ply, .las, .bin (KITTI), .xyz, .asc, .txt (x y z [intensity], or x y z label "
    "confidence), "
    ".xyz_label_conf, and the folders of KITTI odometry and Freiburg/Behley";

std::string lowerExtension(const fs::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return extension;
}

bool isScanOfPlainFolder(const fs::path& path) {
  constexpr std::array known{".pcd", ".ply", ".las", ".laz", ".xyz", ".asc", ".xyz_label_conf"};
  const std::string extension = lowerExtension(path);
  return std::find(known.begin(), known.end(), extension) != known.end();
}

/// Whether a folder's entry is read. A scan's name that leads nowhere is an error: the others would take its pose.
bool isShownFile(const fs::path& path) {
  if (path.filename().string().starts_with('.')) return false;
  std::error_code error;
  if (fs::is_regular_file(path, error)) return true;
  if (fs::is_symlink(path, error) && !fs::exists(path, error) && isScanOfPlainFolder(path))
    throw InputError({.file = path.string()}, "the link leads nowhere", "mend or delete it");
  return false;
}

/// The files of a folder by name; names that begin with a dot are hidden.
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

std::string firstBytes(const fs::path& path, std::size_t count) {
  std::ifstream stream(path, std::ios::binary);
  std::string bytes(count, '\0');
  stream.read(bytes.data(), static_cast<std::streamsize>(count));
  bytes.resize(static_cast<std::size_t>(stream.gcount()));
  return bytes;
}

ScanFormat textFormatOf(const fs::path& path) {
  constexpr std::size_t kSniffedBytes = 65536;
  std::string head = firstBytes(path, kSniffedBytes);
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

FolderLayout kittiLayout(const fs::path& folder) {
  FolderLayout layout;
  layout.frames_are_numbers = true;
  for (const fs::path& path : filesOf(folder / "velodyne")) {
    if (lowerExtension(path) != ".bin") continue;
    LayoutScan scan;
    scan.file.path = path;
    scan.file.format = ScanFormat::Kitti;
    scan.file.labels = existing(folder / "labels" / path.stem().concat(".label"));
    const std::string stem = path.stem().string();
    const auto [end, error] = std::from_chars(stem.data(), stem.data() + stem.size(), scan.frame);
    if (error != std::errc() || end != stem.data() + stem.size())
      throw InputError({.file = path.string()},
                       "the name of a KITTI scan must be its frame number, such as 000042.bin");
    layout.scans.push_back(scan);
  }
  layout.poses_file = existing(folder / "poses.txt");
  layout.times_file = existing(folder / "times.txt");
  layout.poses_in_camera = true;
  if (const auto calibration = existing(folder / "calib.txt"))
    layout.T_camera_sensor = parseKittiCalibration(readFile(*calibration), calibration->string());
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

std::optional<fs::path> posesFileOf(const fs::path& folder, const std::vector<fs::path>& files) {
  std::vector<fs::path> found;
  for (const fs::path& path : files)
    if (path.filename() == "poses.txt" || lowerExtension(path) == ".tum") found.push_back(path);
  if (found.size() > 1)
    throw InputError({.file = folder.string()},
                     "the folder has several files of poses: " + found[0].filename().string() + " and " +
                         found[1].filename().string(),
                     "keep one, or name it with --poses");
  if (found.empty()) return std::nullopt;
  return found.front();
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
  for (const fs::path& path : scans.empty() ? texts : scans) {
    LayoutScan scan;
    scan.file.path = path;
    scan.file.format = formatOf(path);
    scan.frame = layout.scans.size();
    layout.scans.push_back(scan);
  }
  layout.poses_file = posesFileOf(folder, files);
  layout.times_file = existing(folder / "times.txt");
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
    layout = plainLayout(folder, files);
  if (layout.scans.empty()) throw InputError({.file = folder.string()}, "the folder holds no scans", kKnownFormats);
  return layout;
}

std::optional<fs::path> layoutFolderOf(const fs::path& scan) {
  const fs::path folder = scan.has_parent_path() ? scan.parent_path() : fs::path(".");
  if (lowerExtension(scan) == ".bin") {
    if (fs::absolute(folder).lexically_normal().filename() == "velodyne") return folder / "..";
    return std::nullopt;
  }
  if (freiburgStem(scan)) return folder;
  const std::vector<fs::path> files = filesOf(folder);
  const bool explained = posesFileOf(folder, files) || fs::exists(folder / "times.txt");
  return explained ? std::optional(folder) : std::nullopt;
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

}  // namespace cluxel
