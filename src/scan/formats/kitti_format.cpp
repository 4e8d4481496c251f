// SPDX-License-Identifier: Apache-2.0
// Neither format has a header, so only the length and the values can be checked.
#include "scan/formats/kitti_format.hpp"

#include "scan/formats/little_endian.hpp"

namespace cluxel::scan {

namespace {

constexpr std::size_t kRecordBytes = 4 * sizeof(float);
constexpr std::uint32_t kClassMask = 0xFFFFU;

}  // namespace

ParsedScan parseKittiPoints(std::string_view bytes, const std::string& file) {
  const std::size_t count = bytes.size() / kRecordBytes;
  if (bytes.empty()) refuseByte(file, 0, "holds no points", "an empty scan cannot be mapped: leave it out");
  if (bytes.size() % kRecordBytes != 0)
    refuseByte(file, count * kRecordBytes,
               "the last point is cut off: " + std::to_string(bytes.size() % kRecordBytes) +
                   " bytes are left where 16 (x y z intensity) were expected");
  ParsedScan scan;
  PointCollector points(scan);
  points.reserve(count);
  scan.points.intensity.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = i * kRecordBytes;
    const PointUse use =
        points.add(numberAt<float>(bytes, at), numberAt<float>(bytes, at + 4), numberAt<float>(bytes, at + 8));
    if (use == PointUse::NoReturn) continue;
    if (use == PointUse::OutOfRange) refuseByte(file, at, "point " + std::to_string(i) + ' ' + kOutOfRange);
    scan.points.intensity.push_back(numberAt<float>(bytes, at + 12));
    if (!std::isfinite(scan.points.intensity.back()))
      refuseByte(file, at + 12, "point " + std::to_string(i) + " has an intensity that is not finite");
  }
  requirePoints(scan, file);
  return scan;
}

std::vector<std::uint32_t> parseKittiLabels(std::string_view bytes, const std::string& file, std::size_t point_count) {
  const std::size_t expected = point_count * sizeof(std::uint32_t);
  if (bytes.size() != expected)
    refuseByte(file, std::min(bytes.size(), expected),
               "the file has " + std::to_string(bytes.size()) + " bytes where " + std::to_string(expected) +
                   " (4 for each of " + std::to_string(point_count) + " points) were expected",
               "labels and scan must come from the same frame");
  std::vector<std::uint32_t> labels(point_count);
  for (std::size_t i = 0; i < point_count; ++i) labels[i] = numberAt<std::uint32_t>(bytes, 4 * i) & kClassMask;
  return labels;
}

}  // namespace cluxel::scan
