// SPDX-License-Identifier: Apache-2.0
// The primitive labels of the paper, in the order that models, truth files and matrices share.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace cluxel::scan {

enum class PrimitiveLabel : std::uint8_t { HorizontalPlane, VerticalPlane, Column, SmallStructure, Scatter };

inline constexpr std::size_t kPrimitiveLabelCount = 5;
inline constexpr std::array<std::string_view, kPrimitiveLabelCount> kPrimitiveLabelNames{
    "horizontal_plane", "vertical_plane", "column", "small_structure", "scatter"};

inline std::string_view nameOf(PrimitiveLabel label) {
  return kPrimitiveLabelNames[static_cast<std::size_t>(label)];
}

inline std::optional<PrimitiveLabel> primitiveLabelOf(std::string_view name) {
  for (std::size_t i = 0; i < kPrimitiveLabelCount; ++i)
    if (kPrimitiveLabelNames[i] == name) return static_cast<PrimitiveLabel>(i);
  return std::nullopt;
}

}  // namespace cluxel::scan
