// SPDX-License-Identifier: Apache-2.0
// Scans are compared by their ids: maps under other names, and merged maps, hold the same ones.
#include "tasks/evaluation/shared_scans.hpp"

namespace cluxel::tasks {

std::optional<std::string> SharedScans::add(const std::string& map_name, const std::vector<mapping::Cloud>& clouds) {
  ++maps_;
  std::size_t shared = 0;
  std::string example, holder;
  for (const mapping::Cloud& cloud : clouds) {
    const auto [first, is_new] = first_holder_.emplace(cloud.id.hex(), Holder{map_name, maps_});
    if (is_new || first->second.number == maps_) continue;
    if (++shared == 1) example = cloud.source, holder = first->second.map_name;
  }
  if (shared == 0) return std::nullopt;
  return map_name + ": " + std::to_string(shared) + " of its " + std::to_string(clouds.size()) +
         (shared == 1 ? " scans is" : " scans are") + " in earlier maps, too (" + example + " in " + holder + ")";
}

bool SharedScans::isOfEarlierMap(const std::string& scan_hex) const {
  const auto first = first_holder_.find(scan_hex);
  return first != first_holder_.end() && first->second.number < maps_;
}

}  // namespace cluxel::tasks
