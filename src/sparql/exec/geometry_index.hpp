// SPDX-License-Identifier: Apache-2.0
// An R-tree over the bounding boxes of the WKT literals of one predicate.
#pragma once

#include <memory>
#include <vector>

#include "rdf/store/quad_store.hpp"
#include "sparql/functions/geometry.hpp"

namespace cluxel::sparql {

/// The index of one predicate at one commit, shared by the readers of the commit.
class GeometryIndex {
 public:
  GeometryIndex(const rdf::QuadReader& reader, rdf::TermId predicate);
  ~GeometryIndex();
  GeometryIndex(const GeometryIndex&) = delete;
  GeometryIndex& operator=(const GeometryIndex&) = delete;

  /// The ids of the literals whose boxes intersect `box`, and of empty geometries; ascending.
  std::vector<rdf::TermId> meeting(const Box2& box) const;
  std::size_t size() const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

/// The index if it has been built, else null.
std::shared_ptr<const GeometryIndex> knownGeometryIndex(const rdf::QuadReader& reader, rdf::TermId predicate);
/// The index; builds it on first use and caches it for the readers of the commit.
std::shared_ptr<const GeometryIndex> geometryIndex(const rdf::QuadReader& reader, rdf::TermId predicate);

}  // namespace cluxel::sparql
