// SPDX-License-Identifier: Apache-2.0
// Coordinates are differences between points in the order in which they were measured: neighbours are near each other.
#include "mapping/clouds/packed_points.hpp"

#include "base/packing/zstd_packing.hpp"
#include "cluxel/error.hpp"

namespace cluxel::mapping {

namespace {

constexpr std::string_view kKind = "SCAN";
constexpr char kVersion = 3;
constexpr std::size_t kArrays = 8;  ///< x, y, z, intensity, label, and three of origins

std::vector<float> flat(const std::vector<Eigen::Vector3f>& places, int axis) {
  std::vector<float> values;
  values.reserve(places.size());
  for (const Eigen::Vector3f& place : places) values.push_back(place[axis]);
  return values;
}

Error damagedPoints() {
  return Error(ErrorKind::StoreUnavailable, "points of a cloud are damaged; build the map anew");
}

template <typename T>
std::vector<T> takeValues(std::string_view& bytes) {
  auto values = takeArray<T>(bytes);
  if (!values) throw damagedPoints();
  return *std::move(values);
}

std::vector<float> takeSteps(std::string_view& bytes) {
  std::vector<float> values;
  sumUp(takeValues<std::uint32_t>(bytes), values);
  return values;
}

void requireLengths(const scan::ScanPoints& points) {
  const std::size_t count = points.size();
  const auto fits = [count](std::size_t size) { return size == 0 || size == count; };
  if (points.y.size() != count || points.z.size() != count || !fits(points.intensity.size()) ||
      !fits(points.label.size()) || !fits(points.origin.size()))
    throw damagedPoints();
}

}  // namespace

std::string packedPoints(const scan::ScanPoints& points) {
  std::string bytes;
  for (const auto* values : {&points.x, &points.y, &points.z, &points.intensity})
    appendArray(bytes, differencesOf(*values));
  appendArray(bytes, points.label);
  for (int axis = 0; axis < 3; ++axis) appendArray(bytes, differencesOf(flat(points.origin, axis)));
  return std::string(kKind) + kVersion + packedBytes(bytes);
}

scan::ScanPoints unpackedPoints(std::string_view packed, std::uint64_t stated_points) {
  constexpr std::uint64_t kMaxPointBytes = 64, kMaxHeadBytes = 1024;
  if (!packed.starts_with(kKind) || packed.size() <= kKind.size() || packed[kKind.size()] != kVersion)
    throw Error(ErrorKind::StoreUnavailable,
                "points of a cloud are stored in the form of another version of cluxel; build the map anew");
  const auto unpacked = unpackedBytes(packed.substr(kKind.size() + 1), stated_points * kMaxPointBytes + kMaxHeadBytes);
  if (!unpacked) throw damagedPoints();
  std::string_view bytes = unpacked->view();
  scan::ScanPoints points;
  for (auto* values : {&points.x, &points.y, &points.z, &points.intensity}) *values = takeSteps(bytes);
  points.label = takeValues<std::uint32_t>(bytes);
  const std::vector<float> x = takeSteps(bytes), y = takeSteps(bytes), z = takeSteps(bytes);
  if (y.size() != x.size() || z.size() != x.size() || !bytes.empty()) throw damagedPoints();
  for (std::size_t i = 0; i < x.size(); ++i) points.origin.emplace_back(x[i], y[i], z[i]);
  requireLengths(points);
  return points;
}

bool haveOrigins(std::string_view packed, std::uint64_t stated_points) {
  // Without origins a point has at most five values, with them at least six.
  constexpr std::uint64_t kMostWithout = 5 * sizeof(float), kHeads = kArrays * sizeof(std::uint64_t);
  if (packed.size() <= kKind.size()) return false;
  const auto stated = statedBytes(packed.substr(kKind.size() + 1));
  return stated && *stated > stated_points * kMostWithout + kHeads;
}

}  // namespace cluxel::mapping
