// SPDX-License-Identifier: Apache-2.0
// Regions tile by tile: the parts of each tile, and which parts of neighbouring tiles belong together.
#pragma once

#include <vector>

#include "mapping/ways/even_ground.hpp"
#include "mapping/ways/way_tile.hpp"

namespace cluxel::mapping {

/// Parts of all tiles of some ground: measured cells without things that one can cross without a step.
class RegionParts {
 public:
  explicit RegionParts(const GroundCells& ground);

  /// Of the tile with number `slot` in the ground's tiles.
  const std::vector<RegionPart>& partsOf(std::uint32_t slot) const { return parts_[slot]; }
  /// The part that a cell lies in, or kNoRegion.
  std::uint16_t partAt(std::uint32_t cell) const { return part_at_[cell]; }
  /// To tiles that come before this one in the order of tiles.
  std::vector<RegionLink> linksOf(std::uint32_t slot) const;

 private:
  bool isCrossed(std::uint32_t from, std::uint32_t to) const;
  void findParts(std::uint32_t slot);
  void addPart(std::uint32_t slot, const std::vector<std::uint32_t>& cells);

  const GroundCells& ground_;
  std::vector<std::uint8_t> is_open_;
  std::vector<std::uint16_t> part_at_;
  std::vector<std::vector<RegionPart>> parts_;
};

}  // namespace cluxel::mapping
