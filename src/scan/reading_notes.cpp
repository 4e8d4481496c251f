// SPDX-License-Identifier: Apache-2.0
// Notes on what was skipped, ignored or doubtful while scans were read.
#include <algorithm>

#include "scan/scan_set.hpp"

namespace cluxel::scan {

std::vector<std::string> ReadingNotes::add(const ScanReading& reading) {
  ++scans_;
  if (reading.no_return_count > 0) {
    if (scans_with_no_return_++ == 0) first_with_no_return_ = reading.source;
    no_return_count_ += reading.no_return_count;
  }
  if (reading.withheld_count > 0 && withheld_count_ == 0) first_with_withheld_ = reading.source;
  withheld_count_ += reading.withheld_count;
  for (const std::string& field : reading.ignored_fields) {
    if (ignored_fields_.empty()) first_with_ignored_ = reading.source;
    if (std::find(ignored_fields_.begin(), ignored_fields_.end(), field) == ignored_fields_.end())
      ignored_fields_.push_back(field);
  }
  std::vector<std::string> notes;
  for (const FrameDoubt doubt : reading.doubts) {
    if (std::find(doubts_.begin(), doubts_.end(), doubt) != doubts_.end()) continue;
    doubts_.push_back(doubt);
    if (doubt == FrameDoubt::HugeExtent)
      notes.push_back(
          reading.source +
          ": warning: the points span more than 20 km: their unit may not be the metre, or single points lie "
          "far outside; " +
          remedies_.unit);
    else
      notes.push_back(reading.source +
                      ": warning: the ground is perpendicular to y of the map frame, but z must point up; " +
                      remedies_.up);
  }
  return notes;
}

std::vector<std::string> ReadingNotes::totals() const {
  std::vector<std::string> notes;
  if (no_return_count_ > 0)
    notes.push_back(std::to_string(no_return_count_) + " records without a finite position (no return) skipped in " +
                    std::to_string(scans_with_no_return_) + " of " + std::to_string(scans_) + " scans (" +
                    first_with_no_return_ + (scans_with_no_return_ > 1 ? ", ...)" : ")"));
  if (withheld_count_ > 0)
    notes.push_back(std::to_string(withheld_count_) +
                    " points skipped that files mark as withheld, which means deleted (" + first_with_withheld_ + ')');
  if (!ignored_fields_.empty()) {
    std::string names;
    for (const std::string& field : ignored_fields_) names += (names.empty() ? "" : ", ") + field;
    notes.push_back("ignored fields: " + names + ": another field has the same meaning (" + first_with_ignored_ + ')');
  }
  return notes;
}

}  // namespace cluxel::scan
