// SPDX-License-Identifier: Apache-2.0
// The lane kernels for machines with AVX2: CMakeLists.txt gives this source its instruction set.
#include "perception/lane_kernel_bodies.hpp"

namespace cluxel {

template LaneKernels laneKernels<8>();

}  // namespace cluxel
