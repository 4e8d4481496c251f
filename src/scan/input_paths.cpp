// SPDX-License-Identifier: Apache-2.0
// Asks the file system before anything is opened: opening a named pipe waits for a writer, which may never come.
#include "scan/input_paths.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "cluxel/error.hpp"

namespace cluxel::scan {

namespace fs = std::filesystem;

namespace {

struct PathFault {
  std::string message, hint;
};

std::optional<PathFault> faultOf(const fs::path& input) {
  if (input.empty()) return PathFault{"an empty path names no file", ""};
  std::error_code error;
  const fs::file_status status = fs::status(input, error);
  if (!fs::exists(status) && fs::status_known(status)) return PathFault{"there is no such file or folder", ""};
  if (!fs::status_known(status)) return PathFault{"cannot be opened: " + error.message(), ""};
  if (fs::is_regular_file(status)) return std::nullopt;
  if (!fs::is_directory(status))
    return PathFault{"is a pipe or a device, a file or a folder was expected", "write its data to a file first"};
  if (::faccessat(AT_FDCWD, input.c_str(), R_OK | X_OK, AT_EACCESS) == 0) return std::nullopt;
  return PathFault{std::string("the folder cannot be read: ") + std::strerror(errno), ""};
}

void checkPath(const ManifestPath& path, FaultList& faults) {
  if (const auto fault = faultOf(path.path))
    faults.error(path.at, path.path.string() + ": " + fault->message, fault->hint);
}

void checkEntry(const ManifestEntry& entry, FaultList& faults) {
  const fs::path& path = entry.path.path;
  if (path.empty()) return;  // the fault of its text is known
  checkPath(entry.path, faults);
  if (entry.labels) checkPath(*entry.labels, faults);
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) {
    if (entry.pose || entry.time_s || entry.labels || entry.format)
      faults.error(entry.path.at, path.string() + " is a folder: only a file takes pose, time_s, labels or format");
  } else if (isManifest(path)) {
    faults.error(entry.path.at, "a manifest cannot list the manifest " + path.string());
  }
}

}  // namespace

bool isManifest(const fs::path& path) {
  return path.extension() == ".yaml" || path.extension() == ".yml";
}

std::optional<fs::path> manifestIn(const fs::path& folder) {
  for (const char* name : {"manifest.yaml", "manifest.yml"})
    if (fs::is_regular_file(folder / name)) return folder / name;
  return std::nullopt;
}

void requireInput(const fs::path& input) {
  if (const auto fault = faultOf(input)) throw InputError({.file = input.string()}, fault->message, fault->hint);
}

void checkPaths(const Manifest& manifest, FaultList& faults) {
  for (const ManifestEntry& entry : manifest.scans) checkEntry(entry, faults);
  if (manifest.poses) checkPath(*manifest.poses, faults);
}

}  // namespace cluxel::scan
