// SPDX-License-Identifier: Apache-2.0
// Slope-limited lower envelope (a grey-value distance transform), and filling by a pyramid.
#include "perception/ground_window.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "perception/vector_lanes.hpp"

namespace cluxel {
namespace {

/// Cells around that are looked at when a cell seems sunken.
constexpr int kSunkenReach = 6;
/// A sunken cell is believed when this many others close to it lie as deep: 3 m2 of a pit are one.
constexpr int kSunkenSupport = 12;
constexpr int kSupportReach = 3;

/// Heights with a margin, not a number where unknown, so that no comparison holds there: rows can be read whole.
class PaddedHeights {
 public:
  explicit PaddedHeights(const HeightWindow& window)
      : width_(static_cast<std::size_t>(window.side) + 2 * kSunkenReach + kLanes),
        height_(width_ * (static_cast<std::size_t>(window.side) + 2 * kSunkenReach), std::numeric_limits<float>::quiet_NaN()) {
    for (int y = 0; y < window.side; ++y)
      for (int x = 0; x < window.side; ++x)
        if (const std::size_t cell = window.at(x, y); window.known[cell]) height_[place(x, y)] = window.height[cell];
  }
  /// From the cell `reach` to the left.
  const float* row(int x, int y, int reach) const { return height_.data() + place(x - reach, y); }

 private:
  std::size_t place(int x, int y) const {
    return static_cast<std::size_t>(y + kSunkenReach) * width_ + static_cast<std::size_t>(x + kSunkenReach);
  }
  std::size_t width_;
  std::vector<float> height_;
};

/// What cells at most `reach` away may differ in height from one: the step and the rise over the distance. Rows are filled
/// up to whole vectors.
template <int reach>
class Allowance {
 public:
  static constexpr std::size_t kVectors = (2 * reach + kLanes) / kLanes;

  Allowance(double rise, double step_m, float beyond) {
    for (auto& row : value_) row.fill(beyond);
    for (int y = -reach; y <= reach; ++y)
      for (int x = -reach; x <= reach; ++x)
        value_[static_cast<std::size_t>(y + reach)][static_cast<std::size_t>(x + reach)] =
            static_cast<float>(step_m + rise * std::sqrt(x * x + y * y));
  }
  /// In how many cells around a known one `holds(difference, allowed)`.
  template <typename Holds>
  int count(const PaddedHeights& heights, int x, int y, float here, const Holds& holds) const {
    Numbers sum{};
    for (int v = -reach; v <= reach; ++v) {
      const float* row = heights.row(x, y + v, reach);
      const float* allowed = value_[static_cast<std::size_t>(v + reach)].data();
      for (std::size_t i = 0; i < kVectors; ++i) sum -= holds(loadFloats(row + i * kLanes) - here, loadFloats(allowed + i * kLanes));
    }
    return sum[0] + sum[1] + sum[2] + sum[3];
  }

 private:
  std::array<std::array<float, kVectors * kLanes>, 2 * reach + 1> value_;
};

/// Finds cells with few known ones close by on a level with them while many around lie above their cone.
class SunkenTest {
 public:
  SunkenTest(const HeightWindow& window, double rise, double step_m)
      : heights_(window), close_(rise, step_m, -1.0F), around_(rise, step_m, std::numeric_limits<float>::infinity()) {}
  bool operator()(int x, int y, float here) const {
    const int level = close_.count(heights_, x, y, here, [](const Floats& difference, const Floats& allowed) {
      return (difference <= allowed) & (-difference <= allowed);
    });
    if (level > kSunkenSupport) return false;   // the cell itself was counted, too
    const int above = around_.count(heights_, x, y, here,
                                    [](const Floats& difference, const Floats& allowed) { return difference > allowed; });
    return above >= 4 * level;
  }

 private:
  PaddedHeights heights_;
  Allowance<kSupportReach> close_;
  Allowance<kSunkenReach> around_;
};

/// The highest known cell at most `reach` cells away along each axis; lower than all where there is none.
std::vector<float> highestAround(const HeightWindow& window, int reach) {
  constexpr float kNone = -std::numeric_limits<float>::infinity();
  std::vector<float> height(window.size()), rows(window.size(), kNone), both(window.size(), kNone);
  for (std::size_t i = 0; i < height.size(); ++i) height[i] = window.known[i] ? window.height[i] : kNone;
  const int side = window.side;
  for (int y = 0; y < side; ++y)
    for (int shift = -reach; shift <= reach; ++shift)
      for (int x = std::max(0, -shift); x < std::min(side, side - shift); ++x)
        rows[window.at(x, y)] = std::max(rows[window.at(x, y)], height[window.at(x + shift, y)]);
  for (int y = 0; y < side; ++y)
    for (int v = std::max(0, y - reach); v <= std::min(side - 1, y + reach); ++v)
      for (int x = 0; x < side; ++x) both[window.at(x, y)] = std::max(both[window.at(x, y)], rows[window.at(x, v)]);
  return both;
}

/// One raster pass of the distance transform: lowers each cell to its four earlier neighbours plus the rise to them.
void sweep(std::vector<float>& envelope, int side, bool forward, float rise) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const float diagonal = rise * std::sqrt(2.0F);
  const auto width = static_cast<std::size_t>(side);
  std::vector<float> before(width + 2, kInfinity);   // the row before, with a cell to spare on both sides
  for (std::size_t i = 0; i < width; ++i) {
    float* row = envelope.data() + (forward ? i : width - 1 - i) * width;
    for (std::size_t x = 0; x < width; ++x) {
      const float oblique = std::min(before[x], before[x + 2]) + diagonal, straight = before[x + 1] + rise;
      row[x] = std::min(row[x], std::min(straight, oblique));
    }
    if (forward)
      for (std::size_t x = 1; x < width; ++x) row[x] = std::min(row[x], row[x - 1] + rise);
    else
      for (std::size_t x = width - 1; x-- > 0;) row[x] = std::min(row[x], row[x + 1] + rise);
    std::copy_n(row, width, before.begin() + 1);
  }
}

struct Level {
  int side = 0;
  std::vector<double> sum, weight;
  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(std::clamp(y, 0, side - 1)) * static_cast<std::size_t>(side) +
           static_cast<std::size_t>(std::clamp(x, 0, side - 1));
  }
};

Level coarser(const Level& fine) {
  Level level{(fine.side + 1) / 2, {}, {}};
  const auto size = static_cast<std::size_t>(level.side) * static_cast<std::size_t>(level.side);
  level.sum.assign(size, 0.0);
  level.weight.assign(size, 0.0);
  const auto width = static_cast<std::size_t>(fine.side);
  for (std::size_t y = 0, from = 0; y < width; ++y)
    for (std::size_t x = 0; x < width; ++x, ++from) {
      if (fine.weight[from] <= 0) continue;
      const std::size_t to = y / 2 * static_cast<std::size_t>(level.side) + x / 2;
      level.sum[to] += fine.weight[from] == 1.0 ? fine.sum[from] : fine.sum[from] / fine.weight[from];
      level.weight[to] += 1.0;
    }
  return level;
}

/// Gives cells without weight the value of the coarser level at their place.
void fillFrom(const Level& coarse, Level& fine) {
  std::vector<double> mean(coarse.sum.size());
  for (std::size_t i = 0; i < mean.size(); ++i) mean[i] = coarse.sum[i] / coarse.weight[i];
  std::size_t cell = 0;
  for (int y = 0; y < fine.side; ++y)
    for (int x = 0; x < fine.side; ++x, ++cell) {
      if (fine.weight[cell] > 0) continue;
      const int u = x / 2, v = y / 2, du = x % 2 == 0 ? -1 : 1, dv = y % 2 == 0 ? -1 : 1;
      const auto value = [&](int a, int b) { return mean[coarse.at(a, b)]; };
      fine.sum[cell] = 0.5625 * value(u, v) + 0.1875 * (value(u + du, v) + value(u, v + dv)) + 0.0625 * value(u + du, v + dv);
      fine.weight[cell] = 1.0;
    }
}

}  // namespace

void dropSunkenCells(HeightWindow& window, double cell_m, double steepest, double step_m) {
  const double rise = steepest * cell_m;
  const auto next_allowed = static_cast<float>(step_m + rise);
  const SunkenTest is_sunken(window, rise, step_m);
  const auto highest = highestAround(window, 2);
  for (int y = 0; y < window.side; ++y)
    for (int x = 0; x < window.side; ++x) {
      const std::size_t cell = window.at(x, y);
      if (!window.known[cell] || highest[cell] <= window.height[cell] + next_allowed) continue;
      if (is_sunken(x, y, window.height[cell])) window.known[cell] = 0;
    }
}

void dropRaisedCells(HeightWindow& window, double cell_m, double steepest, double step_m) {
  std::vector<float> envelope(window.size());
  for (std::size_t i = 0; i < envelope.size(); ++i)
    envelope[i] = window.known[i] ? window.height[i] : std::numeric_limits<float>::infinity();
  const auto rise = static_cast<float>(steepest * cell_m);
  sweep(envelope, window.side, true, rise);
  sweep(envelope, window.side, false, rise);
  for (std::size_t i = 0; i < envelope.size(); ++i)
    if (window.known[i] && window.height[i] > envelope[i] + static_cast<float>(step_m)) window.known[i] = 0;
}

std::vector<float> filled(const HeightWindow& window) {
  std::vector<Level> levels(1);
  levels[0].side = window.side;
  levels[0].sum.resize(window.size());
  levels[0].weight.resize(window.size());
  for (std::size_t i = 0; i < window.size(); ++i) {
    levels[0].sum[i] = window.known[i] ? window.height[i] : 0.0;
    levels[0].weight[i] = window.known[i] ? 1.0 : 0.0;
  }
  while (levels.back().side > 1) levels.push_back(coarser(levels.back()));
  for (std::size_t i = levels.size() - 1; i-- > 0;) fillFrom(levels[i + 1], levels[i]);
  std::vector<float> height(window.size());
  for (std::size_t i = 0; i < height.size(); ++i) height[i] = static_cast<float>(levels[0].sum[i]);   // of weight 1, all
  return height;
}

std::vector<float> smoothed(const std::vector<float>& height, int side, int reach) {
  const auto pass = [&](const std::vector<float>& in, std::size_t along, std::size_t across) {
    std::vector<float> out(in.size());
    for (int line = 0; line < side; ++line) {
      const std::size_t begin = static_cast<std::size_t>(line) * across;
      double sum = 0;
      for (int i = 0; i < std::min(reach, side); ++i) sum += in[begin + static_cast<std::size_t>(i) * along];
      for (int i = 0; i < side; ++i) {
        if (i + reach < side) sum += in[begin + static_cast<std::size_t>(i + reach) * along];
        if (i - reach - 1 >= 0) sum -= in[begin + static_cast<std::size_t>(i - reach - 1) * along];
        const int count = std::min(side - 1, i + reach) - std::max(0, i - reach) + 1;
        out[begin + static_cast<std::size_t>(i) * along] = static_cast<float>(sum / count);
      }
    }
    return out;
  };
  const auto width = static_cast<std::size_t>(side);
  return pass(pass(height, 1, width), width, 1);
}

}  // namespace cluxel
