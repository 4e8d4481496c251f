// SPDX-License-Identifier: Apache-2.0
// Asks the system about each file of a set by the path that the set gives it: a manifest may spell a path otherwise
// than the listing of the folder, or name files elsewhere.
#include "mapping/watch/folder_look.hpp"

#include <sys/stat.h>

#include <set>
#include <utility>

#include "base/utc_time.hpp"
#include "cluxel/error.hpp"

namespace cluxel::mapping {

namespace fs = std::filesystem;

namespace {

std::int64_t nanoseconds(const timespec& time) {
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

FolderState stateOfFolder(const fs::path& folder) {
  FolderState state;
  std::error_code gone;
  for (fs::recursive_directory_iterator entry(folder, gone), end; entry != end; entry.increment(gone)) {
    if (gone || !entry->is_regular_file(gone)) continue;
    if (const auto file = stateOfFile(entry->path())) state.emplace(entry->path(), *file);
  }
  return state;
}

class NoteList : public ProgressSink {
 public:
  explicit NoteList(std::vector<std::string>& notes) : notes_(notes) {}
  void note(std::string_view message) override { notes_.emplace_back(message); }

 private:
  std::vector<std::string>& notes_;
};

Placement placementOf(const scan::ScanFile& file) {
  return {file.has_pose, file.T_map_sensor.matrix(), toMicroseconds(file.time_s)};
}

}  // namespace

std::optional<FileState> stateOfFile(const fs::path& file) {
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0) return std::nullopt;
  return FileState{status.st_dev, status.st_ino, static_cast<std::uint64_t>(status.st_size),
                   nanoseconds(status.st_mtim), nanoseconds(status.st_ctim)};
}

FolderState FolderLook::sideFiles() const {
  std::set<std::pair<std::uint64_t, std::uint64_t>> scan_files;
  for (const auto& [path, scan] : seen) scan_files.emplace(scan.file.device, scan.file.inode);
  FolderState side;
  for (const auto& [path, file] : files)
    if (!scan_files.contains({file.device, file.inode})) side.emplace(path, file);
  return side;
}

FolderLook lookAt(const fs::path& folder, const scan::ScanSetParams& params) {
  FolderLook look;
  std::error_code ignored;
  look.is_there = fs::exists(folder, ignored);
  if (!look.is_there) return look;
  look.files = stateOfFolder(folder);
  try {
    NoteList notes(look.notes);
    look.scans = scan::ScanSet::open({folder}, params, notes);
  } catch (const Error& fault) {
    if (!look.files.empty() || !fs::is_empty(folder, ignored)) look.fault = fault.what();
    return look;
  }
  for (std::size_t i = 0; i < look.scans->size(); ++i) {
    const scan::ScanFile& file = look.scans->file(i);
    if (const auto state = stateOfFile(file.path)) look.seen.emplace(file.path, SeenScan{*state, placementOf(file)});
  }
  for (const scan::FaultyScan& scan : look.scans->faulty())
    look.faulty.emplace(scan.path, FaultySeen{stateOfFile(scan.path).value_or(FileState{}), scan.fault.what()});
  return look;
}

}  // namespace cluxel::mapping
