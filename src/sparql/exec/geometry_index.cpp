// SPDX-License-Identifier: Apache-2.0
// The R-tree of Boost.Geometry, packed at once.
#include "sparql/exec/geometry_index.hpp"

// See geometry.cpp.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#include <algorithm>
#include <boost/geometry.hpp>
#include <boost/geometry/geometries/box.hpp>
#include <boost/geometry/geometries/point_xy.hpp>
#include <boost/geometry/index/rtree.hpp>
#include <cmath>
#include <iterator>

#include "rdf/vocabulary.hpp"

namespace cluxel::sparql {
namespace {

using Corner = boost::geometry::model::d2::point_xy<double>;
using TreeBox = boost::geometry::model::box<Corner>;
using Entry = std::pair<TreeBox, rdf::TermId>;

TreeBox treeBox(const Box2& box) {
  return {Corner(box.min_x, box.min_y), Corner(box.max_x, box.max_y)};
}

bool isProper(const Box2& box) {
  return std::isfinite(box.min_x) && std::isfinite(box.min_y) && std::isfinite(box.max_x) && std::isfinite(box.max_y);
}

std::string nameOf(rdf::TermId predicate) {
  return "boxes of " + std::to_string(predicate);
}

}  // namespace

struct GeometryIndex::Tree {
  boost::geometry::index::rtree<Entry, boost::geometry::index::rstar<16>> boxes;
  std::vector<rdf::TermId> without_box;
};

GeometryIndex::GeometryIndex(const rdf::QuadReader& reader, rdf::TermId predicate) : tree_(std::make_unique<Tree>()) {
  const std::string datatype = std::string(rdf::vocabulary::kGeo) + "wktLiteral";
  std::vector<Entry> entries;
  rdf::QuadPattern pattern;
  pattern.p = predicate;
  rdf::QuadCursor cursor = reader.scan(pattern, rdf::QuadOrder::Posg);
  rdf::TermId last = rdf::kNoTerm;
  for (rdf::QuadIds quad; cursor.next(quad);) {
    if (quad.o == last) continue;
    last = quad.o;
    const rdf::TermView literal = reader.viewOf(quad.o);
    if (literal.kind != TermKind::Literal || literal.datatype != datatype) continue;
    const auto geometry = parseWkt(literal.text);
    if (!geometry) continue;
    const Box2 box = boundsOf(*geometry);
    if (isProper(box))
      entries.emplace_back(treeBox(box), quad.o);
    else
      tree_->without_box.push_back(quad.o);
  }
  tree_->boxes = {entries.begin(), entries.end()};
}

GeometryIndex::~GeometryIndex() = default;

std::vector<rdf::TermId> GeometryIndex::meeting(const Box2& box) const {
  std::vector<rdf::TermId> found = tree_->without_box;
  const auto meets = boost::geometry::index::intersects(treeBox(box));
  for (auto entry = tree_->boxes.qbegin(meets); entry != tree_->boxes.qend(); ++entry) found.push_back(entry->second);
  std::sort(found.begin(), found.end());
  return found;
}

std::size_t GeometryIndex::size() const {
  return tree_->boxes.size() + tree_->without_box.size();
}

std::shared_ptr<const GeometryIndex> knownGeometryIndex(const rdf::QuadReader& reader, rdf::TermId predicate) {
  return std::static_pointer_cast<const GeometryIndex>(reader.kept(nameOf(predicate)));
}

std::shared_ptr<const GeometryIndex> geometryIndex(const rdf::QuadReader& reader, rdf::TermId predicate) {
  auto index = knownGeometryIndex(reader, predicate);
  if (index) return index;
  index = std::make_shared<const GeometryIndex>(reader, predicate);
  reader.keep(nameOf(predicate), index);
  return index;
}

}  // namespace cluxel::sparql
