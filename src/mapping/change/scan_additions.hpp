// SPDX-License-Identifier: Apache-2.0
// Adds scans to an opened map in batches; each becomes part of the map in one commit.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mapping/change/map_editor.hpp"

namespace cluxel::mapping {

class ScanAdditions {
 public:
  /// `operation` names the change in the history. A batch has `batch_points`, unless the editor is given a number.
  ScanAdditions(MapEditor& editor, std::string operation, std::uint64_t batch_points)
      : editor_(editor),
        operation_(std::move(operation)),
        batch_points_(editor.params().batch_points.value_or(batch_points)) {}

  /// Stores a scan, and commits when the batch is full and more than a small rest of scans follows. A dry run has one
  /// batch, which stays in its transaction.
  void add(const scan::Scan& scan, std::size_t scans_left);
  /// Copies all scans and tiles of another map, in one batch. The other map must have the frame, the model and the
  /// settings of this one. `is_lender`: what it decided is taken as well, and committed (canLendDecisions()).
  void copy(const rdf::ReadTransaction& other, bool is_lender = false);
  /// The transaction of the open batch, for other changes. The batch is then committed even without scans.
  rdf::WriteTransaction& transaction();
  /// Commits the last batch.
  void finish();
  /// Gives the open batch up, after an error.
  void drop();

 private:
  /// Notes whether scans are all that changes in the transaction, which is then committed.
  void noteAlone();
  void commitMany();
  void noteAdded(const Cloud& cloud);
  /// A scan that is there may be given with another time.
  void countOtherTime(std::optional<double> given_s, std::optional<double> before_s, std::optional<double> now_s);
  /// The latest of the times with which a scan was given becomes that of the map, with takes_given_times.
  void noteGivenTime(const scan::Scan& scan);
  void takeEarlierTimes();
  void noteOtherTimes();

  MapEditor& editor_;
  std::string operation_;
  std::uint64_t batch_points_;
  std::optional<rdf::WriteTransaction> transaction_;  ///< of the open batch
  PointChanges changes_;
  std::vector<Cloud> added_;
  std::uint64_t points_ = 0;                         ///< of the batch
  std::uint64_t points_to_commit_ = 0;               ///< of scans that are stored, since the last commit
  std::size_t later_times_ = 0, earlier_times_ = 0;  ///< of known scans in the batch
  std::size_t times_set_back_ = 0;                   ///< of known scans in the batch: earlier times that were taken
  std::map<scan::ScanId, double> given_times_;       ///< the latest of each scan, with ChangeParams::takes_given_times
  bool has_other_changes_ = false;
};

}  // namespace cluxel::mapping
