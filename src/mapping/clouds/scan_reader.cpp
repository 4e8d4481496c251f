// SPDX-License-Identifier: Apache-2.0
// Each scan has its own future: nobody waits for the slowest of several scans.
#include "mapping/clouds/scan_reader.hpp"

#include <algorithm>
#include <utility>

namespace cluxel::mapping {

void ScanReader::begin(std::size_t number) {
  // Both: where the system has no more threads, a scan is read when it is asked for.
  const auto policy = threads_ > 1 ? std::launch::async | std::launch::deferred : std::launch::deferred;
  const std::size_t count = std::min<std::size_t>(std::max(threads_, 1U), scans_.size() - number);
  while (ahead_.size() < count)
    ahead_.push_back(std::async(policy, [this, next = number + ahead_.size()] {
      const scan::LoadedScan loaded = scans_.read(next);
      return ReadScan{loaded.reading, prepareScan(loaded.scan, perception::TileGrid(scans_.mapOrigin()))};
    }));
}

ReadScan ScanReader::take(std::size_t number) {
  begin(number);
  std::future<ReadScan> first = std::move(ahead_.front());
  ahead_.pop_front();
  ReadScan scan = first.get();
  // While a small scan is stored, all threads read the next ones. A large one is stored first: it takes much memory.
  constexpr std::size_t kSmall = 500'000;  // points
  if (scan.scan.cloud.point_count <= kSmall && number + 1 < scans_.size()) begin(number + 1);
  return scan;
}

}  // namespace cluxel::mapping
