// SPDX-License-Identifier: Apache-2.0
// Points of a map as arrays, with the label of their surface and the object they belong to.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cluxel/export.hpp"
#include "cluxel/object.hpp"

namespace cluxel {

/// The shape of the surface around a point, as perception classified it.
enum class PrimitiveLabel : std::uint8_t { HorizontalPlane, VerticalPlane, Column, SmallStructure, Scatter };

/// "horizontal_plane", "vertical_plane", "column", "small_structure", "scatter".
CLUXEL_API std::string_view nameOf(PrimitiveLabel label);

/// The object number of a point that belongs to no object.
inline constexpr std::uint32_t kNoObject = 0xffffffffU;

/// Points in the map frame as a structure of arrays. All arrays have the same length, but `intensity` is empty when
/// one of the scans has none.
struct PointCloud {
  std::vector<double> x, y, z;   ///< [m, map]
  std::vector<float> intensity;  ///< in the sensor's own scale
  std::vector<PrimitiveLabel> label;
  std::vector<std::uint32_t> object;  ///< number in Map::objects(), or kNoObject

  std::size_t size() const { return x.size(); }
};

/// One scan of a map.
struct Cloud {
  std::string id;  ///< 32 hexadecimal digits, the hash of what was measured
  std::string iri;
  std::string source;                     ///< the file it was read from
  std::optional<double> time_s;           ///< seconds since 1970-01-01 UTC; absent when the scan has no time
  bool has_pose = false;                  ///< false: its points were given in the map frame
  std::array<double, 16> T_map_sensor{};  ///< pose of the sensor in the map, 4x4 row by row, translation in metres
  std::uint64_t point_count = 0;
  Position min, max;  ///< bounds of its points
};

}  // namespace cluxel
