// SPDX-License-Identifier: Apache-2.0
// The primitives as reasoning cuts and hands them out: each piece is free, shared for now, owned, or left unknown.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "cluxel/reasoning/rule_condition.hpp"
#include "reasoning/thing.hpp"

namespace cluxel {

using OwnerIndex = std::uint32_t;
inline constexpr OwnerIndex kFree = 0xFFFFFFFFU;
inline constexpr OwnerIndex kShared = 0xFFFFFFFEU;   ///< claimed by one or more objects, to be parted
inline constexpr OwnerIndex kUnknown = 0xFFFFFFFDU;  ///< a rule said: leave it

struct Piece {
  PrimitiveIndex primitive = 0;
  std::vector<std::uint32_t> cluxels;  ///< ascending
  OwnerIndex owner = kFree;
  bool alive = true;  ///< false: it was cut, or joined to another one
};

class PieceTable {
 public:
  explicit PieceTable(const Scene& scene);

  const Piece& operator[](PieceIndex piece) const { return pieces_[piece]; }
  std::size_t size() const { return pieces_.size(); }
  PieceIndex pieceOf(std::uint32_t cluxel) const { return piece_of_cluxel_[cluxel]; }
  /// The living pieces of a primitive.
  const std::vector<PieceIndex>& piecesOf(PrimitiveIndex primitive) const { return pieces_of_primitive_[primitive]; }
  PrimitiveLabel labelOf(PieceIndex piece) const { return scene_.primitives[pieces_[piece].primitive].label; }

  void setOwner(PieceIndex piece, OwnerIndex owner) { pieces_[piece].owner = owner; }
  /// Replaces a piece by new free ones; `parts` are a partition of its cluxels, each ascending.
  std::vector<PieceIndex> cut(PieceIndex piece, std::vector<std::vector<std::uint32_t>> parts);
  /// Adds the cluxels of `other` (of the same primitive) to `piece`, which keeps its owner.
  void join(PieceIndex piece, PieceIndex other);

  /// True when `a` comes before `b`, whatever the order of primitives in the scene.
  bool before(PieceIndex a, PieceIndex b) const;
  /// The thing that some pieces make together.
  Thing thingOf(std::vector<PieceIndex> pieces) const;
  /// What of a thing lies between two heights above the ground, measured as a thing of its own; absent when nothing
  /// does.
  std::optional<Shape> shapeOfSlice(const Thing& thing, const SliceSpec& slice) const;
  /// All cluxels of a thing, ascending.
  std::vector<std::uint32_t> cluxelsOf(const Thing& thing) const;
  const Shape& shapeOf(PieceIndex piece) const { return shapes_[piece]; }

 private:
  Shape shapeOf(const Thing& thing, std::span<const std::uint32_t> cluxels) const;
  PieceIndex add(Piece piece);
  void measure(PieceIndex piece);

  const Scene& scene_;
  std::vector<Piece> pieces_;
  std::vector<Shape> shapes_;
  std::vector<std::vector<PieceIndex>> pieces_of_primitive_;
  std::vector<PieceIndex> piece_of_cluxel_;
};

/// True when the cluxel's height above the local ground is within the slice.
bool isWithin(const SceneCluxels& all, std::uint32_t cluxel, const SliceSpec& slice);

/// The connected bunches of `cluxels` (ascending) in the cluxel graph, each ascending, in the order of their first.
std::vector<std::vector<std::uint32_t>> connectedBunches(const SceneCluxels& all,
                                                         std::span<const std::uint32_t> cluxels);

}  // namespace cluxel
