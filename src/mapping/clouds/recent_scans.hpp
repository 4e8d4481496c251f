// SPDX-License-Identifier: Apache-2.0
// Scans that were read a short time ago, so that tiles that are read in several steps do not unpack them each time.
#pragma once

#include <cstdint>
#include <list>

#include "mapping/clouds/scan_store.hpp"

namespace cluxel::mapping {

class RecentScans {
 public:
  /// `transaction` must outlive it, and keep its scans.
  explicit RecentScans(const rdf::ReadTransaction& transaction) : transaction_(transaction) {}

  /// As storedScan(). The scan stays until the next call.
  const scan::Scan& scan(const scan::ScanId& id) {
    for (auto at = scans_.begin(); at != scans_.end(); ++at)
      if (at->id == id) {
        scans_.splice(scans_.begin(), scans_, at);
        return scans_.front();
      }
    scans_.push_front(storedScan(transaction_, id));
    points_ += scans_.front().points.size();
    while (scans_.size() > 1 && points_ > kMaxPoints) {
      points_ -= scans_.back().points.size();
      scans_.pop_back();
    }
    return scans_.front();
  }

 private:
  static constexpr std::size_t kMaxPoints = 2'000'000;  ///< some 40 MB

  const rdf::ReadTransaction& transaction_;
  std::list<scan::Scan> scans_;  ///< the last one read first
  std::size_t points_ = 0;
};

}  // namespace cluxel::mapping
