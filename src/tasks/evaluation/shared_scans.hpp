// SPDX-License-Identifier: Apache-2.0
// Scans that several of the maps hold which are judged together.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mapping/clouds/cloud.hpp"

namespace cluxel::tasks {

/// What is counted in two maps is counted twice: intervals are then too narrow, and few examples look like many.
class SharedScans {
 public:
  /// Takes the scans of one more map. Says which of them an earlier map holds, too; absent when none does.
  std::optional<std::string> add(const std::string& map_name, const std::vector<mapping::Cloud>& clouds);
  /// Whether a map that was added before the last one holds the scan.
  bool isOfEarlierMap(const std::string& scan_hex) const;

 private:
  struct Holder {
    std::string map_name;
    std::size_t number = 0;
  };
  std::map<std::string, Holder> first_holder_;  ///< by the scan's id
  std::size_t maps_ = 0;
};

}  // namespace cluxel::tasks
