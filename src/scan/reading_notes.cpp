// SPDX-License-Identifier: Apache-2.0
// Notes on what was skipped, ignored or doubtful while scans were read.
#include <algorithm>

#include "scan/scan_set.hpp"

namespace cluxel::scan {

void ReadingNotes::Fields::add(const std::vector<std::string>& fields, const std::string& source) {
  for (const std::string& field : fields) {
    if (names.empty()) first = source;
    if (std::find(names.begin(), names.end(), field) == names.end()) names.push_back(field);
  }
}

std::string ReadingNotes::Fields::note(const std::string& why) const {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return "ignored fields: " + list + ": " + why + " (" + first + ')';
}

std::vector<std::string> ReadingNotes::add(const ScanReading& reading) {
  ++scans_;
  if (reading.no_return_count > 0) {
    if (scans_with_no_return_++ == 0) first_with_no_return_ = reading.source;
    no_return_count_ += reading.no_return_count;
  }
  if (reading.withheld_count > 0 && withheld_count_ == 0) first_with_withheld_ = reading.source;
  withheld_count_ += reading.withheld_count;
  ignored_.add(reading.ignored_fields, reading.source);
  lone_origins_.add(reading.lone_origin_fields, reading.source);
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
  if (!ignored_.names.empty()) notes.push_back(ignored_.note("another field has the same meaning"));
  if (!lone_origins_.names.empty())
    notes.push_back(lone_origins_.note("where a ray starts takes all of vp_x, vp_y and vp_z"));
  return notes;
}

}  // namespace cluxel::scan
