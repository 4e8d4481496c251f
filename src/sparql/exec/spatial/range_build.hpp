// SPDX-License-Identifier: Apache-2.0
// The build side of a range join: its rows in a box tree over the numbers and geometries that the tests limit.
#pragma once

#include <optional>
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
  /// Rows without a place in a tree: every test may be true for them.
  const std::vector<std::uint32_t>& loose() const { return loose_; }

  /// What the tests allow for one row.
  struct Search {
    BoxTree::Box box;                          ///< of a tree
    std::optional<std::uint32_t> system = {};  ///< of the place of the row, if it is known
  };
  /// Narrows the search to what a test allows.
  void narrow(const RangeTest& test, const KnownNumber& bound, const KnownBox& place, Search& search) const;
  /// The rows that may pass the tests, ascending. Notes where rows of other coordinate systems are left out.
  void find(const Search& search, std::vector<std::uint32_t>& found, FunctionContext& functions);
  /// The tree of the rows of one coordinate system.
  const BoxTree& treeOf(std::uint32_t system, FunctionContext& functions);
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
  Known place(const ValueId* row, Runtime& runtime, Search& placed);
  void noteOthers(std::uint32_t system, FunctionContext& functions);

  OperatorPtr source_;
  RowTable table_;
  std::vector<Key> keys_;
  std::size_t dimensions_ = 0;
  SystemTrees trees_;  ///< by the system of the first geometry of a row
  std::vector<bool> noted_;
  std::vector<std::uint32_t> loose_;
  std::size_t charged_ = 0;
  bool strict_, is_made_ = false, has_floats_ = false;
};

}  // namespace cluxel::sparql
