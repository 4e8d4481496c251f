// SPDX-License-Identifier: Apache-2.0
// How far away the nearest of a set of things is: what "no other is nearer" allows.
#pragma once

#include <vector>

#include "sparql/exec/operators/operators.hpp"
#include "sparql/exec/spatial/box_tree.hpp"
#include "sparql/exec/spatial/range_test.hpp"

namespace cluxel::sparql {

/// The rows that may contradict FILTER NOT EXISTS { … FILTER(distance(place, other) < distance(place, ?slot)) }.
struct NearestTest {
  Slot slot = kNoSlot;           ///< a geometry of the build side, which must be the nearest one
  Expr place;                    ///< the geometry of the probe row
  OperatorPtr others;            ///< the pattern of NOT EXISTS, without its FILTERs
  Slot other = kNoSlot;          ///< its geometry
  Slot distinguished = kNoSlot;  ///< if set, the thing itself does not count: another value of this slot must be nearer
};

class NearestOthers {
 public:
  explicit NearestOthers(NearestTest test) : test_(std::move(test)) {}

  const NearestTest& test() const { return test_; }
  void reopen(Runtime& runtime, bool fresh);
  void make(Runtime& runtime);
  /// No geometry that is farther away than this can be the nearest one. Infinite if there are no others.
  double reach(const Value& place, const KnownBox& known, Runtime& runtime) const;

 private:
  struct Other {
    ValueId geometry, thing;
  };
  NearestTest test_;
  std::vector<Other> others_;
  SystemTrees trees_;
  std::size_t charged_ = 0;
  bool is_made_ = false;
};

}  // namespace cluxel::sparql
