// SPDX-License-Identifier: Apache-2.0
// How far each threshold of the rules may move before some test of a run turns out otherwise, tile by tile.
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <vector>

#include "perception/segments/scene.hpp"
#include "rules/language/rule_set.hpp"

namespace cluxel::rules {

/// The nearest numbers on both sides of a threshold that were compared with it. SI units.
struct ThresholdMargin {
  std::uint32_t threshold = 0;  ///< its number, from 1
  double below = -std::numeric_limits<double>::infinity(), above = std::numeric_limits<double>::infinity();

  /// Whether this value of the threshold gives all tests the outcomes that they had.
  bool allows(const PlainThreshold& now) const {
    return now.is_met_by_equal ? below < now.value && now.value <= above : below <= now.value && now.value < above;
  }
  /// Keeps what both allow; of the same threshold.
  void narrow(const ThresholdMargin& other);
  bool operator==(const ThresholdMargin&) const = default;
};

/// What a tile's decisions follow from in the rules, beside their structure. Both are ascending by number.
struct TileMargin {
  std::vector<ThresholdMargin> thresholds;  ///< those that were compared with something
  std::vector<std::uint32_t> constants;     ///< those that something was computed from

  bool operator==(const TileMargin&) const = default;
};
using TileMargins = std::map<perception::TileKey, TileMargin>;

/// What to note when `value` is compared with `ratio` times `other`: the ratio has the same outcome on this side of the
/// number; there are two numbers when rounding does not tell the side. None when the ratio makes no difference.
std::vector<double> quotientsToNote(double value, double other, double ratio);

/// Records the tests of a run. A test belongs to a tile of one of the primitives that it measures. While all of a
/// tile's margins allow the thresholds of other rules of the same structure, a run with these rules makes no test of
/// the tile turn out otherwise: what differs begins in the tiles where this does not hold. 16 bytes a tile and
/// threshold.
class ThresholdMargins {
 public:
  /// `rules` must outlive it.
  ThresholdMargins(const perception::Scene& scene, const RuleSet& rules);

  /// `value` of a thing that `primitive` is a part of was compared with the threshold of this number. Thread-safe.
  void note(perception::PrimitiveIndex primitive, std::uint32_t threshold, double value) {
    noteAt(tile_of_[primitive], threshold, value);
  }

  /// The same of a thing without primitives.
  void noteEverywhere(std::uint32_t threshold, double value) {
    for (std::size_t tile = 0; tile < tiles_.size(); ++tile) noteAt(tile, threshold, value);
  }

  /// Every other value of the threshold may make a difference to the primitive.
  void noteFixed(perception::PrimitiveIndex primitive, std::uint32_t threshold);
  /// Something about the primitive was computed from the constant of this number. Thread-safe.
  void noteUse(perception::PrimitiveIndex primitive, std::uint32_t constant) {
    const std::size_t place = tile_of_[primitive] * words_ + (constant - 1) / kBits;
    const std::uint64_t bit = std::uint64_t{1} << (constant - 1) % kBits;
    if ((used_[place].load(std::memory_order_relaxed) & bit) == 0)
      used_[place].fetch_or(bit, std::memory_order_relaxed);
  }

  TileMargins found() const;

 private:
  using Bounds = std::unique_ptr<std::atomic<double>[]>;
  static constexpr std::size_t kBits = 64;

  void noteAt(std::size_t tile, std::uint32_t number, double value) {
    const std::size_t place = tile * count_ + number - 1;
    const PlainThreshold& threshold = thresholds_[number - 1];
    if (value > threshold.value || (value == threshold.value && threshold.is_met_by_equal))
      lower(above_[place], value);
    else if (value <= threshold.value)  // neither holds for what is no number
      raise(below_[place], value);
  }
  static void raise(std::atomic<double>& bound, double value) {
    double now = bound.load(std::memory_order_relaxed);
    while (value > now && !bound.compare_exchange_weak(now, value, std::memory_order_relaxed)) {
    }
  }
  static void lower(std::atomic<double>& bound, double value) {
    double now = bound.load(std::memory_order_relaxed);
    while (value < now && !bound.compare_exchange_weak(now, value, std::memory_order_relaxed)) {
    }
  }

  const std::vector<PlainThreshold>& thresholds_;
  std::size_t count_, constants_, words_;
  std::vector<perception::TileKey> tiles_;              ///< ascending
  std::vector<std::uint32_t> tile_of_;                  ///< by primitive: the tile of its first cluxel
  Bounds below_, above_;                                ///< by tile and threshold
  std::unique_ptr<std::atomic<std::uint64_t>[]> used_;  ///< by tile, a bit for each constant
};

/// The tiles in which `rules`, of the structure of those of the run, may make something turn out otherwise. `constants`
/// are those of the run.
perception::TileSet tilesBeyond(const TileMargins& margins, const std::vector<std::uint64_t>& constants,
                                const RuleSet& rules);

}  // namespace cluxel::rules
