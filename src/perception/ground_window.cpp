// SPDX-License-Identifier: Apache-2.0
// Slope-limited lower envelope (a grey-value distance transform), and filling by a pyramid.
#include "perception/ground_window.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace cluxel {
namespace {

/// Cells around that are looked at when a cell seems sunken.
constexpr int kSunkenReach = 6;
/// A sunken cell is believed when this many others close to it lie as deep: 3 m2 of a pit are one.
constexpr int kSunkenSupport = 12;
constexpr int kSupportReach = 3;

/// What a cell some cells away may differ in height: the step and the rise over the distance.
class Allowance {
 public:
  Allowance(double rise, double step_m) {
    for (int y = 0; y <= kSunkenReach; ++y)
      for (int x = 0; x <= kSunkenReach; ++x) value_[index(x, y)] = static_cast<float>(step_m + rise * std::sqrt(x * x + y * y));
  }
  float operator()(int x, int y) const { return value_[index(std::abs(x), std::abs(y))]; }

 private:
  static std::size_t index(int x, int y) { return static_cast<std::size_t>(y * (kSunkenReach + 1) + x); }
  std::array<float, (kSunkenReach + 1) * (kSunkenReach + 1)> value_{};
};

/// Whether few known cells close by lie on a level with the cell while many around lie above its cone.
bool isSunken(const HeightWindow& window, int x, int y, const Allowance& allowance) {
  const float here = window.height[window.at(x, y)];
  int level = 0, above = 0;
  const auto visit = [&](int reach, const auto& look) {
    for (int v = std::max(0, y - reach); v <= std::min(window.side - 1, y + reach); ++v)
      for (int u = std::max(0, x - reach); u <= std::min(window.side - 1, x + reach); ++u)
        if (window.known[window.at(u, v)]) look(window.height[window.at(u, v)] - here, allowance(u - x, v - y));
  };
  visit(kSupportReach, [&](float difference, float allowed) { level += std::abs(difference) <= allowed ? 1 : 0; });
  if (level > kSunkenSupport) return false;   // the cell itself was counted, too
  visit(kSunkenReach, [&](float difference, float allowed) { above += difference > allowed ? 1 : 0; });
  return above >= 4 * level;
}

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
  std::size_t cell = 0;
  for (int y = 0; y < fine.side; ++y)
    for (int x = 0; x < fine.side; ++x, ++cell) {
      if (fine.weight[cell] > 0) continue;
      const int u = x / 2, v = y / 2, du = x % 2 == 0 ? -1 : 1, dv = y % 2 == 0 ? -1 : 1;
      const auto value = [&](int a, int b) { return coarse.sum[coarse.at(a, b)] / coarse.weight[coarse.at(a, b)]; };
      fine.sum[cell] = 0.5625 * value(u, v) + 0.1875 * (value(u + du, v) + value(u, v + dv)) + 0.0625 * value(u + du, v + dv);
      fine.weight[cell] = 1.0;
    }
}

}  // namespace

void dropSunkenCells(HeightWindow& window, double cell_m, double steepest, double step_m) {
  const Allowance allowance(steepest * cell_m, step_m);
  const auto highest = highestAround(window, 2);
  std::vector<std::size_t> sunken;
  for (int y = 0; y < window.side; ++y)
    for (int x = 0; x < window.side; ++x) {
      const std::size_t cell = window.at(x, y);
      if (!window.known[cell] || highest[cell] <= window.height[cell] + allowance(1, 0)) continue;
      if (isSunken(window, x, y, allowance)) sunken.push_back(cell);
    }
  for (const auto cell : sunken) window.known[cell] = 0;
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
  for (std::size_t i = 0; i < height.size(); ++i) height[i] = static_cast<float>(levels[0].sum[i] / levels[0].weight[i]);
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
