// SPDX-License-Identifier: Apache-2.0
// Header fields are read by their byte offsets in the specification; all lengths are checked before the first point.
#include "scan/formats/las_format.hpp"

#include <algorithm>
#include <array>

#include "scan/formats/little_endian.hpp"

namespace cluxel::scan {

namespace {

constexpr std::size_t kHeaderBytes_1_2 = 227;
constexpr std::size_t kHeaderBytes_1_4 = 375;
constexpr std::array<std::uint16_t, 11> kPointFormatBytes{20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

struct LasHeader {
  std::uint64_t data_offset = 0;
  std::uint64_t point_count = 0;
  std::uint8_t point_format = 0;
  std::uint16_t record_bytes = 0;
  Eigen::Vector3d scale, offset;
};

Eigen::Vector3d vectorAt(std::string_view bytes, std::size_t at) {
  return {numberAt<double>(bytes, at), numberAt<double>(bytes, at + 8), numberAt<double>(bytes, at + 16)};
}

/// The minor version; refuses other versions than 1.2 to 1.4.
unsigned checkVersion(std::string_view bytes, const std::string& file) {
  if (bytes.substr(0, 4) != "LASF") refuseByte(file, 0, "is not a LAS file: it does not begin with 'LASF'");
  if (bytes.size() < kHeaderBytes_1_2)
    refuseByte(file, bytes.size(), "the LAS header is cut off: at least 227 bytes were expected");
  const unsigned major = numberAt<std::uint8_t>(bytes, 24);
  const unsigned minor = numberAt<std::uint8_t>(bytes, 25);
  if (major != 1 || minor < 2 || minor > 4)
    refuseByte(file, 24, "LAS " + std::to_string(major) + '.' + std::to_string(minor) + " is not supported",
               "convert it to LAS 1.2, 1.3 or 1.4");
  const std::size_t header_bytes = numberAt<std::uint16_t>(bytes, 94);
  const std::size_t min_bytes = minor == 4 ? kHeaderBytes_1_4 : kHeaderBytes_1_2;
  if (header_bytes < min_bytes || header_bytes > bytes.size())
    refuseByte(file, 94,
               "the header size " + std::to_string(header_bytes) + " does not fit LAS 1." + std::to_string(minor) +
                   " or the file");
  return minor;
}

void checkPointFormat(LasHeader& header, std::string_view bytes, const std::string& file) {
  const std::uint8_t format = numberAt<std::uint8_t>(bytes, 104);
  if ((format & 0xC0U) != 0)
    refuseByte(file, 104, "the points are compressed (LAZ), which is not supported", "uncompress it to LAS first");
  if (format >= kPointFormatBytes.size()) refuseByte(file, 104, "unknown point format " + std::to_string(format));
  header.point_format = format;
  header.record_bytes = numberAt<std::uint16_t>(bytes, 105);
  if (header.record_bytes < kPointFormatBytes[format])
    refuseByte(file, 105,
               "a point record of " + std::to_string(header.record_bytes) + " bytes is too short for format " +
                   std::to_string(format) + ", which has " + std::to_string(kPointFormatBytes[format]));
}

/// Behind the points only waveforms and extended records may follow, of which the header tells where they begin.
void checkEnd(const LasHeader& header, std::string_view bytes, const std::string& file) {
  const unsigned minor = numberAt<std::uint8_t>(bytes, 25);
  const std::uint64_t end = header.data_offset + header.point_count * header.record_bytes;
  std::uint64_t next = bytes.size();
  for (const auto& [since, at] : {std::pair(3U, 227UL), std::pair(4U, 235UL)}) {
    if (minor < since || numberAt<std::uint16_t>(bytes, 94) < at + 8) continue;
    const auto begin = numberAt<std::uint64_t>(bytes, at);
    if (begin >= end) next = std::min(next, begin);
  }
  const std::uint64_t more = (next - end) / header.record_bytes;
  if (more > 0)
    refuseByte(file, end,
               "behind the " + std::to_string(header.point_count) + " points of the header lies room for " +
                   std::to_string(more) + " more",
               "export the file again, or correct the number of points in its header");
}

void checkLength(const LasHeader& header, std::string_view bytes, const std::string& file) {
  if (header.point_count == 0) refuseByte(file, 107, "holds no points", "an empty scan cannot be mapped: leave it out");
  const std::uint64_t header_bytes = numberAt<std::uint16_t>(bytes, 94);
  if (header.data_offset < header_bytes || header.data_offset > bytes.size())
    refuseByte(
        file, 96,
        "the points are said to begin at byte " + std::to_string(header.data_offset) + ", outside the file's data");
  const std::uint64_t there = (bytes.size() - header.data_offset) / header.record_bytes;
  if (there < header.point_count)
    refuseByte(
        file, bytes.size(),
        "the file ends after " + std::to_string(there) + " of " + std::to_string(header.point_count) + " points");
  checkEnd(header, bytes, file);
}

LasHeader headerOf(std::string_view bytes, const std::string& file) {
  const unsigned minor = checkVersion(bytes, file);
  LasHeader header;
  checkPointFormat(header, bytes, file);
  header.data_offset = numberAt<std::uint32_t>(bytes, 96);
  header.point_count = numberAt<std::uint32_t>(bytes, 107);
  if (minor == 4 && numberAt<std::uint64_t>(bytes, 247) != 0) header.point_count = numberAt<std::uint64_t>(bytes, 247);
  checkLength(header, bytes, file);
  header.scale = vectorAt(bytes, 131);
  header.offset = vectorAt(bytes, 155);
  if (!header.scale.allFinite() || header.scale.cwiseAbs().minCoeff() <= 0)
    refuseByte(file, 131, "the scale factors are not usable numbers");
  if (!header.offset.allFinite()) refuseByte(file, 155, "the offsets are not finite");
  return header;
}

std::uint32_t classificationAt(std::string_view bytes, std::size_t record, const LasHeader& header) {
  if (header.point_format >= 6) return numberAt<std::uint8_t>(bytes, record + 16);
  return numberAt<std::uint8_t>(bytes, record + 15) & 0x1FU;
}

/// Whether the point is marked as deleted.
bool isWithheld(std::string_view bytes, std::size_t record, const LasHeader& header) {
  return (numberAt<std::uint8_t>(bytes, record + 15) & (header.point_format >= 6 ? 0x04U : 0x80U)) != 0;
}

/// LAS writes 0 where nothing was recorded.
template <typename T>
void dropIfAllZero(std::vector<T>& values) {
  if (std::all_of(values.begin(), values.end(), [](T value) { return value == T{}; })) values.clear();
}

}  // namespace

ParsedScan parseLas(std::string_view bytes, const std::string& file) {
  const LasHeader header = headerOf(bytes, file);
  ParsedScan scan;
  PointCollector points(scan);
  points.reserve(header.point_count);
  for (std::uint64_t i = 0; i < header.point_count; ++i) {
    const std::size_t at = header.data_offset + i * header.record_bytes;
    if (isWithheld(bytes, at, header)) {
      points.withhold();
      continue;
    }
    const Eigen::Vector3d raw(numberAt<std::int32_t>(bytes, at), numberAt<std::int32_t>(bytes, at + 4),
                              numberAt<std::int32_t>(bytes, at + 8));
    const Eigen::Vector3d p = raw.cwiseProduct(header.scale) + header.offset;
    const PointUse use = points.add(p.x(), p.y(), p.z());
    if (use == PointUse::NoReturn) continue;
    if (use == PointUse::OutOfRange) refuseByte(file, at, "point " + std::to_string(i) + ' ' + kOutOfRange);
    scan.points.intensity.push_back(numberAt<std::uint16_t>(bytes, at + 12));
    scan.points.label.push_back(classificationAt(bytes, at, header));
  }
  requirePoints(scan, file);
  dropIfAllZero(scan.points.intensity);
  dropIfAllZero(scan.points.label);
  return scan;
}

}  // namespace cluxel::scan
