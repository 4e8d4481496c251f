// SPDX-License-Identifier: Apache-2.0
// Any bytes as the stored output of each stage, or edits of what a valid one packs: refused with an Error, or read, and
// written again in a form that reads alike.
#include <array>
#include <cmath>

#include "base/packing/zstd_packing.hpp"
#include "edited_bytes.hpp"
#include "perception/crf/labelling.hpp"
#include "perception/pipeline.hpp"
#include "perception/segments/component_tile.hpp"
#include "perception/segments/contact_tile.hpp"
#include "scan_reader_fuzzing.hpp"

namespace {

using namespace cluxel;
using namespace cluxel::scan;
using namespace cluxel::perception;
constexpr std::size_t kKinds = 9, kHead = 32;  // kind, version, tile, digest
using Blocks = std::array<std::string, kKinds>;

/// A floor with a wall and a pole, within one tile.
Scan smallScan() {
  Scan scan;
  const auto add = [&](double x, double y, double z) {
    scan.points.x.push_back(static_cast<float>(x));
    scan.points.y.push_back(static_cast<float>(y));
    scan.points.z.push_back(static_cast<float>(z));
  };
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 12; ++j) add(2 + 0.4 * i, 2 + 0.4 * j, 0), add(2 + 0.4 * i, 7, 0.2 * j);
  for (int i = 0; i < 30; ++i) add(4, 4, 0.1 * i);
  scan.id = contentIdOf(scan);
  return scan;
}

const TileOutputs& validTiles() {
  static const TileOutputs tiles = perceive(std::array<Scan, 1>{smallScan()}, {}, 1);
  return tiles;
}

Blocks validBlocks() {
  const TileOutputs& tiles = validTiles();
  const TileKey key = tiles.points.begin()->first;
  const std::size_t cluxels = tiles.cluxels.at(key).size();
  LabelTile labels;
  labels.key = key;
  labels.label.assign(cluxels, 0);
  labels.probability.assign(cluxels, LabelValues{1, 0, 0, 0, 0});
  return {toBytes(tiles.points.at(key)),
          toBytes(tiles.cluxels.at(key)),
          toBytes(tiles.ground.at(key)),
          toBytes(tiles.features.at(key)),
          toBytes(labels),
          toBytes(ComponentTile{}),
          toBytes(summaryOf(tiles.points.at(key), tiles.cluxels.at(key))),
          toBytes(evenGroundOf(ringIn(tiles.points, key), ringIn(tiles.ground, key))),
          toBytes(ContactTile{})};
}

TilePoints filled(std::string_view bytes) {
  TilePoints tile = tilePointsFromBytes(bytes);
  PointsFromScans from_scans({});
  from_scans.add(tile);
  from_scans.fill(smallScan());
  return tile;
}

std::string roundTrip(std::size_t kind, std::string_view bytes) {
  const TileOutputs& tiles = validTiles();
  switch (kind) {
    case 0:
      return toBytes(filled(bytes));
    case 1:
      return toBytes(cluxelTileFromBytes(bytes, tiles.points.begin()->second));
    case 2:
      return toBytes(groundTileFromBytes(bytes));
    case 3:
      return toBytes(featureTileFromBytes(bytes, tiles.cluxels.begin()->second.size()));
    case 4:
      return toBytes(labelTileFromBytes(bytes));
    case 5:
      return toBytes(componentTileFromBytes(bytes));
    case 6:
      return toBytes(summaryTileFromBytes(bytes));
    case 7:
      return toBytes(evenTileFromBytes(bytes));
    default:
      return toBytes(contactTileFromBytes(bytes));
  }
}

std::string editedInside(const std::string& valid, std::string_view edits) {
  const std::string_view all = valid;
  return valid.substr(0, kHead) +
         packedBytes(
             fuzz::edited(std::string(unpackedBytes(all.substr(kHead), std::uint64_t{1} << 30U)->view()), edits));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Blocks valid = validBlocks();
  if (size == 0) return 0;
  const std::size_t kind = data[0] % kKinds;
  const std::string_view rest = fuzz::textOf(data + 1, size - 1);
  const std::string bytes = data[0] / kKinds % 4 == 0 ? std::string(rest) : editedInside(valid[kind], rest);
  try {
    const std::string written = roundTrip(kind, bytes);
    fuzz::require(roundTrip(kind, written) == written);
  } catch (const Error& error) {
    fuzz::require(error.kind() == ErrorKind::StoreUnavailable);
  }
  return 0;
}
