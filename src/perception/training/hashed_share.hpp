// SPDX-License-Identifier: Apache-2.0
// Stateless random numbers: the same number for the same seed, round and item, on every machine and thread.
#pragma once

#include <cstdint>

namespace cluxel::perception {

/// A uniform number in [0, 1), from a SplitMix64 hash.
inline double hashedShare(std::uint64_t seed, std::uint64_t round, std::uint64_t item) {
  std::uint64_t x = seed * 0x9E3779B97F4A7C15ULL + round * 0xD1B54A32D192ED03ULL + item * 0x8CB92BA72F3D8DD7ULL;
  x = (x ^ (x >> 30U)) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ (x >> 27U)) * 0x94D049BB133111EBULL;
  return static_cast<double>((x ^ (x >> 31U)) >> 11U) * 0x1.0p-53;
}

}  // namespace cluxel::perception
