// SPDX-License-Identifier: Apache-2.0
// A packed R-tree over the boxes of WKT literals, as one block of bytes.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "rdf/store/quad_store.hpp"

namespace cluxel::rdf {

/// Coordinates as written, rounded outwards to float.
struct FlatBox {
  float min_x = 0, min_y = 0, max_x = 0, max_y = 0;

  static FlatBox around(double min_x, double min_y, double max_x, double max_y);
  bool meets(const FlatBox& other) const {
    return min_x <= other.max_x && other.min_x <= max_x && min_y <= other.max_y && other.min_y <= max_y;
  }
  bool operator==(const FlatBox&) const = default;
  /// The distance of two boxes; 0 when they meet.
  double distanceTo(const FlatBox& other) const;
};

/// Geometries by their literals. A loose one has no box: it is empty, malformed, or names a reference system.
struct GeometryEntries {
  struct Boxed {
    FlatBox box;
    TermId literal;
  };
  std::vector<Boxed> boxed;
  std::vector<TermId> loose;

  void add(TermId literal, std::string_view wkt);
  std::size_t size() const { return boxed.size() + loose.size(); }
};

/// Packs entries by sort-tile-recursion; the entries are reordered.
std::string packedTree(GeometryEntries& entries);

/// A view of packed bytes. Throws Error (StoreUnavailable) for bytes of another form.
class PackedTree {
 public:
  static constexpr std::size_t kFanOut = 16;

  explicit PackedTree(std::string_view bytes);
  std::size_t size() const { return literals_.size(); }
  std::span<const TermId> literals() const { return literals_; }
  std::span<const TermId> loose() const { return loose_; }
  std::size_t levelCount() const { return levels_.size(); }
  /// The boxes of a level: 0 are those of the literals; a box of level n + 1 covers kFanOut of level n.
  std::span<const FlatBox> level(std::size_t n) const { return levels_[n]; }
  /// The range of boxes of level n - 1 below a box of level n.
  std::pair<std::size_t, std::size_t> below(std::size_t n, std::size_t box) const;
  void meeting(const FlatBox& query_box, std::vector<TermId>& found) const;
  /// All entries, for packing them anew with others.
  void appendTo(GeometryEntries& entries) const;
  /// True when every box above the lowest level is the bounding box of its children.
  bool isTight() const;

 private:
  std::span<const TermId> literals_, loose_;
  std::vector<std::span<const FlatBox>> levels_;
};

}  // namespace cluxel::rdf
