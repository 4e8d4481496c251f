// SPDX-License-Identifier: Apache-2.0
// Rays are counted around samples of the returns of each class. Around a return, because there something is; beside it
// on four sides, because rays that lie dense along a line tell nothing of the gap to the next line.
#include "perception/visibility/expected_returns.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace cluxel::perception {

namespace {

constexpr std::size_t kRangeClasses = 14, kElevationClasses = 30;
constexpr double kFirstRange_m = 1.5, kRangeRatio = 1.4;
constexpr double kElevationClass_rad = std::numbers::pi / 2 / kElevationClasses;
constexpr std::size_t kMaxSamples = 48;
constexpr std::size_t kFewHigher = 10;  ///< so many returns may be birds, wires or noise
constexpr double kBeside = 0.7;         ///< of the distance at which a ray concerns a place

std::size_t rangeClassOf(double range_m) {
  if (!(range_m >= kFirstRange_m)) return kRangeClasses;
  const double number = std::log(range_m / kFirstRange_m) / std::log(kRangeRatio);
  return static_cast<std::size_t>(std::min(number, static_cast<double>(kRangeClasses)));
}

double elevationOfRay_rad(const Eigen::Vector3d& v) {
  return std::atan2(v.z(), v.head<2>().norm());
}

std::size_t elevationClassOf(double elevation_rad) {
  return std::min(static_cast<std::size_t>(elevation_rad / kElevationClass_rad), kElevationClasses - 1);
}

int countNear(const DirectionIndex& index, const Eigen::Vector3d& place, double near_m) {
  int count = 0;
  index.forEachNear(place, near_m, [&](const auto&...) { ++count; });
  return count;
}

/// The fewest rays around four places beside a return, as seen from the sensor.
int fewestBeside(const DirectionIndex& index, const Eigen::Vector3d& end, double near_m) {
  const Eigen::Vector3d right = end.cross(Eigen::Vector3d::UnitZ()).normalized(), up = right.cross(end).normalized();
  int fewest = countNear(index, end, near_m);
  for (const Eigen::Vector3d& way : std::array<Eigen::Vector3d, 4>{up, -up, right, -right})
    fewest = std::min(fewest, countNear(index, end + kBeside * near_m * way, near_m));
  return fewest;
}

float middleOf(std::vector<int> counts) {
  const auto middle = counts.begin() + static_cast<std::ptrdiff_t>(counts.size() / 2);
  std::nth_element(counts.begin(), middle, counts.end());
  return static_cast<float>(*middle);
}

/// The elevation that all but a few of these reach at most.
float nearlyHighest(std::vector<float> elevations_rad) {
  if (elevations_rad.size() <= kFewHigher) return 0;
  const auto at = elevations_rad.begin() + kFewHigher;
  std::nth_element(elevations_rad.begin(), at, elevations_rad.end(), std::greater<>());
  return *at;
}

}  // namespace

ExpectedReturns::ExpectedReturns(const DirectionIndex& index, double near_m)
    : index_(index),
      near_m_(near_m),
      classes_(std::make_unique<Class[]>(kRangeClasses * kElevationClasses)),
      highest_(kRangeClasses, 0) {
  std::vector<std::vector<float>> elevations_rad(kRangeClasses);
  for (std::uint32_t i = 0; i < index.rays().size(); ++i) {
    const Eigen::Vector3d end = index.rays()[i].cast<double>();
    if (end.z() <= 0) continue;
    const std::size_t range_class = rangeClassOf(end.norm());
    if (range_class >= kRangeClasses) continue;
    const double elevation_rad = elevationOfRay_rad(end);
    classes_[range_class * kElevationClasses + elevationClassOf(elevation_rad)].rays.push_back(i);
    elevations_rad[range_class].push_back(static_cast<float>(elevation_rad));
  }
  for (std::size_t r = 0; r < kRangeClasses; ++r) highest_[r] = nearlyHighest(std::move(elevations_rad[r]));
  for (std::size_t r = kRangeClasses - 1; r-- > 0;) highest_[r] = std::max(highest_[r], highest_[r + 1]);
}

float ExpectedReturns::medianOf(std::size_t number) const {
  Class& asked = classes_[number];
  const std::size_t size = asked.rays.size();
  if (size < kFewestReturns) return 0;
  std::call_once(asked.is_counted, [&] {
    const std::size_t step = (size + kMaxSamples - 1) / kMaxSamples;
    const double farthest_m =
        kFirstRange_m * std::pow(kRangeRatio, static_cast<double>(number / kElevationClasses + 1));
    std::vector<int> counts;
    for (std::size_t i = 0; i < size; i += step) {
      const Eigen::Vector3d end = index_.rays()[asked.rays[i]].cast<double>();
      counts.push_back(fewestBeside(index_, end, near_m_ * end.norm() / farthest_m));  // as seen of the farthest place
    }
    asked.median = middleOf(std::move(counts));
  });
  return asked.median;
}

double ExpectedReturns::around(const Eigen::Vector3d& place) const {
  const std::size_t range_class = rangeClassOf(place.norm());
  if (place.z() <= 0 || range_class >= kRangeClasses) return 0;
  const double elevation_rad = elevationOfRay_rad(place);
  if (elevation_rad > static_cast<double>(highest_[range_class])) return 0;
  return static_cast<double>(medianOf(range_class * kElevationClasses + elevationClassOf(elevation_rad)));
}

}  // namespace cluxel::perception
