// SPDX-License-Identifier: Apache-2.0
// The names of the stages, and what the first of them reads.
#include "perception/stage_tiles.hpp"

#include <utility>

namespace cluxel::perception {

std::string_view nameOf(Stage stage) {
  constexpr std::array<std::string_view, kStageCount> kNames{"points",    "cluxels", "ground",     "features", "labels",
                                                             "summaries", "even",    "components", "contacts"};
  return kNames[static_cast<std::size_t>(stage)];
}

TileSegments segmentsOf(std::span<const scan::Scan> scans, const TileGrid& grid) {
  TileSegments segments;
  for (const scan::Scan& scan : scans)
    for (auto& [key, segment] : splitScan(scan, grid)) segments[key].push_back(std::move(segment));
  return segments;
}

}  // namespace cluxel::perception
