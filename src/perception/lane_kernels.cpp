// SPDX-License-Identifier: Apache-2.0
// The lane kernels for any machine, and the choice between the two.
#include "perception/lane_kernel_bodies.hpp"

namespace cluxel {

template LaneKernels laneKernels<4>();

bool hasEightLanes() {
#if defined(__x86_64__)
  return __builtin_cpu_supports("avx2") != 0;
#else
  return false;
#endif
}

}  // namespace cluxel
