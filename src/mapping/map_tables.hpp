// SPDX-License-Identifier: Apache-2.0
// The block tables of a map file and their keys.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "base/content_hash.hpp"
#include "perception/tile.hpp"

namespace cluxel::mapping::tables {

/// "state", "inputs", "semantic state", "splits", "tiles", "grid", "heights", "facts"; "inferred": what a later
/// inference needs to follow changes; "ways": what the facts about ways followed from.
inline constexpr std::string_view kMeta = "meta";
inline constexpr std::string_view kTilesKey = "tiles";          ///< in kMeta: the tiles of the map
inline constexpr std::string_view kGridKey = "grid";            ///< in kMeta: where the tiles lie
inline constexpr std::string_view kHeightsKey = "heights";      ///< in kMeta: the step of local heights
inline constexpr std::string_view kScans = "scans";             ///< scan id → description
inline constexpr std::string_view kScanPoints = "scan_points";  ///< scan id → points in the sensor frame
/// As kScans, of scans whose points were committed before them.
inline constexpr std::string_view kScansToCome = "scans_to_come";
inline constexpr std::string_view kPoints = "stage_points";  ///< tile → output of each stage
inline constexpr std::string_view kCluxels = "stage_cluxels";
inline constexpr std::string_view kGround = "stage_ground";
inline constexpr std::string_view kFeatures = "stage_features";
inline constexpr std::string_view kLabels = "stage_labels";
inline constexpr std::string_view kSummaries = "stage_summaries";
inline constexpr std::string_view kEven = "stage_even";
inline constexpr std::string_view kComponents = "stage_components";
inline constexpr std::string_view kContacts = "stage_contacts";
/// Of the stages of perception, in their order.
inline constexpr std::array kStageTables{kPoints,    kCluxels, kGround,     kFeatures, kLabels,
                                         kSummaries, kEven,    kComponents, kContacts};
inline constexpr std::string_view kTileLayers = "tile_layers";  ///< tile → its primitives and objects
inline constexpr std::string_view kObjects = "objects";         ///< object id → its record
inline constexpr std::string_view kWideTiles = "wide_tiles";    ///< tile → what it adds to class-wide objects
inline constexpr std::string_view kMargins = "rule_margins";    ///< tile → how far thresholds of rules may move
inline constexpr std::string_view kPresence = "presence";       ///< object id → when it was there
inline constexpr std::string_view kPassedRays = "passed_rays";  ///< object id → how many rays passed it
inline constexpr std::string_view kFactUnits = "fact_units";    ///< what units of facts followed from
inline constexpr std::string_view kOverruled = "overruled";     ///< object id → an object that a statement changed
inline constexpr std::string_view kStated = "stated";           ///< statement id → the tiles that it is about
inline constexpr std::string_view kSurfaces = "stage_surfaces";
inline constexpr std::string_view kWays = "stage_ways";
/// Tile near gone objects → their hash, and its even ground without them where that differs from kEven.
inline constexpr std::string_view kFreed = "freed_ground";

/// Keys sort by tile: big-endian with inverted sign bit.
inline std::string keyOf(const perception::TileKey& tile) {
  std::string key;
  for (const std::int32_t value : {tile.x, tile.y}) {
    const std::uint32_t biased = static_cast<std::uint32_t>(value) ^ 0x80000000U;
    for (int shift = 24; shift >= 0; shift -= 8) key += static_cast<char>(biased >> shift & 0xFFU);
  }
  return key;
}

inline perception::TileKey tileOfKey(std::string_view key) {
  std::array<std::int32_t, 2> values{};
  for (std::size_t i = 0; i < 2; ++i) {
    std::uint32_t biased = 0;
    for (std::size_t byte = 0; byte < 4; ++byte) biased = biased << 8U | static_cast<std::uint8_t>(key[4 * i + byte]);
    values[i] = static_cast<std::int32_t>(biased ^ 0x80000000U);
  }
  return {values[0], values[1]};
}

inline std::string keyOf(const ContentHash& hash) {
  return {reinterpret_cast<const char*>(hash.bytes.data()), hash.bytes.size()};
}

inline ContentHash hashOfKey(std::string_view key) {
  ContentHash hash;
  for (std::size_t i = 0; i < hash.bytes.size(); ++i) hash.bytes[i] = static_cast<std::uint8_t>(key[i]);
  return hash;
}

}  // namespace cluxel::mapping::tables
