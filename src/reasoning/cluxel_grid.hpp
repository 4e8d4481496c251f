// SPDX-License-Identifier: Apache-2.0
// Distances between sets of cluxels, looked up through a sorted grid in plan view.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "cluxel/perception/scene.hpp"

namespace cluxel {

/// Distances between the boxes of two cluxels [m].
struct CluxelGap {
  double horizontal = 0, vertical = 0;
  double gap() const;
};
CluxelGap gapBetween(const SceneCluxels& all, std::uint32_t a, std::uint32_t b);

class CluxelGrid {
 public:
  explicit CluxelGrid(const SceneCluxels& all);

  /// Calls `visit` for every cluxel whose box may be within `distance_m` of the box of `cluxel`, in plan view.
  void near(std::uint32_t cluxel, double distance_m, const std::function<void(std::uint32_t)>& visit) const;
  /// The primitives with a cluxel whose box may be within `distance_m` of one of `cluxels`; ascending.
  std::vector<PrimitiveIndex> primitivesNear(std::span<const std::uint32_t> cluxels, double distance_m) const;

 private:
  struct Entry {
    std::int32_t x, y;
    std::uint32_t cluxel;
    auto operator<=>(const Entry&) const = default;
  };
  const SceneCluxels& all_;
  double margin_m_ = 0;  ///< half of the largest cluxel box in plan view
  std::vector<Entry> entries_;
};

}  // namespace cluxel
