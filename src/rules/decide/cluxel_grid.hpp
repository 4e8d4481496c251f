// SPDX-License-Identifier: Apache-2.0
// A grid in plan view over the cluxels of a scene, for distance queries.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "perception/segments/scene.hpp"

namespace cluxel::rules {

/// Distances between the boxes of two cluxels [m].
struct CluxelGap {
  double horizontal = 0, vertical = 0;
  double gap() const;
};
CluxelGap gapBetween(const perception::SceneCluxels& all, std::uint32_t a, std::uint32_t b);

class CluxelGrid {
 public:
  explicit CluxelGrid(const perception::SceneCluxels& all);

  /// Calls `visit` for every cluxel whose box may be within `distance_m` of the box of `cluxel`, in plan view.
  void near(std::uint32_t cluxel, double distance_m, const std::function<void(std::uint32_t)>& visit) const;
  /// The primitives with a cluxel whose box may be within `distance_m` of one of `cluxels`; ascending.
  std::vector<perception::PrimitiveIndex> primitivesNear(std::span<const std::uint32_t> cluxels,
                                                         double distance_m) const;

 private:
  struct Entry {
    std::int32_t x, y;
    std::uint32_t cluxel;
    auto operator<=>(const Entry&) const = default;
  };
  const perception::SceneCluxels& all_;
  double margin_m_ = 0;  ///< half of the largest cluxel box in plan view
  std::vector<Entry> entries_;
};

}  // namespace cluxel::rules
