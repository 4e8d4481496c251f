// SPDX-License-Identifier: Apache-2.0
// Random numbers of the campus: SplitMix64 streams keyed by purpose, identical with every standard library.
#pragma once

#include <cstdint>
#include <initializer_list>

#include "base/mixed_bits.hpp"

namespace cluxel::simulation {

/// One stream of random numbers.
class CampusRandom {
 public:
  /// Streams with different keys are unrelated; the same keys give the same stream.
  CampusRandom(std::initializer_list<std::uint64_t> keys) {
    for (const std::uint64_t key : keys) state_ = mixedBits(state_ + kSplitMixStep + mixedBits(key + 1));
  }
  std::uint64_t next() { return mixedBits(state_ += kSplitMixStep); }
  /// In [0, 1).
  double uniform() { return uniformShare(next()); }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// In [0, count).
  int below(int count) { return static_cast<int>(uniform() * count); }
  bool chance(double probability) { return uniform() < probability; }
  /// Mean 0, deviation 1: the sum of twelve uniform numbers, which needs no library function; within +-6.
  double normal() {
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += uniform();
    return sum;
  }

 private:
  std::uint64_t state_ = 0;
};

/// The purpose of a stream: the first key after the seed.
enum class RandomUse : std::uint64_t {
  Terrain,
  Ground,
  Building,
  Tree,
  Shrub,
  Furniture,
  Car,
  SmallObject,
  Placement,
  Stop,
  Ray,
  Drift,
  Visit,
  District,
  Occluder
};

inline CampusRandom streamOf(std::uint64_t seed, RandomUse use, std::uint64_t number = 0) {
  return CampusRandom{seed, static_cast<std::uint64_t>(use), number};
}

}  // namespace cluxel::simulation
