// SPDX-License-Identifier: Apache-2.0
// Which geometries lie near a place: an R-tree over the boxes of one predicate's WKT literals.
#pragma once

#include <memory>
#include <vector>

#include "cluxel/knowledge/quad_store.hpp"
#include "sparql/geometry.hpp"

namespace cluxel::sparql {

/// The objects of one predicate at one commit. Not copied: readers of the commit share it.
class GeometryIndex {
 public:
  GeometryIndex(const QuadReader& reader, TermId predicate);
  ~GeometryIndex();
  GeometryIndex(const GeometryIndex&) = delete;
  GeometryIndex& operator=(const GeometryIndex&) = delete;

  /// Ids of the literals whose boxes meet `box`, and of those without a box (empty geometries); ascending.
  std::vector<TermId> meeting(const Box2& box) const;
  std::size_t size() const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

/// The index if some reader of the commit has made it already, else null.
std::shared_ptr<const GeometryIndex> knownGeometryIndex(const QuadReader& reader, TermId predicate);
/// The index, made now if it is not there, and kept for the readers of the commit.
std::shared_ptr<const GeometryIndex> geometryIndex(const QuadReader& reader, TermId predicate);

}  // namespace cluxel::sparql
