// SPDX-License-Identifier: Apache-2.0
// Pseudo-random bits as a function of numbers, for samples that do not depend on an order (SplitMix64; Steele, Lea,
// Flood 2014).
#pragma once

#include <cstdint>

namespace cluxel {

/// The step between the states of a SplitMix64 stream.
inline constexpr std::uint64_t kSplitMixStep = 0x9e3779b97f4a7c15ULL;

/// A bijection that mixes all bits: the finaliser of SplitMix64.
constexpr std::uint64_t mixedBits(std::uint64_t bits) {
  bits = (bits ^ (bits >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  bits = (bits ^ (bits >> 27U)) * 0x94d049bb133111ebULL;
  return bits ^ (bits >> 31U);
}

/// The leading 53 bits as a number in [0, 1).
constexpr double uniformShare(std::uint64_t bits) {
  return static_cast<double>(bits >> 11U) * 0x1.0p-53;
}

/// A number in [0, 1) that three keys determine.
constexpr double hashedShare(std::uint64_t seed, std::uint64_t round, std::uint64_t item) {
  return uniformShare(mixedBits(seed * kSplitMixStep + round * 0xD1B54A32D192ED03ULL + item * 0x8CB92BA72F3D8DD7ULL));
}

}  // namespace cluxel
