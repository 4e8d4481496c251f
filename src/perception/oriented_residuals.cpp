// SPDX-License-Identifier: Apache-2.0
// Votes are linear between nodes in the sine of the elevation and in the squared cosine of the azimuth: no angle is computed.
#include "perception/oriented_residuals.hpp"

#include <algorithm>
#include <cmath>

namespace cluxel {
namespace {

/// Residuals count by their length, up to this multiple of the median: one far member must not rule the histogram.
constexpr float kLongestVote = 2.0F;
/// A support whose median residual is shorter has no extent [m].
constexpr float kShortestMedian_m = 1e-4F;
/// Horizontal anisotropy below which the main direction means less and less, so that votes spread over all azimuths.
constexpr double kClearDirection = 0.2;

/// The main horizontal direction of a support, free of sign and yaw, and how clear it is, in [0, 1].
struct MainDirection {
  float x = 1, y = 0, clearness = 0;
};

MainDirection mainDirectionOf(const MomentSum& sum) {
  const double mx = sum.x / sum.n, my = sum.y / sum.n;
  const double xx = sum.xx / sum.n - mx * mx, xy = sum.xy / sum.n - mx * my, yy = sum.yy / sum.n - my * my;
  const double spread = std::hypot(xx - yy, 2 * xy);
  if (!(xx + yy > kNoExtent_m2) || !(spread > 0)) return {};
  const double angle = 0.5 * std::atan2(2 * xy, xx - yy);
  return {static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)),
          static_cast<float>(std::min(1.0, spread / (xx + yy) / kClearDirection))};
}

/// A value between two nodes, and how much of it goes to the upper one.
struct SoftBin {
  std::size_t low;
  float share;
};

SoftBin softBin(float unit, std::size_t nodes) {
  const float place = std::clamp(unit, 0.0F, 1.0F) * static_cast<float>(nodes - 1);
  const std::size_t low = std::min(static_cast<std::size_t>(place), nodes - 2);
  return {low, place - static_cast<float>(low)};
}

/// Adds a weight at an elevation node, spread over azimuths.
void vote(std::span<float> bins, std::size_t elevation, const std::array<float, kAzimuthNodes>& azimuth, float weight) {
  if (elevation == 0) {
    bins[0] += weight;
  } else if (elevation == kElevationNodes - 1) {
    bins[kHorBins - 1] += weight;
  } else {
    for (std::size_t a = 0; a < kAzimuthNodes; ++a) bins[1 + (elevation - 1) * kAzimuthNodes + a] += weight * azimuth[a];
  }
}

std::array<float, kAzimuthNodes> azimuthShares(const Eigen::Vector3f& residual, const MainDirection& main) {
  std::array<float, kAzimuthNodes> shares;
  const float level = residual.x() * residual.x() + residual.y() * residual.y();
  const float clear = level > 0 ? main.clearness : 0.0F;
  shares.fill((1.0F - clear) / static_cast<float>(kAzimuthNodes));
  if (clear <= 0) return shares;
  const float along = residual.x() * main.x + residual.y() * main.y;
  const SoftBin bin = softBin(1.0F - along * along / level, kAzimuthNodes);
  shares[bin.low] += clear * (1.0F - bin.share);
  shares[bin.low + 1] += clear * bin.share;
  return shares;
}

void fillBins(const Support& support, const std::vector<float>& lengths, float median, std::span<float> bins) {
  const MainDirection main = mainDirectionOf(support.sum);
  float total = 0;
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    if (!(lengths[i] > 0)) continue;
    const Eigen::Vector3f& residual = support.residual[i];
    const float weight = std::min(lengths[i] / median, kLongestVote);
    const auto azimuth = azimuthShares(residual, main);
    const SoftBin elevation = softBin(0.5F * (residual.z() / lengths[i] + 1.0F), kElevationNodes);
    vote(bins, elevation.low, azimuth, weight * (1.0F - elevation.share));
    vote(bins, elevation.low + 1, azimuth, weight * elevation.share);
    total += weight;
  }
  if (total > 0)
    for (auto& bin : bins) bin /= total;
}

}  // namespace

std::vector<std::string> horColumns() {
  std::vector<std::string> names{"hor.down"};
  for (std::size_t e = 1; e + 1 < kElevationNodes; ++e)
    for (const char* azimuth : {"along", "oblique", "across"})
      names.push_back("hor.e" + std::to_string(e) + "_" + azimuth);
  names.insert(names.end(), {"hor.up", "hor.to_plane", "hor.to_line", "hor.to_level", "hor.off_plane", "hor.mean_up", "hor.mean_side"});
  return names;
}

void fillHor(const Support& support, const EigenShape& shape, HorScratch& scratch, std::span<float> out) {
  std::fill(out.begin(), out.end(), 0.0F);
  if (support.residual.empty()) return;
  scratch.length.clear();
  for (const auto& residual : support.residual) scratch.length.push_back(residual.norm());
  scratch.sorted = scratch.length;
  const auto middle = scratch.sorted.begin() + static_cast<std::ptrdiff_t>(scratch.sorted.size() / 2);
  std::nth_element(scratch.sorted.begin(), middle, scratch.sorted.end());
  const float median = *middle;
  if (!(median > kShortestMedian_m)) return;
  fillBins(support, scratch.length, median, out.subspan(0, kHorBins));
  const MomentSum& sum = support.sum;
  const Eigen::Vector3d mean = Eigen::Vector3d(sum.x, sum.y, sum.z) / sum.n;
  const std::array<double, kHorScalars> scalars{
      shape.length(2),                                                            // rms residual to the best plane
      std::sqrt(shape.value[1] + shape.value[2]),                                 // to the best line
      std::sqrt(std::max(0.0, sum.zz / sum.n - mean.z() * mean.z())),             // to the best horizontal plane
      std::abs(mean.dot(shape.normal)),                                           // the centre's own to the plane
      mean.z(), std::hypot(mean.x(), mean.y())};                                  // where the support lies from the centre
  for (std::size_t i = 0; i < kHorScalars; ++i) out[kHorBins + i] = static_cast<float>(scalars[i] / median);
}

}  // namespace cluxel
