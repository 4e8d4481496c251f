// SPDX-License-Identifier: Apache-2.0
// Keeps pieces a partition of the scene's cluxels at all times; objects are disjoint because pieces are.
#include "reasoning/piece_table.hpp"

#include <algorithm>
#include <cassert>

namespace cluxel {

PieceTable::PieceTable(const Scene& scene)
    : scene_(scene), pieces_of_primitive_(scene.primitives.size()), piece_of_cluxel_(scene.cluxels.size(), kFree) {
  for (PrimitiveIndex i = 0; i < scene.primitives.size(); ++i) {
    Piece piece;
    piece.primitive = i;
    piece.cluxels = scene.primitives[i].cluxels;
    add(std::move(piece));
  }
}

PieceIndex PieceTable::add(Piece piece) {
  const auto index = static_cast<PieceIndex>(pieces_.size());
  for (std::uint32_t cluxel : piece.cluxels) piece_of_cluxel_[cluxel] = index;
  pieces_of_primitive_[piece.primitive].push_back(index);
  pieces_.push_back(std::move(piece));
  shapes_.emplace_back();
  measure(index);
  return index;
}

void PieceTable::measure(PieceIndex index) {
  const Piece& piece = pieces_[index];
  const Primitive& primitive = scene_.primitives[piece.primitive];
  const bool whole = piece.cluxels.size() == primitive.cluxels.size();
  const std::array<PrimitiveIndex, 1> members{piece.primitive};
  shapes_[index] =
      whole ? shapeOfPrimitive(primitive, scene_.cluxels) : shapeOfCluxels(scene_, piece.cluxels, members, {});
}

std::vector<PieceIndex> PieceTable::cut(PieceIndex index, std::vector<std::vector<std::uint32_t>> parts) {
  assert(pieces_[index].alive);
  const PrimitiveIndex primitive = pieces_[index].primitive;
  pieces_[index].alive = false;
  std::erase(pieces_of_primitive_[primitive], index);
  std::vector<PieceIndex> made;
  for (auto& cluxels : parts) {
    if (cluxels.empty()) continue;
    Piece piece;
    piece.primitive = primitive;
    piece.cluxels = std::move(cluxels);
    made.push_back(add(std::move(piece)));
  }
  return made;
}

void PieceTable::join(PieceIndex index, PieceIndex other) {
  assert(index != other && pieces_[index].alive && pieces_[other].alive);
  Piece& piece = pieces_[index];
  std::vector<std::uint32_t> merged;
  std::merge(piece.cluxels.begin(), piece.cluxels.end(), pieces_[other].cluxels.begin(), pieces_[other].cluxels.end(),
             std::back_inserter(merged));
  piece.cluxels = std::move(merged);
  for (std::uint32_t cluxel : pieces_[other].cluxels) piece_of_cluxel_[cluxel] = index;
  pieces_[other].alive = false;
  std::erase(pieces_of_primitive_[piece.primitive], other);
  measure(index);
}

bool PieceTable::before(PieceIndex a, PieceIndex b) const {
  const Piece& first = pieces_[a];
  const Piece& second = pieces_[b];
  if (first.primitive != second.primitive)
    return scene_.primitives[first.primitive].id < scene_.primitives[second.primitive].id;
  return first.cluxels < second.cluxels;
}

Thing PieceTable::thingOf(std::vector<PieceIndex> pieces) const {
  Thing thing;
  std::sort(pieces.begin(), pieces.end());
  pieces.erase(std::unique(pieces.begin(), pieces.end()), pieces.end());
  thing.pieces = std::move(pieces);
  if (thing.pieces.size() == 1) {
    thing.shape = shapes_[thing.pieces.front()];
    return thing;
  }
  thing.shape = shapeOf(thing, cluxelsOf(thing));
  return thing;
}

/// The shape of `cluxels` (ascending), which are some or all of the thing's.
Shape PieceTable::shapeOf(const Thing& thing, std::span<const std::uint32_t> cluxels) const {
  std::vector<PieceIndex> ordered = thing.pieces;
  std::sort(ordered.begin(), ordered.end(), [this](PieceIndex a, PieceIndex b) { return before(a, b); });
  auto isHere = [&](std::uint32_t cluxel) { return std::binary_search(cluxels.begin(), cluxels.end(), cluxel); };
  std::vector<PrimitiveIndex> members, whole;
  for (PieceIndex piece : ordered) {
    const std::vector<std::uint32_t>& own = pieces_[piece].cluxels;
    if (std::none_of(own.begin(), own.end(), isHere)) continue;
    const PrimitiveIndex primitive = pieces_[piece].primitive;
    if (std::find(members.begin(), members.end(), primitive) == members.end()) members.push_back(primitive);
    const bool is_whole = own.size() == scene_.primitives[primitive].cluxels.size();
    if (is_whole && std::all_of(own.begin(), own.end(), isHere)) whole.push_back(primitive);
  }
  return shapeOfCluxels(scene_, cluxels, members, whole);
}

std::optional<Shape> PieceTable::shapeOfSlice(const Thing& thing, const SliceSpec& slice) const {
  std::vector<std::uint32_t> cluxels = cluxelsOf(thing);
  const std::size_t all = cluxels.size();
  std::erase_if(cluxels, [&](std::uint32_t cluxel) { return !isWithin(scene_.cluxels, cluxel, slice); });
  if (cluxels.empty()) return std::nullopt;
  return cluxels.size() == all ? thing.shape : shapeOf(thing, cluxels);
}

std::vector<std::uint32_t> PieceTable::cluxelsOf(const Thing& thing) const {
  std::vector<std::uint32_t> cluxels;
  for (PieceIndex piece : thing.pieces)
    cluxels.insert(cluxels.end(), pieces_[piece].cluxels.begin(), pieces_[piece].cluxels.end());
  std::sort(cluxels.begin(), cluxels.end());
  return cluxels;
}

bool isWithin(const SceneCluxels& all, std::uint32_t cluxel, const SliceSpec& slice) {
  const double height = static_cast<double>(all.height_above_ground[cluxel]);
  return height >= slice.from_m && height <= slice.to_m;
}

std::vector<std::vector<std::uint32_t>> connectedBunches(const SceneCluxels& all,
                                                         std::span<const std::uint32_t> cluxels) {
  std::vector<std::vector<std::uint32_t>> bunches;
  std::vector<bool> seen(cluxels.size(), false);
  auto place = [&](std::uint32_t cluxel) {
    const auto found = std::lower_bound(cluxels.begin(), cluxels.end(), cluxel);
    const bool here = found != cluxels.end() && *found == cluxel;
    return here ? static_cast<std::size_t>(found - cluxels.begin()) : cluxels.size();
  };
  for (std::size_t start = 0; start < cluxels.size(); ++start) {
    if (seen[start]) continue;
    std::vector<std::uint32_t> bunch{cluxels[start]};
    seen[start] = true;
    for (std::size_t next = 0; next < bunch.size(); ++next)
      for (std::uint32_t neighbour : all.neighbours(bunch[next])) {
        const std::size_t at = place(neighbour);
        if (at == cluxels.size() || seen[at]) continue;
        seen[at] = true;
        bunch.push_back(neighbour);
      }
    std::sort(bunch.begin(), bunch.end());
    bunches.push_back(std::move(bunch));
  }
  return bunches;
}

}  // namespace cluxel
