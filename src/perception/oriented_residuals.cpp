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
  const double twice = (xx - yy) / spread;   // cosine of twice the angle
  const double side = xy < 0 ? -1.0 : 1.0;
  return {static_cast<float>(std::sqrt(0.5 * (1 + twice))), static_cast<float>(side * std::sqrt(std::max(0.0, 0.5 * (1 - twice)))),
          static_cast<float>(std::min(1.0, spread / (xx + yy) / kClearDirection))};
}

/// Where each residual lies between the nodes, and its weight; no branches, so that the compiler makes vectors of it.
void placeVotes(const Residuals& residual, const MainDirection& main, float median, HorScratch& scratch) {
  constexpr float kTiny = 1e-12F;
  const std::size_t size = residual.size();
  scratch.weight.resize(size);
  scratch.elevation.resize(size);
  scratch.azimuth.resize(size);
  const float* x = residual.x.data();
  const float* y = residual.y.data();
  const float* z = residual.z.data();
  for (std::size_t i = 0; i < size; ++i) {
    const float length = scratch.length[i];
    const float along = x[i] * main.x + y[i] * main.y;
    const float across = x[i] * main.y - y[i] * main.x;
    scratch.weight[i] = std::min(length / median, kLongestVote);
    scratch.elevation[i] = (z[i] / (length + kTiny) + 1.0F) * (0.5F * (kElevationNodes - 1));
    scratch.azimuth[i] = across * across / (along * along + across * across + kTiny) * (kAzimuthNodes - 1);
  }
}

using Votes = std::array<std::array<float, kAzimuthNodes>, kElevationNodes>;

/// Each residual's weight goes to the four nodes around it. Two sets of nodes take turns: a node is seldom waited for.
Votes castVotes(const HorScratch& scratch) {
  std::array<Votes, 2> sets{};
  for (std::size_t i = 0; i < scratch.weight.size(); ++i) {
    const auto e = std::min(static_cast<int>(scratch.elevation[i]), static_cast<int>(kElevationNodes) - 2);
    const auto a = std::min(static_cast<int>(scratch.azimuth[i]), static_cast<int>(kAzimuthNodes) - 2);
    const float up = scratch.elevation[i] - static_cast<float>(e), on = scratch.azimuth[i] - static_cast<float>(a);
    const float high = scratch.weight[i] * up, low = scratch.weight[i] - high;
    Votes& votes = sets[i % 2];
    auto* row = votes[static_cast<std::size_t>(e)].data() + a;
    auto* next = votes[static_cast<std::size_t>(e) + 1].data() + a;
    row[0] += low * (1.0F - on);
    row[1] += low * on;
    next[0] += high * (1.0F - on);
    next[1] += high * on;
  }
  for (std::size_t e = 0; e < kElevationNodes; ++e)
    for (std::size_t a = 0; a < kAzimuthNodes; ++a) sets[0][e][a] += sets[1][e][a];
  return sets[0];
}

/// Votes to bins: the poles lose their azimuth, and azimuths even out where there is no clear direction.
void fillBins(const Votes& votes, float clearness, std::span<float> bins) {
  float total = 0;
  std::array<float, kElevationNodes> level{};
  for (std::size_t e = 0; e < kElevationNodes; ++e) {
    for (const float value : votes[e]) level[e] += value;
    total += level[e];
  }
  if (!(total > 0)) return;
  bins[0] = level.front() / total;
  bins[kHorBins - 1] = level.back() / total;
  for (std::size_t e = 1; e + 1 < kElevationNodes; ++e)
    for (std::size_t a = 0; a < kAzimuthNodes; ++a)
      bins[1 + (e - 1) * kAzimuthNodes + a] =
          (clearness * votes[e][a] + (1.0F - clearness) * level[e] / static_cast<float>(kAzimuthNodes)) / total;
}

/// The value that would stand in the middle of the sorted values: found in its bucket, so that few are sorted.
float middleOf(const std::vector<float>& values, std::vector<float>& scratch) {
  constexpr std::size_t kBuckets = 32;
  const float largest = *std::max_element(values.begin(), values.end());
  if (!(largest > kShortestMedian_m)) return 0;
  const float scale = (static_cast<float>(kBuckets) - 0.5F) / largest;
  const auto bucketOf = [scale](float value) { return static_cast<std::size_t>(static_cast<int>(value * scale)); };
  std::array<std::uint32_t, kBuckets> count{};
  for (const float value : values) ++count[bucketOf(value)];
  std::size_t before = 0, bucket = 0;
  const std::size_t middle = values.size() / 2;
  while (before + count[bucket] <= middle) before += count[bucket++];
  scratch.clear();
  for (const float value : values)
    if (bucketOf(value) == bucket) scratch.push_back(value);
  const auto place = scratch.begin() + static_cast<std::ptrdiff_t>(middle - before);
  std::nth_element(scratch.begin(), place, scratch.end());
  return *place;
}

/// Fills scratch.length; returns the median.
float medianLength(const Residuals& residual, HorScratch& scratch) {
  scratch.length.resize(residual.size());
  for (std::size_t i = 0; i < residual.size(); ++i)
    scratch.length[i] = std::sqrt(residual.x[i] * residual.x[i] + residual.y[i] * residual.y[i] + residual.z[i] * residual.z[i]);
  return middleOf(scratch.length, scratch.bucket);
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
  const float median = medianLength(support.residual, scratch);
  if (!(median > kShortestMedian_m)) return;
  const MainDirection main = mainDirectionOf(support.sum);
  placeVotes(support.residual, main, median, scratch);
  fillBins(castVotes(scratch), main.clearness, out.subspan(0, kHorBins));
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
