// SPDX-License-Identifier: Apache-2.0
// The spatial index of a map: packed R-trees over the boxes of all geo:wktLiterals of the dictionary, kept in blocks.
// Terms are never removed, so that a commit only adds trees for its new literals and merges small ones.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "rdf/store/geometry_boxes.hpp"

namespace cluxel::rdf {

/// The geometries of one commit, whether a quad still uses them or not.
class GeometryIndex {
 public:
  /// Reads the stored trees. Literals that they lack, of a map that an earlier version wrote, are indexed in memory.
  /// Throws Error (StoreUnavailable) on damaged blocks.
  explicit GeometryIndex(const QuadReader& reader, const ReadTransaction& transaction);
  GeometryIndex(const GeometryIndex&) = delete;
  GeometryIndex& operator=(const GeometryIndex&) = delete;

  /// The literals whose boxes meet `query_box`, and the loose ones; ascending.
  std::vector<TermId> meeting(const FlatBox& query_box) const;
  std::size_t size() const { return boxed_ + loose_.size(); }
  /// The literals without a box, ascending.
  const std::vector<TermId>& loose() const { return loose_; }
  /// The literals that were not stored with the map.
  std::size_t madeInMemory() const { return made_; }
  const std::vector<PackedTree>& trees() const { return trees_; }

 private:
  void open(std::string_view bytes);

  std::vector<std::vector<std::uint32_t>> copies_;  ///< of trees that lie unaligned in the map, or not in it
  std::vector<PackedTree> trees_;
  std::vector<TermId> loose_;
  std::size_t boxed_ = 0, made_ = 0;
};

/// Gives the literals of an index by ascending distance of their boxes from a box; loose ones are left out.
class NearestGeometries {
 public:
  NearestGeometries(std::shared_ptr<const GeometryIndex> index, const FlatBox& from);

  struct Found {
    TermId literal = kNoTerm;
    double min_distance = 0;  ///< a lower bound of the distance
  };
  bool next(Found& found);

 private:
  struct Open {
    double distance;
    const PackedTree* tree;
    std::size_t level, box;
  };
  void push(const PackedTree& tree, std::size_t level, std::size_t box);

  std::shared_ptr<const GeometryIndex> index_;
  FlatBox from_;
  std::vector<Open> open_;  ///< a heap
};

/// Compares the stored index with the literals of the dictionary, box by box. What is wrong, in words for a person; at
/// most some faults of each tree. Literals after the last indexed term are no fault: they are indexed when needed.
/// Throws Error (StoreUnavailable) on damaged blocks. Cost: reads every term.
std::vector<std::string> faultsOfGeometryIndex(const QuadReader& reader, const ReadTransaction& transaction);

/// Adds the literals among the terms `first` to `last`, which `made` holds, to the stored index; and those before
/// `first` that it lacks. Cost: each literal is written again about log2(n) times in the life of a map.
void extendGeometryIndex(WriteTransaction& transaction, const QuadReader& reader, GeometryEntries made, TermId first,
                         TermId last);

}  // namespace cluxel::rdf
