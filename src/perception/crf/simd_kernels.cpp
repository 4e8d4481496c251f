// SPDX-License-Identifier: Apache-2.0
// The SIMD kernels for any machine, and the run-time dispatch.
#include "perception/crf/simd_kernel_bodies.hpp"

namespace cluxel::perception {

template SimdKernels simdKernels<4>();

bool hasEightLanes() {
#if defined(__x86_64__)
  return __builtin_cpu_supports("avx2") != 0;
#else
  return false;
#endif
}

}  // namespace cluxel::perception
