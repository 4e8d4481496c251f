// SPDX-License-Identifier: Apache-2.0
// The tree kernel for any machine, and the choice between the two.
#include "perception/tree_kernel_lanes.hpp"

namespace cluxel {

template TreeKernel addTrees<4>;

bool hasEightLanes() {
#if defined(__x86_64__)
  return __builtin_cpu_supports("avx2") != 0;
#else
  return false;
#endif
}

TreeKernel* fastestTreeKernel() { return hasEightLanes() ? addTrees<8> : addTrees<4>; }

}  // namespace cluxel
