// SPDX-License-Identifier: Apache-2.0
// A scan is known by its content: several files may hold one, and it leaves the map when the last of them has changed.
#include "mapping/watch/watched_scans.hpp"

#include <algorithm>

#include "cluxel/error.hpp"

namespace cluxel::mapping {

namespace fs = std::filesystem;

namespace {

bool isBelow(const fs::path& path, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first == folder.end();
}

std::set<fs::path> plainPathsOf(const FolderLook& look) {
  std::set<fs::path> paths;
  for (const auto& [path, scan] : look.seen) paths.insert(plainPath(path));
  for (const auto& [path, scan] : look.faulty) paths.insert(plainPath(path));
  return paths;
}

/// Which plain paths a look does not show any more. A set that cannot be opened tells nothing about single files.
class GoneFrom {
 public:
  explicit GoneFrom(const FolderLook& look) : look_(look), there_(plainPathsOf(look)) {}
  bool operator()(const fs::path& path) const {
    std::error_code ignored;
    return look_.is_there && !there_.contains(path) && (look_.scans || !fs::exists(path, ignored));
  }

 private:
  const FolderLook& look_;
  std::set<fs::path> there_;
};

}  // namespace

fs::path plainPath(const fs::path& path) {
  const fs::path plain = fs::absolute(path).lexically_normal();
  return plain.has_filename() ? plain : plain.parent_path();
}

bool WatchedScans::isDone(const fs::path& path, const SeenScan& now) const {
  const WatchedScan* scan = find(path);
  if (scan == nullptr || scan->seen.file != now.file) return false;
  // Points far from the origin are stored otherwise when they are those of a sensor with a pose, as another scan.
  if (now.place.has_pose && !scan->seen.place.has_pose) return false;
  return scan->is_read || scan->seen.place == now.place;  // with another time it may be taken
}

bool WatchedScans::hasOtherPlace(const fs::path& path, const Placement& now) const {
  const WatchedScan* scan = find(path);
  return scan != nullptr && scan->seen.place != now;
}

const WatchedScan* WatchedScans::find(const fs::path& path) const {
  const auto scan = scans_.find(plainPath(path));
  return scan == scans_.end() ? nullptr : &scan->second;
}

std::optional<scan::ScanId> WatchedScans::idOf(const FolderLook& now, std::size_t i) {
  const fs::path& path = now.scans->file(i).path;
  const WatchedScan* known = find(path);
  const auto seen = now.seen.find(path);
  if (known != nullptr && known->is_read && seen != now.seen.end() && known->seen.file == seen->second.file &&
      known->seen.place.has_pose == seen->second.place.has_pose)
    return known->id;
  try {
    const scan::ScanId id = now.scans->load(i).id;
    noteRead(path, id);
    return id;
  } catch (const InputError&) {
    return std::nullopt;
  }
}

void WatchedScans::noteInMap(const fs::path& path, const scan::ScanId& id) {
  noteRead(path, id);
  scans_[plainPath(path)].is_in_map = true;
}

void WatchedScans::noteRead(const fs::path& path, const scan::ScanId& id) {
  WatchedScan& scan = scans_[plainPath(path)];
  scan.id = id, scan.is_read = true;
  read_.insert(plainPath(path));
}

void WatchedScans::noteDone(const fs::path& path, const SeenScan& now) {
  scans_[plainPath(path)].seen = now;
}

void WatchedScans::noteChanged(const fs::path& path) {
  const auto scan = scans_.find(plainPath(path));
  if (scan == scans_.end() || !scan->second.id) return;
  replaced_.insert_or_assign(*scan->second.id, scan->first);
  scan->second.is_read = scan->second.is_in_map = false;
}

std::vector<scan::ScanId> WatchedScans::replaced() const {
  std::vector<scan::ScanId> ids;
  for (const auto& [id, path] : replaced_)
    if (const WatchedScan* now = find(path); now != nullptr && now->is_in_map && !isHeld(id)) ids.push_back(id);
  return ids;
}

void WatchedScans::forgetReplaced(const std::vector<scan::ScanId>& ids) {
  for (const scan::ScanId& id : ids) replaced_.erase(id);
  std::erase_if(replaced_,
                [&](const auto& replaced) { return isHeld(replaced.first) || find(replaced.second) == nullptr; });
}

std::vector<fs::path> WatchedScans::forgetRemoved(const FolderLook& before, const FolderLook& now) {
  const GoneFrom is_gone_before(before), is_gone_now(now);
  std::map<fs::path, WatchedScan> gone;
  for (auto scan = scans_.begin(); scan != scans_.end();) {
    const auto next = std::next(scan);
    if (is_gone_now(scan->first) && is_gone_before(scan->first)) gone.insert(scans_.extract(scan));
    scan = next;
  }
  std::vector<fs::path> last;
  for (const auto& [path, scan] : gone)
    if (scan.id && !isHeld(*scan.id)) last.push_back(path);
  return last;
}

bool WatchedScans::isHeld(const scan::ScanId& id) const {
  return std::any_of(scans_.begin(), scans_.end(), [&](const auto& scan) { return scan.second.id == id; });
}

EarlierScans::EarlierScans(const std::vector<Cloud>& clouds) {
  for (const Cloud& cloud : clouds) by_source_.emplace(plainPath(cloud.source), cloud.id);
}

std::vector<scan::ScanId> EarlierScans::takeFrom(const fs::path& path) {
  std::vector<scan::ScanId> ids;
  const auto [first, last] = by_source_.equal_range(plainPath(path));
  for (auto scan = first; scan != last; ++scan) ids.push_back(scan->second);
  by_source_.erase(first, last);
  return ids;
}

std::vector<fs::path> EarlierScans::goneFrom(const fs::path& folder, const WatchedScans& watched) const {
  std::vector<fs::path> gone;
  std::error_code ignored;
  const fs::path plain = plainPath(folder);
  for (const auto& [path, id] : by_source_)
    if (isBelow(path, plain) && !fs::exists(path, ignored) && !watched.isHeld(id)) gone.push_back(path);
  return gone;
}

}  // namespace cluxel::mapping
