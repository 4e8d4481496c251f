// SPDX-License-Identifier: Apache-2.0
// Scans in turn, of which the next ones are read on other threads.
#pragma once

#include <cstddef>
#include <deque>
#include <future>

#include "mapping/clouds/scan_store.hpp"
#include "scan/scan_set.hpp"

namespace cluxel::mapping {

struct ReadScan {
  scan::ScanReading reading;
  PreparedScan scan;
};

/// Reads and prepares the scans of a set. With two threads or more as many scans are read ahead, on threads of their
/// own; at most as many are in memory, and one more where scans are small.
class ScanReader {
 public:
  /// `scans` must outlive it.
  ScanReader(const scan::ScanSet& scans, unsigned threads) : scans_(scans), threads_(threads) {}

  /// Begins to read the scans from `number` on; with one thread nothing is read yet.
  void begin(std::size_t number);
  /// The scan of this number, which is asked for once, in ascending order. Throws what ScanSet::read() and
  /// prepareScan() throw for it: faults of later scans are told when it is their turn.
  ReadScan take(std::size_t number);

 private:
  const scan::ScanSet& scans_;
  unsigned threads_;
  std::deque<std::future<ReadScan>> ahead_;  ///< their destructors wait
};

}  // namespace cluxel::mapping
