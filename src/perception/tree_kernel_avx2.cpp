// SPDX-License-Identifier: Apache-2.0
// The tree kernel for machines with AVX2: CMakeLists.txt gives this source its instruction set.
#include "perception/tree_kernel_lanes.hpp"

namespace cluxel {

template TreeKernel addTrees<8>;

}  // namespace cluxel
