// SPDX-License-Identifier: Apache-2.0
// Any bytes as the stored output of each stage, or edits of a valid one: refused with an Error, or read and written
// again as the same bytes.
#include <array>
#include <cmath>

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
constexpr std::size_t kKinds = 8;
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

Blocks validBlocks() {
  const std::array<Scan, 1> scans{smallScan()};
  const TileOutputs tiles = perceive(scans, {}, 1);
  const TileKey key = tiles.points.begin()->first;
  const std::size_t cluxels = tiles.cluxels.at(key).size();
  LabelTile labels;
  labels.key = key;
  labels.label.assign(cluxels, 0);
  labels.probability.assign(cluxels, LabelValues{1, 0, 0, 0, 0});
  return {toBytes(splitScan(scans[0]).begin()->second),
          toBytes(tiles.points.at(key)),
          toBytes(tiles.cluxels.at(key)),
          toBytes(tiles.ground.at(key)),
          toBytes(tiles.features.at(key)),
          toBytes(labels),
          toBytes(ComponentTile{}),
          toBytes(ContactTile{})};
}

std::string roundTrip(std::size_t kind, std::string_view bytes) {
  switch (kind) {
    case 0:
      return toBytes(scanSegmentFromBytes(bytes));
    case 1:
      return toBytes(tilePointsFromBytes(bytes));
    case 2:
      return toBytes(cluxelTileFromBytes(bytes));
    case 3:
      return toBytes(groundTileFromBytes(bytes));
    case 4:
      return toBytes(featureTileFromBytes(bytes));
    case 5:
      return toBytes(labelTileFromBytes(bytes));
    case 6:
      return toBytes(componentTileFromBytes(bytes));
    default:
      return toBytes(contactTileFromBytes(bytes));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Blocks valid = validBlocks();
  if (size == 0) return 0;
  const std::size_t kind = data[0] % kKinds;
  const std::string_view rest = fuzz::textOf(data + 1, size - 1);
  const std::string bytes = data[0] / kKinds % 4 == 0 ? std::string(rest) : fuzz::edited(valid[kind], rest);
  try {
    fuzz::require(roundTrip(kind, bytes) == bytes);
  } catch (const Error& error) {
    fuzz::require(error.kind() == ErrorKind::StoreUnavailable);
  }
  return 0;
}
