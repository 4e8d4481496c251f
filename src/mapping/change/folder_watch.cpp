// SPDX-License-Identifier: Apache-2.0
// Polls a folder. A file that is still being written has another size or time at the next look.
#include "mapping/change/folder_watch.hpp"

#include <chrono>
#include <map>
#include <set>
#include <thread>
#include <vector>

#include "cluxel/error.hpp"
#include "mapping/build/work_file.hpp"
#include "mapping/change/map_compaction.hpp"
#include "mapping/clouds/scan_store.hpp"
#include "scan/input_paths.hpp"

namespace cluxel::mapping {

namespace {

namespace fs = std::filesystem;

struct FileState {
  std::uintmax_t size = 0;
  fs::file_time_type changed;
  bool operator==(const FileState&) const = default;
};
using FolderState = std::map<fs::path, FileState>;

/// Files that vanish while they are looked at are left out.
FolderState stateOf(const fs::path& folder) {
  FolderState state;
  std::error_code gone;
  for (fs::recursive_directory_iterator entry(folder, gone), end; entry != end; entry.increment(gone)) {
    if (gone || !entry->is_regular_file(gone)) continue;
    const FileState file{entry->file_size(gone), entry->last_write_time(gone)};
    if (!gone) state.emplace(entry->path(), file);
  }
  return state;
}

class Watch {
 public:
  Watch(const fs::path& folder, const fs::path& map, const WatchParams& params, const WatchCallbacks& callbacks,
        ProgressSink& sink)
      : folder_(folder),
        map_(map),
        params_(params),
        callbacks_(callbacks),
        sink_(sink),
        extension_(map, {.threads = params.threads}, sink) {}

  std::size_t run() {
    using Clock = std::chrono::steady_clock;
    auto last_arrival = Clock::now();
    FolderState before;
    for (bool is_first = true; !callbacks_.is_stopped(); is_first = false) {
      const FolderState now = stateOf(folder_);
      // A first look only tells which files there are.
      if (look(before, now) || is_first) last_arrival = Clock::now();
      before = now;
      const std::chrono::duration<double> idle = Clock::now() - last_arrival;
      if (params_.idle_s > 0 && idle.count() >= params_.idle_s) break;
      std::this_thread::sleep_for(std::chrono::duration<double>(params_.interval_s));
    }
    extension_.close();
    if (added_ + moved_ > 0)
      compactIfSparse(map_, sink_, kMaxFreeShareOfChanged);
    else
      finishCompaction(map_, sink_);
    return added_ + moved_;
  }

 private:
  /// Looks at the folder once. True when scans were added or moved.
  bool look(const FolderState& before, const FolderState& now) {
    if (now.empty()) return false;
    std::optional<scan::ScanSet> scans;
    try {
      scans = scan::ScanSet::open({folder_}, params_.scans, quiet_);
    } catch (const Error& fault) {
      if (before == now && last_fault_ != fault.what()) sink_.note(last_fault_ = fault.what());
      return false;
    }
    std::vector<std::size_t> fresh, reposed;
    for (std::size_t i = 0; i < scans->size(); ++i) {
      const auto file = now.find(scans->file(i).path), earlier = before.find(scans->file(i).path);
      const bool is_still = file != now.end() && earlier != before.end() && earlier->second == file->second;
      if (is_still && !isDone(*file)) fresh.push_back(i);
      const bool is_refused = refused_.contains(scans->file(i).path);
      if (is_still && isDone(*file) && (is_refused ? now != refused_in_ : hasOtherPose(scans->file(i))))
        reposed.push_back(i);
    }
    // While the poses are being written, they may be those of other scans.
    const bool moved =
        !reposed.empty() && poseFilesOf(*scans, before) == poseFilesOf(*scans, now) && move(*scans, reposed, now);
    const bool added = !fresh.empty() && add(*scans, fresh, &now);
    for (const std::size_t i : fresh) done_[scans->file(i).path] = now.at(scans->file(i).path);
    return added || moved;
  }

  /// Whether the scan has another pose than the one with which it was added or moved last.
  bool hasOtherPose(const scan::ScanFile& file) const {
    const auto placed = placed_.find(file.path);
    return file.has_pose && placed != placed_.end() && placed->second.matrix() != file.T_map_sensor.matrix();
  }
  void notePlaces(const scan::ScanSet& scans) {
    for (std::size_t i = 0; i < scans.size(); ++i) placed_[scans.file(i).path] = scans.file(i).T_map_sensor;
  }

  /// The files that are no scans.
  static FolderState poseFilesOf(const scan::ScanSet& scans, FolderState state) {
    for (std::size_t i = 0; i < scans.size(); ++i) state.erase(scans.file(i).path);
    return state;
  }

  /// Moves those scans that the map has with other poses, as after a loop closure. False when there are none.
  bool move(const scan::ScanSet& scans, const std::vector<std::size_t>& candidates, const FolderState& now) {
    extension_.close();
    const std::vector<ScanPose> moves = otherPosesOf(scans, candidates, now);
    notePlaces(scans.only(candidates));
    if (moves.empty()) return false;
    const ChangeReport report = moveScans(map_, moves, {.threads = params_.threads}, sink_);
    sink_.note("scans moved to the poses that the folder has now: " + std::to_string(moves.size()));
    moved_ += moves.size();
    tell(0, report.scans, report.object_count);
    return true;
  }

  /// The poses of those scans that the map has with other ones. A scan in two files with different poses is refused.
  std::vector<ScanPose> otherPosesOf(const scan::ScanSet& scans, const std::vector<std::size_t>& candidates,
                                     const FolderState& now) {
    struct KnownScan {
      Cloud cloud;
      std::vector<std::size_t> files;
      bool has_copy = false;
    };
    std::map<scan::ScanId, KnownScan> known;
    const auto environment = rdf::Environment::open(map_, rdf::OpenMode::ReadOnly);
    const rdf::ReadTransaction transaction = environment->read();
    for (const std::size_t i : candidates) {
      refused_.erase(scans.file(i).path);
      const std::optional<scan::ScanId> id = scans.file(i).has_pose ? idOf(scans, i) : std::nullopt;
      const std::optional<Cloud> cloud = id ? storedCloud(transaction, *id) : std::nullopt;
      if (!cloud) continue;
      KnownScan& scan = known.try_emplace(*id, KnownScan{*cloud, {}}).first->second;
      scan.has_copy = scan.has_copy || hasOtherFile(scans, i, *id, *cloud) ||
                      (!scan.files.empty() && !haveSamePose(scans.file(scan.files.front()), scans.file(i)));
      scan.files.push_back(i);
    }
    std::vector<ScanPose> others;
    for (const auto& [id, scan] : known) {
      const Eigen::Isometry3d& pose = scans.file(scan.files.front()).T_map_sensor;
      if (scan.has_copy)
        for (const std::size_t i : scan.files) refuse(scans.file(i).path, id, now);
      else if (!scan.cloud.has_pose || scan.cloud.T_map_sensor.matrix() != pose.matrix())
        others.push_back({id, pose});
    }
    return others;
  }

  static bool haveSamePose(const scan::ScanFile& a, const scan::ScanFile& b) {
    return a.T_map_sensor.matrix() == b.T_map_sensor.matrix();
  }

  /// The scan is looked at again when the folder has changed.
  void refuse(const fs::path& file, const scan::ScanId& id, const FolderState& now) {
    refused_.insert(file);
    refused_in_ = now;
    if (told_copies_.insert(id).second)
      sink_.note(file.string() +
                 ": is the same scan as another file of the folder, with another pose; it stays where it is in the map "
                 "until one of the files is removed");
  }

  /// Whether the cloud came from another file of the folder, which still holds the scan and gives it another pose.
  static bool hasOtherFile(const scan::ScanSet& scans, std::size_t i, const scan::ScanId& id, const Cloud& cloud) {
    for (std::size_t j = 0; j < scans.size(); ++j)
      if (j != i && scans.file(j).has_pose && scans.file(j).path.filename() == fs::path(cloud.source).filename() &&
          !haveSamePose(scans.file(j), scans.file(i)) && idOf(scans, j) == id)
        return true;
    return false;
  }

  /// Absent when the scan cannot be read.
  static std::optional<scan::ScanId> idOf(const scan::ScanSet& scans, std::size_t i) {
    try {
      return scans.load(i).id;
    } catch (const InputError&) {
      return std::nullopt;
    }
  }

  bool isDone(const FolderState::value_type& file) const {
    const auto done = done_.find(file.first);
    return done != done_.end() && done->second == file.second;
  }

  /// Adds scans in one commit, without those that cannot be read; or one by one, when they do not fit together. Scans
  /// that an earlier watch added with other poses are moved to those of the folder `now`, unless it is null.
  bool add(const scan::ScanSet& scans, const std::vector<std::size_t>& fresh, const FolderState* now) {
    try {
      commit(scans.only(fresh));
      notePlaces(scans.only(fresh));
      return true;
    } catch (const InputError& fault) {
      if (now != nullptr && is_built_ && move(scans, fresh, *now)) {
        add(scans, fresh, nullptr);
        return true;
      }
      if (fresh.size() == 1) {
        noteFaulty(fault);
        return false;
      }
    }
    const std::vector<std::size_t> readable = readableOf(scans, fresh);
    if (readable.size() < fresh.size()) return !readable.empty() && add(scans, readable, now);
    bool any = false;
    for (const std::size_t i : fresh) any = add(scans, {i}, nullptr) || any;
    return any;
  }

  std::vector<std::size_t> readableOf(const scan::ScanSet& scans, const std::vector<std::size_t>& fresh) {
    std::vector<std::size_t> readable;
    for (const std::size_t i : fresh) {
      try {
        prepareScan(scans.load(i));
        readable.push_back(i);
      } catch (const InputError& fault) {
        noteFaulty(fault);
      }
    }
    return readable;
  }

  void noteFaulty(const InputError& fault) {
    sink_.note(std::string(fault.what()) + "; it is tried again when the file changes");
  }

  void commit(const scan::ScanSet& scans) {
    if (!is_built_ && hasBuildToDo(map_)) {  // perhaps an earlier watch was killed in its first build
      extension_.close();
      const BuildReport report = buildMap(scans, callbacks_.inputs(), map_, {.threads = params_.threads}, sink_);
      is_built_ = true;
      return tell(report.scans, report.scans, report.objects);
    }
    is_built_ = true;
    const ChangeReport report = extension_.add(scans);
    if (report.has_changes) tell(report.scans_added, report.scans, report.object_count);
  }

  void tell(std::size_t added, std::size_t scans, std::size_t objects) {
    added_ += added;
    if (callbacks_.committed) callbacks_.committed(added, scans, objects);
  }

  const fs::path &folder_, &map_;
  const WatchParams& params_;
  const WatchCallbacks& callbacks_;
  ProgressSink& sink_;
  MapExtension extension_;                        ///< the next commit writes into the space that one leaves
  ProgressSink quiet_;                            ///< opening a set notes the same at each look
  std::map<fs::path, Eigen::Isometry3d> placed_;  ///< with which poses scans were added or moved
  FolderState done_;                              ///< scans that were added, or could not be read, as they were then
  std::string last_fault_;
  bool is_built_ = false;               ///< nothing is left of a first build
  std::set<fs::path> refused_;          ///< files of scans of which there are copies with other poses
  FolderState refused_in_;              ///< the folder when they were looked at last
  std::set<scan::ScanId> told_copies_;  ///< refused with a note
  std::size_t added_ = 0, moved_ = 0;
};

}  // namespace

std::size_t watchFolder(const fs::path& folder, const fs::path& map, const WatchParams& params,
                        const WatchCallbacks& callbacks, ProgressSink& sink) {
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored))
    throw Error(ErrorKind::InvalidArgument, folder.string() + " is no folder: name the folder in which scans arrive");
  scan::requireInput(folder);
  return Watch(folder, map, params, callbacks, sink).run();
}

}  // namespace cluxel::mapping
