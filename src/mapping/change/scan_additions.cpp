// SPDX-License-Identifier: Apache-2.0
// A batch is open from its first scan to its commit.
#include "mapping/change/scan_additions.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "base/utc_time.hpp"
#include "mapping/build/batch_size.hpp"
#include "mapping/build/early_commit.hpp"
#include "mapping/map_tables.hpp"
#include "mapping/presence/object_rows.hpp"
#include "mapping/splits_store.hpp"

namespace cluxel::mapping {

void ScanAdditions::add(const scan::Scan& scan, std::size_t scans_left) {
  if (!transaction_) transaction_.emplace(editor_.begin());
  const std::optional<Cloud> known = storedCloud(*transaction_, scan.id);
  auto segments = storeScan(*transaction_, scan);
  noteGivenTime(scan);
  if (segments.empty()) {
    ++editor_.result().scans_already_there;
    countOtherTime(scan.time_s, known->time_s, storedCloud(*transaction_, scan.id)->time_s);
    return;
  }
  noteAdded(*storedCloud(*transaction_, scan.id));
  changes_.add(std::move(segments), editor_.params().stage_points);
  points_to_commit_ += added_.back().point_count;
  commitMany();
  if (!editor_.params().dry_run && isFull(points_, added_.size(), scans_left, batch_points_)) finish();
}

void ScanAdditions::noteAlone() {
  changes_.is_alone = !has_other_changes_ && !editor_.params().dry_run;
}

/// Points of many scans are committed early.
void ScanAdditions::commitMany() {
  noteAlone();
  if (!changes_.mayCommitEarly() || points_to_commit_ < editor_.params().stage_points) return;
  commitPoints(idsOf(added_), *transaction_, [&] { return editor_.beginAgain(); });
  points_to_commit_ = 0;
}

void ScanAdditions::countOtherTime(std::optional<double> given_s, std::optional<double> before_s,
                                   std::optional<double> now_s) {
  has_other_changes_ = has_other_changes_ || now_s != before_s;
  if (now_s != before_s)
    ++later_times_;
  else if (!editor_.params().takes_given_times && given_s && toMicroseconds(given_s) != toMicroseconds(before_s))
    ++earlier_times_;
}

void ScanAdditions::noteGivenTime(const scan::Scan& scan) {
  if (!editor_.params().takes_given_times || !scan.time_s) return;
  double& latest = given_times_.try_emplace(scan.id, *scan.time_s).first->second;
  latest = std::max(latest, *scan.time_s);
}

/// Later ones are taken already.
void ScanAdditions::takeEarlierTimes() {
  for (const auto& [id, latest_s] : given_times_) {
    const std::optional<Cloud> cloud = storedCloud(*transaction_, id);  // none while its points are committed early
    if (!cloud || !cloud->time_s || *cloud->time_s <= latest_s) continue;
    storeTime(*transaction_, *cloud, latest_s);
    ++times_set_back_;
    has_other_changes_ = true;
  }
}

void ScanAdditions::noteOtherTimes() {
  const auto noteTaken = [&](std::size_t count, const std::string& which) {
    if (count > 0)
      editor_.sink().note(std::to_string(count) + " known scans have " + which + " times now, which are taken");
  };
  noteTaken(later_times_, "later");
  noteTaken(times_set_back_, "earlier");
  editor_.result().scans_retimed += later_times_ + times_set_back_;
  if (earlier_times_ > 0)
    editor_.sink().note(
        std::to_string(earlier_times_) +
        " known scans are given earlier times; the later ones stay. To correct a time, retract the scan "
        "and add it again");
  later_times_ = earlier_times_ = times_set_back_ = 0;
}

void ScanAdditions::noteAdded(const Cloud& cloud) {
  added_.push_back(cloud);
  points_ += cloud.point_count;
}

void ScanAdditions::copy(const rdf::ReadTransaction& other, bool is_lender) {
  transaction();
  if (changes_.hasAdded()) editor_.update(*transaction_, std::exchange(changes_, {}), editor_.sink());
  for (const Cloud& cloud : storedClouds(other)) {
    const std::optional<Cloud> known = storedCloud(*transaction_, cloud.id);
    if (copyScan(*transaction_, other, cloud)) {
      noteAdded(cloud);
      continue;
    }
    ++editor_.result().scans_already_there;
    countOtherTime(cloud.time_s, known->time_s, storedCloud(*transaction_, cloud.id)->time_s);
  }
  // What objects of the other map follow from is told with them: it is taken where that is the same.
  for (const std::string_view table : {tables::kPresence, tables::kPassedRays}) copyRows(*transaction_, table, other);
  copySplits(*transaction_, other);
  PointChanges changes;
  changes.copied = &other;
  changes.is_lender = is_lender;
  const TileSet own = storedTiles(*transaction_), tiles = storedTiles(other);
  std::set_intersection(own.begin(), own.end(), tiles.begin(), tiles.end(),
                        std::inserter(changes.anew, changes.anew.end()));
  editor_.update(*transaction_, std::move(changes), editor_.sink());
  if (is_lender || (!editor_.params().dry_run && points_ >= batch_points_)) finish();
}

rdf::WriteTransaction& ScanAdditions::transaction() {
  if (!transaction_) transaction_.emplace(editor_.begin());
  has_other_changes_ = true;
  return *transaction_;
}

void ScanAdditions::drop() {
  transaction_.reset();
  if (!editor_.params().dry_run) dropEarlyCommit([&] { return editor_.beginAgain(); }, editor_.sink());
}

void ScanAdditions::finish() {
  if (transaction_) takeEarlierTimes();
  noteOtherTimes();
  noteAlone();
  if (!added_.empty() || has_other_changes_) editor_.commit(*transaction_, operation_, std::move(changes_), added_);
  editor_.result().scans_added += added_.size();
  transaction_.reset();
  changes_ = {};
  added_.clear();
  points_ = points_to_commit_ = 0;
  has_other_changes_ = false;
}

}  // namespace cluxel::mapping
