// SPDX-License-Identifier: Apache-2.0
// The build side of a range join: its rows in a box tree over the numbers and geometries that the tests limit.
#pragma once

#include <vector>

#include "sparql/exec/operators/operators.hpp"
#include "sparql/exec/row_table.hpp"
#include "sparql/exec/spatial/box_tree.hpp"
#include "sparql/exec/spatial/range_test.hpp"

namespace cluxel::sparql {

class RangeBuild {
 public:
  /// `strict`: a row whose geometry is not one is dropped, because a test on it fails.
  RangeBuild(OperatorPtr source, const std::vector<RangeTest>& tests, bool strict);

  void reopen(Runtime& runtime, bool fresh);
  void make(Runtime& runtime);
  const Operator& source() const { return *source_; }
  const RowTable& table() const { return table_; }
  const BoxTree& tree() const { return tree_; }
  /// Rows without a place in the tree: every test may be true for them.
  const std::vector<std::uint32_t>& loose() const { return loose_; }

  /// Narrows `query_box`, a box of the tree, to what a test allows.
  void narrow(const RangeTest& test, const KnownNumber& bound, const Box2& place, BoxTree::Box& query_box) const;
  /// The axis of a slot in the tree; that of x for a geometry. The number of dimensions if it has none.
  std::size_t axisOf(Slot slot, bool is_geometry) const;
  /// True for the geometry by which the tree gives the nearest rows.
  bool isNearestBy(Slot slot) const { return axisOf(slot, true) == 0; }

 private:
  struct Key {
    Slot slot;
    bool is_geometry;
    std::size_t axis, column;
  };
  Known place(const ValueId* row, Runtime& runtime, BoxTree::Box& box);

  OperatorPtr source_;
  RowTable table_;
  std::vector<Key> keys_;
  BoxTree tree_;
  std::vector<std::uint32_t> loose_;
  std::size_t charged_ = 0;
  bool strict_, is_made_ = false, has_floats_ = false;
};

}  // namespace cluxel::sparql
