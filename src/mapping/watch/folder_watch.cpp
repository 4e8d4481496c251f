// SPDX-License-Identifier: Apache-2.0
// Polls a folder. A file that is still being written has another size or time at the next look.
#include "mapping/watch/folder_watch.hpp"

#include <algorithm>
#include <chrono>
#include <map>
#include <set>
#include <thread>
#include <utility>
#include <vector>

#include "base/utc_time.hpp"
#include "cluxel/error.hpp"
#include "mapping/build/work_file.hpp"
#include "mapping/change/map_compaction.hpp"
#include "mapping/clouds/scan_store.hpp"
#include "mapping/map_state.hpp"
#include "mapping/watch/folder_look.hpp"
#include "mapping/watch/other_poses.hpp"
#include "mapping/watch/watch_notes.hpp"
#include "mapping/watch/watched_scans.hpp"
#include "rdf/file/map_replacement.hpp"
#include "scan/input_paths.hpp"

namespace cluxel::mapping {

namespace {

namespace fs = std::filesystem;

rdf::ReadTransaction readOf(const fs::path& map) {
  return rdf::Environment::open(map, rdf::OpenMode::ReadOnly)->read();
}

scan::ScanSetParams withoutFaulty(scan::ScanSetParams params) {
  params.leaves_out_faulty = true;
  return params;
}

class Watch {
 public:
  Watch(const fs::path& folder, const fs::path& map, const WatchParams& params, const WatchCallbacks& callbacks,
        ProgressSink& sink)
      : folder_(folder),
        map_(map),
        params_(params),
        set_params_(withoutFaulty(params.scans)),
        callbacks_(callbacks),
        sink_(sink),
        change_params_{.threads = params.threads, .takes_given_times = true},
        extension_(map, change_params_, sink),
        notes_(folder, sink),
        poses_(sink) {}

  std::size_t run() {
    using Clock = std::chrono::steady_clock;
    auto last_arrival = Clock::now();
    FolderLook before;
    for (bool is_first = true; !callbacks_.is_stopped(); is_first = false) {
      FolderLook now = lookAt(folder_, set_params_);
      // A first look only tells which files there are.
      if (follow(before, now, is_first) || is_first) last_arrival = Clock::now();
      before = std::move(now);
      const std::chrono::duration<double> idle = Clock::now() - last_arrival;
      if (params_.idle_s > 0 && idle.count() >= params_.idle_s) break;
      std::this_thread::sleep_for(std::chrono::duration<double>(params_.interval_s));
    }
    extension_.close();
    if (changed_ > 0)
      freeSpaceOfChange(map_, sink_);
    else
      finishCompaction(map_, sink_);
    return changed_;
  }

 private:
  /// True when the map was changed, or will be when another program lets go of it.
  bool follow(const FolderLook& before, const FolderLook& now, bool is_first) {
    notes_.tellFaults(before, now);
    try {
      const bool any = now.scans && fitsMap(*now.scans, is_first) && take(before, now);
      is_busy_ = false;
      notes_.tellRemoved(watched_.forgetRemoved(before, now));
      return any;
    } catch (const rdf::MapBusy&) {
    } catch (const rdf::MapReplaced&) {
    }
    extension_.close();
    if (!std::exchange(is_busy_, true))
      sink_.note(map_.string() + ": another program is changing or copying it; the watch tries again at each look");
    return true;
  }

  /// Brings the map to what the files tell that both looks show alike.
  bool take(const FolderLook& before, const FolderLook& now) {
    std::vector<std::size_t> fresh, reposed;
    std::set<fs::path> paths;
    for (std::size_t i = 0; i < now.scans->size(); ++i) {
      const fs::path& path = now.scans->file(i).path;
      const auto seen = now.seen.find(path), earlier = before.seen.find(path);
      if (!paths.insert(path).second || seen == now.seen.end() || earlier == before.seen.end()) continue;
      if (earlier->second != seen->second) continue;  // it is being written, or what tells its place is
      if (!watched_.isDone(path, seen->second))
        fresh.push_back(i);
      else if (poses_.isRefused(path) ? poses_.mayHaveChanged(now) : watched_.hasOtherPlace(path, seen->second.place))
        reposed.push_back(i);
    }
    // While the poses are being written, they may be those of other scans.
    bool any = !reposed.empty() && before.sideFiles() == now.sideFiles() && place(now, reposed);
    any = (!fresh.empty() && addFresh(now, fresh)) || any;
    any = retime(now) || any;
    any = retractReplaced() || any;
    const auto isKnown = [&](const fs::path& path) { return watched_.find(path) != nullptr; };
    if (is_built_ && std::all_of(paths.begin(), paths.end(), isKnown) && !std::exchange(has_told_gone_, true))
      notes_.tellRemoved(earlier_.goneFrom(folder_, watched_));
    return any;
  }

  /// Takes other poses and times of known scans.
  bool place(const FolderLook& now, const std::vector<std::size_t>& files) {
    const bool is_moved = move(now, files);
    noteDone(now, files);
    return is_moved;
  }

  bool addFresh(const FolderLook& now, const std::vector<std::size_t>& fresh) {
    for (const std::size_t i : fresh) watched_.noteChanged(now.scans->file(i).path);
    const bool is_added = add(now, fresh, true);
    noteDone(now, fresh);
    for (const std::size_t i : fresh)
      if (const fs::path& path = now.scans->file(i).path; compared_.insert(plainPath(path)).second)
        notes_.tellReplacedBefore(path, earlier_.takeFrom(path), watched_);
    return is_added;
  }

  /// Their times are compared with those of the map, in case that copies have other ones.
  void noteDone(const FolderLook& now, const std::vector<std::size_t>& files) {
    for (const std::size_t i : files) {
      const fs::path& path = now.scans->file(i).path;
      watched_.noteDone(path, now.seen.at(path));
      if (const auto id = watched_.find(path)->id) to_retime_.insert(*id);
    }
  }

  /// Moves those scans that the map has with other poses, as after a loop closure. False when there are none.
  bool move(const FolderLook& now, const std::vector<std::size_t>& candidates) {
    const std::vector<ScanPose> moves = poses_.othersOf(readOf(map_), now, candidates, watched_);
    if (moves.empty()) return false;
    extension_.close();
    const ChangeReport report = moveScans(map_, moves, change_params_, sink_);
    sink_.note("scans moved to the poses that the folder has now: " + std::to_string(moves.size()));
    tell(0, moves.size(), report);
    return true;
  }

  /// Adds scans in one commit, without those that cannot be read; or one by one, when they do not fit together. With
  /// `may_move`, scans that the map has with other poses are moved first.
  bool add(const FolderLook& now, const std::vector<std::size_t>& fresh, bool may_move) {
    try {
      commit(now, fresh);
      return true;
    } catch (const InputError& fault) {
      if (may_move && is_built_ && move(now, fresh)) {
        add(now, fresh, false);
        return true;
      }
      if (fresh.size() == 1) {
        notes_.tellFaulty(fault.what());
        return false;
      }
    }
    const std::vector<std::size_t> readable = readableOf(*now.scans, fresh);
    if (readable.size() < fresh.size()) return !readable.empty() && add(now, readable, may_move);
    bool any = false;
    for (const std::size_t i : fresh) any = add(now, {i}, false) || any;
    return any;
  }

  std::vector<std::size_t> readableOf(const scan::ScanSet& scans, const std::vector<std::size_t>& fresh) {
    std::vector<std::size_t> readable;
    for (const std::size_t i : fresh) {
      try {
        prepareScan(scans.load(i), perception::TileGrid(scans.mapOrigin()));
        readable.push_back(i);
      } catch (const InputError& fault) {
        notes_.tellFaulty(fault.what());
      }
    }
    return readable;
  }

  void commit(const FolderLook& now, const std::vector<std::size_t>& files) {
    const scan::ScanSet scans = now.scans->only(files);
    notes_.tellOfSet(now.notes);
    std::vector<scan::ScanId> given;
    if (!is_built_ && hasBuildToDo(map_)) {  // perhaps an earlier watch was killed in its first build
      extension_.close();
      const BuildReport report = buildMap(scans, callbacks_.inputs(), map_, {.threads = params_.threads}, sink_);
      given = report.given;
      is_built_ = true;
      tell(report.scans, {.added = report.scans,
                          .scans = report.scans,
                          .objects = report.objects,
                          .tiles_decided = report.tiles,
                          .objects_added = report.objects});
    } else {
      if (!is_built_) rememberClouds(storedClouds(readOf(map_)));
      is_built_ = true;
      const ChangeReport report = extension_.add(scans);
      given = report.given;
      if (report.has_changes) tell(report.scans_added, report.scans_added + report.scans_retimed, report);
    }
    for (std::size_t i = 0; i < files.size(); ++i) watched_.noteInMap(scans.file(i).path, given[i]);
  }

  /// Gives scans of the map the times of the folder: of several files with one scan, the latest.
  bool retime(const FolderLook& now) {
    struct Times {
      std::optional<double> latest_s;
      std::vector<std::size_t> files;
    };
    std::map<scan::ScanId, Times> told;
    for (std::size_t i = 0; !to_retime_.empty() && i < now.scans->size(); ++i) {
      const scan::ScanFile& file = now.scans->file(i);
      const WatchedScan* scan = watched_.find(file.path);
      if (scan == nullptr || !scan->is_in_map || !to_retime_.contains(*scan->id)) continue;
      if (const auto seen = now.seen.find(file.path); seen == now.seen.end() || seen->second != scan->seen) continue;
      Times& times = told[*scan->id];
      times.latest_s = std::max(times.latest_s, toMicroseconds(file.time_s));
      times.files.push_back(i);
    }
    std::vector<std::size_t> others;
    if (!told.empty()) {
      const rdf::ReadTransaction transaction = readOf(map_);
      for (const auto& [id, times] : told)
        if (const auto cloud = storedCloud(transaction, id); cloud && times.latest_s && cloud->time_s != times.latest_s)
          others.insert(others.end(), times.files.begin(), times.files.end());
    }
    const bool any = !others.empty() && add(now, others, false);
    to_retime_.clear();
    return any;
  }

  void rememberClouds(const std::vector<Cloud>& clouds) {
    earlier_ = EarlierScans(clouds);
    for (const Cloud& cloud : clouds) clouds_before_.insert(cloud.id);
  }

  /// Removes scans from the map whose files hold other ones now.
  bool retractReplaced() {
    std::vector<scan::ScanId> ids;
    if (const std::vector<scan::ScanId> replaced = watched_.replaced(); !replaced.empty()) {
      const rdf::ReadTransaction transaction = readOf(map_);
      for (const scan::ScanId& id : replaced) {
        const std::optional<Cloud> cloud = storedCloud(transaction, id);
        if (!cloud) continue;
        const bool was_there = clouds_before_.contains(id);
        if (!was_there && watched_.hasRead(cloud->source))
          ids.push_back(id);
        else
          sink_.note(map_.string() + ": cloud " + id.hex() +
                     " stays, although no file of the folder holds that scan any " + "more, because " +
                     (was_there ? "the map had it before the watch began" : "it came from '" + cloud->source + "'"));
      }
      watched_.forgetReplaced(replaced);
    }
    if (!ids.empty()) {
      extension_.close();
      const ChangeReport report = retractScans(map_, ids, change_params_, sink_);
      sink_.note("scans retracted, because their files hold other scans now: " + std::to_string(ids.size()));
      tell(0, ids.size(), report);
    }
    return !ids.empty();
  }

  /// False, with a note, when the folder has got another frame than the map's. An error at the first look.
  bool fitsMap(const scan::ScanSet& scans, bool is_first) {
    const std::pair<Eigen::Vector3d, std::string> frame{scans.mapOrigin(), scans.crs()};
    if (fitting_frame_ == frame) return true;
    const bool has_map = is_built_ || !hasBuildToDo(map_);
    try {
      if (has_map) requireFrame(requireFinishedInputs(readOf(map_), map_), scans);
    } catch (const rdf::MapBusy&) {
      throw;
    } catch (const Error& fault) {
      if (is_first || fault.kind() != ErrorKind::InvalidArgument) throw;
      notes_.tellFrame(folder_.string() + ": " + fault.what() + "; until then nothing of the folder is taken");
      return false;
    }
    notes_.tellFrame("");
    if (has_map) fitting_frame_ = frame;
    return true;
  }

  void tell(std::size_t changed, const WatchCommit& commit) {
    changed_ += changed;
    if (callbacks_.committed) callbacks_.committed(commit);
  }
  void tell(std::size_t added, std::size_t changed, const ChangeReport& report) {
    const ObjectChanges& objects = report.objects;
    tell(changed,
         {added, report.scans, report.object_count, report.tiles_decided, objects.added.size(), objects.changed.size(),
          objects.redecided.size(), objects.gone.size(), objects.split.size(), objects.joined.size()});
  }

  const fs::path &folder_, &map_;
  const WatchParams& params_;
  scan::ScanSetParams set_params_;
  const WatchCallbacks& callbacks_;
  ProgressSink& sink_;
  ChangeParams change_params_;
  MapExtension extension_;  ///< the next commit writes into the space that one leaves
  WatchNotes notes_;
  WatchedScans watched_;
  OtherPoses poses_;
  EarlierScans earlier_;
  std::set<scan::ScanId> clouds_before_;  ///< that the map had when the watch began
  std::set<fs::path> compared_;           ///< plain paths that were compared with `earlier_`
  std::set<scan::ScanId> to_retime_;      ///< whose times may be others than those of the map
  std::optional<std::pair<Eigen::Vector3d, std::string>> fitting_frame_;  ///< origin and crs that the map has
  bool is_built_ = false;                                                 ///< nothing is left of a first build
  bool is_busy_ = false;                                                  ///< another program has the map
  bool has_told_gone_ = false;
  std::size_t changed_ = 0;  ///< scans
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
