// SPDX-License-Identifier: Apache-2.0
// Slope-limited lower envelope (a grey-value distance transform), and filling by a pyramid.
#include "perception/features/ground_window.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "perception/simd_vector.hpp"

namespace cluxel::perception {
namespace {

/// Radius of the neighbourhood of the test for sunken cells [cells].
constexpr int kSunkenReach = 6;
/// A low cell is accepted when more than this many cells close to it are as low: a pit of 3 m2 is real.
constexpr int kSunkenSupport = 12;
constexpr int kSupportReach = 3;

/// Heights with a margin of unknown cells, so that whole rows can be read.
class PaddedHeights {
 public:
  explicit PaddedHeights(const HeightWindow& window)
      : width_(static_cast<std::size_t>(window.side) + 2 * kSunkenReach + kLanes),
        height_(width_ * (static_cast<std::size_t>(window.side) + 2 * kSunkenReach), HeightWindow::kUnknown) {
    for (int y = 0; y < window.side; ++y)
      std::copy_n(window.height.data() + window.at(0, y), window.side, height_.data() + place(0, y));
  }
  /// The row from the cell `reach` to the left.
  const float* row(int x, int y, int reach) const { return height_.data() + place(x - reach, y); }

 private:
  std::size_t place(int x, int y) const {
    return static_cast<std::size_t>(y + kSunkenReach) * width_ + static_cast<std::size_t>(x + kSunkenReach);
  }
  std::size_t width_;
  std::vector<float> height_;
};

/// The allowed height difference to cells at most `reach` away: the step plus the rise over the distance. Rows are
/// padded to whole SIMD vectors.
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
  /// The number of cells around a known cell for which `holds(difference, allowed)` is true.
  template <typename Holds>
  int count(const PaddedHeights& heights, int x, int y, float here, const Holds& holds) const {
    Numbers sum{};
    for (int v = -reach; v <= reach; ++v) {
      const float* row = heights.row(x, y + v, reach);
      const float* allowed = value_[static_cast<std::size_t>(v + reach)].data();
      for (std::size_t i = 0; i < kVectors; ++i)
        sum -= holds(loadFloats(row + i * kLanes) - here, loadFloats(allowed + i * kLanes));
    }
    return sum[0] + sum[1] + sum[2] + sum[3];
  }

 private:
  std::array<std::array<float, kVectors * kLanes>, 2 * reach + 1> value_;
};

/// Finds cells with few neighbours at their level while many lie above their slope cone.
class SunkenTest {
 public:
  SunkenTest(const HeightWindow& window, double rise, double step_m)
      : heights_(window), close_(rise, step_m, -1.0F), around_(rise, step_m, std::numeric_limits<float>::infinity()) {}
  bool operator()(int x, int y, float here) const {
    const int level = close_.count(heights_, x, y, here, [](const Floats& difference, const Floats& allowed) {
      return (difference <= allowed) & (-difference <= allowed);
    });
    if (level > kSunkenSupport) return false;  // the count includes the cell itself
    const int above = around_.count(
        heights_, x, y, here, [](const Floats& difference, const Floats& allowed) { return difference > allowed; });
    return above >= 4 * level;
  }

 private:
  PaddedHeights heights_;
  Allowance<kSupportReach> close_;
  Allowance<kSunkenReach> around_;
};

/// Element-wise maximum with another row.
void raiseTo(const float* row, std::size_t count, float* values) {
  for (std::size_t i = 0; i < count; ++i) values[i] = std::max(values[i], row[i]);
}

/// The highest known cell at most `reach` cells away along each axis; -infinity where there is none.
std::vector<float> highestAround(const HeightWindow& window, int reach) {
  constexpr float kNone = -std::numeric_limits<float>::infinity();
  const auto side = static_cast<std::size_t>(window.side), margin = static_cast<std::size_t>(reach);
  std::vector<float> padded(side + 2 * margin, kNone), rows(window.size(), kNone), both(window.size(), kNone);
  for (std::size_t y = 0; y < side; ++y) {
    for (std::size_t x = 0; x < side; ++x) {
      const float height = window.height[y * side + x];
      padded[x + margin] = height > kNone ? height : kNone;
    }
    for (std::size_t shift = 0; shift <= 2 * margin; ++shift)
      raiseTo(padded.data() + shift, side, rows.data() + y * side);
  }
  for (std::size_t y = 0; y < side; ++y)
    for (std::size_t v = y < margin ? 0 : y - margin; v <= std::min(side - 1, y + margin); ++v)
      raiseTo(rows.data() + v * side, side, both.data() + y * side);
  return both;
}

/// One raster pass of the distance transform: lowers each cell to its four earlier neighbours plus the rise to them.
void sweep(std::vector<float>& envelope, int side, bool forward, float rise) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const float diagonal = rise * std::sqrt(2.0F);
  const auto width = static_cast<std::size_t>(side);
  std::vector<float> before(width + 2, kInfinity);  // the row before, with one cell of padding on both sides
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

using Doubles = double __attribute__((vector_size(16)));

/// One level of the pyramid: mean heights of square cells, NaN where unknown. An odd side is padded to an even one.
struct PyramidLevel {
  std::size_t side, width;
  std::vector<double> mean;

  explicit PyramidLevel(std::size_t cells_along_edge)
      : side(cells_along_edge),
        width((side + 1) / 2 * 2),
        mean(width * width, std::numeric_limits<double>::quiet_NaN()) {}
  double* row(std::size_t y) { return mean.data() + y * width; }
  const double* row(std::size_t y) const { return mean.data() + y * width; }
};

/// Means of the known cells in blocks of 2 x 2.
PyramidLevel coarser(const PyramidLevel& fine) {
  PyramidLevel level((fine.side + 1) / 2);
  for (std::size_t v = 0; v < level.side; ++v) {
    const double *upper = fine.row(2 * v), *lower = fine.row(2 * v + 1);
    for (std::size_t u = 0; u < level.side; ++u) {
      double sum = 0, known = 0;
      for (const double mean : {upper[2 * u], upper[2 * u + 1], lower[2 * u], lower[2 * u + 1]}) {
        sum += std::isnan(mean) ? 0.0 : mean;
        known += std::isnan(mean) ? 0.0 : 1.0;
      }
      level.row(v)[u] = sum / known;  // 0 / 0 gives NaN: unknown
    }
  }
  return level;
}

/// A row of a level with the outermost cells repeated on both sides.
void copyPadded(const PyramidLevel& level, std::size_t y, std::vector<double>& row) {
  row.resize(level.side + 2);
  std::copy_n(level.row(y), level.side, row.begin() + 1);
  row.front() = row[1];
  row.back() = row[level.side];
}

/// Fills unknown cells by interpolating the coarser level; two cells of a row share one coarse cell.
void fillFrom(const PyramidLevel& coarse, PyramidLevel& fine) {
  std::vector<double> near, far;
  for (std::size_t y = 0; y < fine.side; ++y) {
    const std::size_t v = y / 2;
    copyPadded(coarse, v, near);
    copyPadded(coarse, y % 2 == 0 ? (v == 0 ? 0 : v - 1) : std::min(v + 1, coarse.side - 1), far);
    double* row = fine.row(y);
    for (std::size_t u = 0; u < coarse.side; ++u) {
      const Doubles here{near[u + 1], near[u + 1]}, beside{near[u], near[u + 2]}, beyond{far[u + 1], far[u + 1]},
          oblique{far[u], far[u + 2]};
      const Doubles value = 0.5625 * here + 0.1875 * (beside + beyond) + 0.0625 * oblique;
      for (std::size_t i = 0; i < 2; ++i) row[2 * u + i] = std::isnan(row[2 * u + i]) ? value[i] : row[2 * u + i];
    }
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
      if (!(highest[cell] > window.height[cell] + next_allowed)) continue;  // false for unknown cells (NaN)
      if (is_sunken(x, y, window.height[cell])) window.height[cell] = HeightWindow::kUnknown;
    }
}

void dropRaisedCells(HeightWindow& window, double cell_m, double steepest, double step_m) {
  std::vector<float> envelope(window.size());
  for (std::size_t i = 0; i < envelope.size(); ++i)
    envelope[i] = window.knows(i) ? window.height[i] : std::numeric_limits<float>::infinity();
  const auto rise = static_cast<float>(steepest * cell_m);
  sweep(envelope, window.side, true, rise);
  sweep(envelope, window.side, false, rise);
  for (std::size_t i = 0; i < envelope.size(); ++i)
    window.height[i] =
        window.height[i] > envelope[i] + static_cast<float>(step_m) ? HeightWindow::kUnknown : window.height[i];
}

std::vector<float> filled(const HeightWindow& window) {
  const auto side = static_cast<std::size_t>(window.side);
  std::vector<PyramidLevel> levels{PyramidLevel(side)};
  for (std::size_t y = 0; y < side; ++y) std::copy_n(window.height.data() + y * side, side, levels[0].row(y));
  while (levels.back().side > 1) levels.push_back(coarser(levels.back()));
  for (std::size_t i = levels.size() - 1; i-- > 0;) fillFrom(levels[i + 1], levels[i]);
  std::vector<float> height(window.size());
  for (std::size_t y = 0; y < side; ++y)
    std::transform(levels[0].row(y), levels[0].row(y) + side, height.data() + y * side,
                   [](double mean) { return static_cast<float>(mean); });
  return height;
}

std::vector<float> smoothed(const std::vector<float>& height, int side, int reach) {
  const auto pass = [&](const std::vector<float>& in, std::size_t along, std::size_t across) {
    std::vector<float> out(in.size());
    for (int line = 0; line < side; line += 2) {  // two lines at a time: their divisions are independent and overlap
      const std::size_t one = static_cast<std::size_t>(line) * across,
                        other = static_cast<std::size_t>(std::min(line + 1, side - 1)) * across;
      const auto both = [&](int i) {
        return Doubles{in[one + static_cast<std::size_t>(i) * along], in[other + static_cast<std::size_t>(i) * along]};
      };
      Doubles sum{};
      for (int i = 0; i < std::min(reach, side); ++i) sum += both(i);
      for (int i = 0; i < side; ++i) {
        if (i + reach < side) sum += both(i + reach);
        if (i - reach - 1 >= 0) sum -= both(i - reach - 1);
        const Doubles mean = sum / static_cast<double>(std::min(side - 1, i + reach) - std::max(0, i - reach) + 1);
        out[one + static_cast<std::size_t>(i) * along] = static_cast<float>(mean[0]);
        out[other + static_cast<std::size_t>(i) * along] = static_cast<float>(mean[1]);
      }
    }
    return out;
  };
  const auto width = static_cast<std::size_t>(side);
  return pass(pass(height, 1, width), width, 1);
}

}  // namespace cluxel::perception
