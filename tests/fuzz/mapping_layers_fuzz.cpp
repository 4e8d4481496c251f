// SPDX-License-Identifier: Apache-2.0
// Any bytes as the stored layers of a tile or the record of an object, or edits of valid ones: refused with an Error,
// or read, and written again in a form that reads alike.
#include "base/packing/zstd_packing.hpp"
#include "edited_bytes.hpp"
#include "mapping/layers/object_record.hpp"
#include "mapping/layers/tile_layer.hpp"
#include "scan_reader_fuzzing.hpp"

namespace {

using namespace cluxel;
using namespace cluxel::mapping;
constexpr std::size_t kHead = 32;  // kind, version, tile, digest

std::string validLayer() {
  TileLayer layer;
  layer.key = {3, -4};
  for (std::uint8_t i = 0; i < 3; ++i)
    layer.primitives.push_back(
        {{{i}}, i, 7, Eigen::AlignedBox3f(Eigen::Vector3f(i, 0, 0), Eigen::Vector3f(i + 1.0F, 2, 3))});
  layer.shares = {{{{1}}, "urn:Tree", {2}}, {{{1}}, "urn:Trunk", {0, 1}}, {{{2}}, "urn:Tree", {1}}};
  layer.share_of_cluxel = {1, kNoShare, 0, 2, 1};
  return toBytes(layer);
}

std::string roundTrip(bool is_layer, std::string_view bytes) {
  return is_layer ? toBytes(tileLayerFromBytes(bytes)) : toBytes(objectRecordFromBytes(bytes));
}

std::string editedInside(const std::string& valid, std::string_view edits) {
  const std::string inside(unpackedBytes(std::string_view(valid).substr(kHead), std::uint64_t{1} << 30U)->view());
  return valid.substr(0, kHead) + packedBytes(fuzz::edited(inside, edits));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::string layer = validLayer();
  static const std::string record = toBytes(ObjectRecord{"urn:Tree", "tree", 0.5, false, {{1, 2}, {1, 3}}});
  if (size == 0) return 0;
  const bool is_layer = data[0] % 2 == 0, is_raw = data[0] / 2 % 4 == 0;
  const std::string_view rest = fuzz::textOf(data + 1, size - 1);
  std::string bytes(rest);
  if (!is_raw) bytes = is_layer ? editedInside(layer, rest) : fuzz::edited(record, rest);
  try {
    const std::string written = roundTrip(is_layer, bytes);
    fuzz::require(roundTrip(is_layer, written) == written);
  } catch (const Error& error) {
    fuzz::require(error.kind() == ErrorKind::StoreUnavailable);
  }
  return 0;
}
