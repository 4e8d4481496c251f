// SPDX-License-Identifier: Apache-2.0
// Four numbers at once, by the vector types that GCC and Clang map to any machine: the same bits as one after the other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace cluxel {

inline constexpr std::size_t kLanes = 4;
using Floats = float __attribute__((vector_size(16)));
/// A comparison of Floats gives -1 in the lanes where it holds, and else 0.
using Numbers = std::int32_t __attribute__((vector_size(16)));

inline Floats loadFloats(const float* from) {
  Floats four;
  std::memcpy(&four, from, sizeof four);
  return four;
}

inline void storeFloats(const Floats& four, float* to) { std::memcpy(to, &four, sizeof four); }

inline Floats lesserOf(const Floats& a, const Floats& b) { return a < b ? a : b; }

/// The least of the four.
inline float leastOf(const Floats& four) {
  const Floats two = lesserOf(four, __builtin_shufflevector(four, four, 2, 3, 0, 1));
  return lesserOf(two, __builtin_shufflevector(two, two, 1, 0, 3, 2))[0];
}

}  // namespace cluxel
