// SPDX-License-Identifier: Apache-2.0
// Four floats in a SIMD vector, by the vector extensions of GCC and Clang, which work on every machine. Results are
// bit-identical to scalar code.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

namespace cluxel::perception {

inline constexpr std::size_t kLanes = 4;
using Floats = float __attribute__((vector_size(16)));
/// The result of comparing Floats: -1 in lanes where the comparison holds, else 0.
using Numbers = std::int32_t __attribute__((vector_size(16)));

inline Floats loadFloats(const float* from) {
  Floats four;
  std::memcpy(&four, from, sizeof four);
  return four;
}

inline void storeFloats(const Floats& four, float* to) {
  std::memcpy(to, &four, sizeof four);
}

/// Correctly rounded, as std::sqrt is.
inline Floats squareRoots(const Floats& four) {
#ifdef __SSE2__
  return static_cast<Floats>(_mm_sqrt_ps(static_cast<__m128>(four)));
#else
  return {std::sqrt(four[0]), std::sqrt(four[1]), std::sqrt(four[2]), std::sqrt(four[3])};
#endif
}

/// Bit i: whether a comparison holds in lane i.
inline unsigned lanesThatHold(const Numbers& held) {
#ifdef __SSE2__
  return static_cast<unsigned>(_mm_movemask_ps(reinterpret_cast<__m128>(held)));
#else
  return (held[0] & 1U) | (held[1] & 2U) | (held[2] & 4U) | (held[3] & 8U);
#endif
}

/// The bits of the first `count` lanes.
inline unsigned firstLanes(std::uint32_t count) {
  return count < kLanes ? (1U << count) - 1U : 0xfU;
}

/// Whether a comparison holds in all lanes.
inline bool allHold(const Numbers& held) {
  return lanesThatHold(held) == 0xfU;
}

inline Floats minimum(const Floats& a, const Floats& b) {
  return a < b ? a : b;
}

/// The minimum of the four lanes.
inline float minOf(const Floats& four) {
  const Floats two = minimum(four, __builtin_shufflevector(four, four, 2, 3, 0, 1));
  return minimum(two, __builtin_shufflevector(two, two, 1, 0, 3, 2))[0];
}

}  // namespace cluxel::perception
