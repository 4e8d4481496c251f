// SPDX-License-Identifier: Apache-2.0
// The SIMD kernels for machines with AVX2; CMakeLists.txt sets the instruction set of this source.
#include "perception/crf/simd_kernel_bodies.hpp"

namespace cluxel::perception {

template SimdKernels simdKernels<8>();

}  // namespace cluxel::perception
