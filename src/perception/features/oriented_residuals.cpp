// SPDX-License-Identifier: Apache-2.0
// Votes are interpolated linearly in the sine of the elevation and in the squared cosine of the azimuth, which avoids
// trigonometric functions.
#include "perception/features/oriented_residuals.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "perception/crf/transposed_rows.hpp"

namespace cluxel::perception {
namespace {

/// A vote's weight is the residual's length, clamped to this multiple of the median, so that no distant member
/// dominates.
constexpr float kMaxVoteLength = 2.0F;
/// A support with a shorter median residual counts as a single point [m].
constexpr float kShortestMedian_m = 1e-4F;
/// Below this horizontal anisotropy the main direction becomes unreliable, and votes are spread over all azimuths.
constexpr double kClearDirection = 0.2;

/// The main horizontal direction of a support (without sign) and its reliability in [0, 1].
struct MainDirection {
  float x = 1, y = 0, clearness = 0;
};

MainDirection mainDirectionOf(const MomentSum& sum) {
  const double mx = sum.x / sum.n, my = sum.y / sum.n;
  const double xx = sum.xx / sum.n - mx * mx, xy = sum.xy / sum.n - mx * my, yy = sum.yy / sum.n - my * my;
  const double spread = std::hypot(xx - yy, 2 * xy);
  if (!(xx + yy > kNoExtent_m2) || !(spread > 0)) return {};
  const double twice = (xx - yy) / spread;  // cosine of twice the angle
  const double side = xy < 0 ? -1.0 : 1.0;
  return {static_cast<float>(std::sqrt(0.5 * (1 + twice))),
          static_cast<float>(side * std::sqrt(std::max(0.0, 0.5 * (1 - twice)))),
          static_cast<float>(std::min(1.0, spread / (xx + yy) / kClearDirection))};
}

/// Votes at the nodes of one elevation: one lane per azimuth; the last lane is unused.
using ElevationVotes = Floats;
static_assert(kAzimuthNodes < kLanes);
using Votes = std::array<ElevationVotes, kElevationNodes>;

/// For four residuals: the index of the elevation node below each, the weights at it and at the next one, and the
/// weights of the azimuths.
struct FourVotes {
  std::array<std::int32_t, kLanes> elevation;
  std::array<float, kLanes> low, high;
  std::array<Floats, kLanes> azimuth;
};

/// The integer part of values in [0, max + 1].
Numbers wholeOf(const Floats& values, std::int32_t max) {
  const Numbers whole = __builtin_convertvector(values, Numbers), last = Numbers{} + max;
  return whole < last ? whole : last;
}

FourVotes votesOf(const Floats& x, const Floats& y, const Floats& z, const Floats& length, const MainDirection& main,
                  float median) {
  static_assert(kAzimuthNodes == 3, "the lower of the two azimuths around a residual is the first or the second");
  constexpr float kTiny = 1e-12F;
  const Floats along = x * main.x + y * main.y, across = x * main.y - y * main.x, zero{};
  const Floats weight = minimum(length / median, Floats{} + kMaxVoteLength);
  const Floats elevation = (z / (length + kTiny) + 1.0F) * (0.5F * (kElevationNodes - 1));
  const Floats azimuth =
      across * across / (along * along + across * across + kTiny) * static_cast<float>(kAzimuthNodes - 1);
  const Numbers e = wholeOf(elevation, kElevationNodes - 2), a = wholeOf(azimuth, kAzimuthNodes - 2);
  const Floats up = elevation - __builtin_convertvector(e, Floats), on = azimuth - __builtin_convertvector(a, Floats);
  const Floats rest = 1.0F - on, high = weight * up;
  const Numbers is_first = a == 0;
  FourVotes votes;
  std::memcpy(votes.elevation.data(), &e, sizeof e);
  storeFloats(weight - high, votes.low.data());
  storeFloats(high, votes.high.data());
  votes.azimuth = transposed(
      {is_first ? rest : zero, is_first ? on : rest, is_first ? zero : on, zero});  // one vector per residual
  return votes;
}

/// Adds each residual's weight to the four nodes around it. Two alternating sets of nodes shorten dependency chains.
Votes castVotes(const Residuals& residual, const MainDirection& main, float median, const HorScratch& scratch) {
  Votes even, odd;
  for (std::size_t e = 0; e < kElevationNodes; ++e) even[e] = odd[e] = ElevationVotes{};
  const auto add = [](const FourVotes& four, std::size_t i, Votes& votes) {
    ElevationVotes* level = votes.data() + four.elevation[i];
    level[0] += four.low[i] * four.azimuth[i];
    level[1] += four.high[i] * four.azimuth[i];
  };
  for (std::size_t first = 0; first < residual.size(); first += kLanes) {
    const auto at = [first](const std::vector<float>& values) { return loadFloats(values.data() + first); };
    const FourVotes four = votesOf(at(residual.x), at(residual.y), at(residual.z), at(scratch.length), main, median);
    const std::size_t some = std::min(kLanes, residual.size() - first);
    for (std::size_t i = 0; i < some; i += 2) add(four, i, even);
    for (std::size_t i = 1; i < some; i += 2) add(four, i, odd);
  }
  for (std::size_t e = 0; e < kElevationNodes; ++e) even[e] += odd[e];
  return even;
}

/// Votes to bins: the poles have no azimuth, and azimuths are averaged where the main direction is unreliable.
void fillBins(const Votes& votes, float clearness, std::span<float> bins) {
  float total = 0;
  std::array<float, kElevationNodes> level{};
  for (std::size_t e = 0; e < kElevationNodes; ++e) {
    for (std::size_t a = 0; a < kAzimuthNodes; ++a) level[e] += votes[e][a];
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

/// Fills scratch.length; returns the largest.
float fillLengths(const Residuals& residual, HorScratch& scratch) {
  if (scratch.length.size() < residual.x.size()) scratch.length.resize(residual.x.size());
  Floats longest{};
  for (std::size_t i = 0; i < residual.size(); i += kLanes) {
    const Floats x = loadFloats(residual.x.data() + i), y = loadFloats(residual.y.data() + i),
                 z = loadFloats(residual.z.data() + i);
    const Floats length = squareRoots(x * x + y * y + z * z);
    storeFloats(length, scratch.length.data() + i);
    longest = longest < length ? length : longest;
  }
  return std::max(std::max(longest[0], longest[1]), std::max(longest[2], longest[3]));
}

/// The median length. Lengths are counted in buckets first, so that only one bucket needs a selection.
float medianOf(std::size_t size, float longest, HorScratch& scratch) {
  constexpr std::size_t kBuckets = 32;
  const float scale = (static_cast<float>(kBuckets) - 0.5F) / longest;
  if (scratch.bucket.size() < scratch.length.size()) {
    scratch.bucket.resize(scratch.length.size());
    scratch.middle.resize(scratch.length.size());
  }
  for (std::size_t i = 0; i < size; i += kLanes) {
    const Numbers four = __builtin_convertvector(loadFloats(scratch.length.data() + i) * scale, Numbers);
    std::memcpy(scratch.bucket.data() + i, &four, sizeof four);
  }
  std::array<std::uint32_t, kBuckets> count{};
  for (std::size_t i = 0; i < size; ++i) ++count[static_cast<std::size_t>(scratch.bucket[i])];
  std::size_t before = 0, bucket = 0;
  const std::size_t middle = size / 2;
  while (before + count[bucket] <= middle) before += count[bucket++];
  std::size_t found = 0;
  for (std::size_t i = 0; i < size; ++i) {  // branchless append
    scratch.middle[found] = scratch.length[i];
    found += static_cast<std::size_t>(scratch.bucket[i]) == bucket ? 1U : 0U;
  }
  const auto place = scratch.middle.begin() + static_cast<std::ptrdiff_t>(middle - before);
  std::nth_element(scratch.middle.begin(), place, scratch.middle.begin() + static_cast<std::ptrdiff_t>(found));
  return *place;
}

}  // namespace

std::vector<std::string> horColumns() {
  std::vector<std::string> names{"hor.down"};
  for (std::size_t e = 1; e + 1 < kElevationNodes; ++e)
    for (const char* azimuth : {"along", "oblique", "across"})
      names.push_back("hor.e" + std::to_string(e) + "_" + azimuth);
  names.insert(names.end(), {"hor.up", "hor.to_plane", "hor.to_line", "hor.to_level", "hor.off_plane", "hor.mean_up",
                             "hor.mean_side"});
  return names;
}

void fillHor(const Support& support, const EigenShape& shape, HorScratch& scratch, std::span<float> out) {
  std::fill(out.begin(), out.end(), 0.0F);
  if (support.residual.empty()) return;
  const float longest = fillLengths(support.residual, scratch);
  if (!(longest > kShortestMedian_m)) return;
  const float median = medianOf(support.residual.size(), longest, scratch);
  if (!(median > kShortestMedian_m)) return;
  const MainDirection main = mainDirectionOf(support.sum);
  fillBins(castVotes(support.residual, main, median, scratch), main.clearness, out.subspan(0, kHorBins));
  const MomentSum& sum = support.sum;
  const Eigen::Vector3d mean = Eigen::Vector3d(sum.x, sum.y, sum.z) / sum.n;
  const std::array<double, kHorScalars> scalars{
      shape.length(2),                                                 // rms residual to the best plane
      std::sqrt(shape.value[1] + shape.value[2]),                      // rms residual to the best line
      std::sqrt(std::max(0.0, sum.zz / sum.n - mean.z() * mean.z())),  // rms residual to the horizontal plane
      std::abs(mean.dot(shape.normal)),                                // distance of the centre from the plane
      mean.z(),
      std::hypot(mean.x(), mean.y())};  // offset of the support's mean from the centre
  for (std::size_t i = 0; i < kHorScalars; ++i) out[kHorBins + i] = static_cast<float>(scalars[i] / median);
}

}  // namespace cluxel::perception
