// SPDX-License-Identifier: Apache-2.0
// Looks up a few GeoTIFF keys, and the identifier and unit in a WKT, by its brackets.
#include "scan/formats/las_crs.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <map>

#include "base/proj_reference_system.hpp"
#include "scan/formats/little_endian.hpp"

namespace cluxel::scan {

namespace {

constexpr std::uint16_t kGeoKeyRecord = 34735, kWktRecord = 2112;
constexpr std::size_t kRecordHeaderBytes = 54, kExtendedHeaderBytes = 60;
constexpr std::uint64_t kMaxRecordBytes = 1U << 20;
constexpr std::size_t kMaxRecords = 4096;

std::string bytesAt(std::ifstream& stream, std::uint64_t offset, std::uint64_t count) {
  std::string bytes(count, '\0');
  stream.clear();
  stream.seekg(static_cast<std::streamoff>(offset));
  stream.read(bytes.data(), static_cast<std::streamsize>(count));
  bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(stream.gcount(), 0)));
  return bytes;
}

/// A run of (extended) variable length records.
struct Records {
  std::uint64_t offset = 0, count = 0;
  bool extended = false;
};

/// The bodies of the two CRS records, by record id.
void collectCrsRecords(std::ifstream& stream, const Records& records, std::map<std::uint16_t, std::string>& found) {
  const std::size_t header_bytes = records.extended ? kExtendedHeaderBytes : kRecordHeaderBytes;
  std::uint64_t at = records.offset;
  for (std::size_t i = 0; i < std::min<std::uint64_t>(records.count, kMaxRecords); ++i) {
    const std::string header = bytesAt(stream, at, header_bytes);
    if (header.size() < header_bytes) return;
    const std::uint64_t length =
        records.extended ? numberAt<std::uint64_t>(header, 20) : numberAt<std::uint16_t>(header, 20);
    const auto id = numberAt<std::uint16_t>(header, 18);
    const bool is_projection = header.substr(2, 16).starts_with("LASF_Projection");
    if (length > (1ULL << 40)) return;
    if (is_projection && (id == kGeoKeyRecord || id == kWktRecord) && length <= kMaxRecordBytes)
      found.emplace(id, bytesAt(stream, at + header_bytes, length));
    at += header_bytes + length;
  }
}

/// The bracketed part of `text` from `begin` (at a keyword): "PROJCS[...]".
std::string_view nodeAt(std::string_view text, std::size_t begin) {
  int depth = 0;
  bool quoted = false;
  for (std::size_t i = begin; i < text.size(); ++i) {
    if (text[i] == '"') quoted = !quoted;
    if (quoted) continue;
    if (text[i] == '[' || text[i] == '(') ++depth;
    if ((text[i] == ']' || text[i] == ')') && --depth == 0) return text.substr(begin, i + 1 - begin);
  }
  return text.substr(begin);
}

/// The direct children of a node: "NAME[...]" and plain values.
std::vector<std::string_view> childrenOf(std::string_view node) {
  std::vector<std::string_view> children;
  int depth = 0;
  bool quoted = false;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < node.size(); ++i) {
    const char c = node[i];
    if (c == '"') quoted = !quoted;
    if (quoted) continue;
    const bool closes = c == ']' || c == ')';
    if (depth == 1 && (c == ',' || closes)) {
      while (begin < i && (node[begin] == ' ' || node[begin] == '\n' || node[begin] == '\r' || node[begin] == '\t'))
        ++begin;
      children.push_back(node.substr(begin, i - begin));
      begin = i + 1;
    }
    if (closes) --depth;
    if ((c == '[' || c == '(') && ++depth == 1) begin = i + 1;
  }
  return children;
}

std::string unquoted(std::string_view text) {
  std::string plain(text);
  std::erase(plain, '"');
  return plain;
}

/// The unit of `metres_per_unit` metres, when it is a known one.
std::optional<LengthUnit> unitOf(double metres_per_unit) {
  for (const LengthUnit unit :
       {LengthUnit::UsSurveyFoot, LengthUnit::Foot, LengthUnit::Metre, LengthUnit::Centimetre, LengthUnit::Millimetre})
    if (std::abs(metres_per_unit / metresPer(unit) - 1) < 1e-7) return unit;
  return std::nullopt;
}

/// The unit of the axes: a direct child UNIT or LENGTHUNIT, or that of an AXIS (WKT 2).
std::optional<LengthUnit> unitOfNode(std::string_view node) {
  std::optional<LengthUnit> unit;
  for (const std::string_view child : childrenOf(node)) {
    if (child.starts_with("AXIS"))
      if (const auto of_axis = unitOfNode(child)) unit = of_axis;
    if (!child.starts_with("UNIT") && !child.starts_with("LENGTHUNIT")) continue;
    const std::vector<std::string_view> parts = childrenOf(child);
    double factor = 0;
    if (parts.size() < 2) continue;
    if (std::from_chars(parts[1].data(), parts[1].data() + parts[1].size(), factor).ec == std::errc())
      unit = unitOf(factor);
  }
  return unit;
}

}  // namespace

std::optional<LengthUnit> unitOf(const LasCrs& stated) {
  if (stated.unit || stated.crs.empty()) return stated.unit;
  const ReferenceSystem system = referenceSystem(stated.crs);
  if (system.kind != ReferenceSystem::Kind::Projected) return std::nullopt;
  return unitOf(system.metres_per_unit);
}

LasCrs crsFromGeoKeys(std::string_view record) {
  constexpr std::uint16_t kModelType = 1024, kGeographic = 2048, kProjected = 3072, kLinearUnit = 3076;
  constexpr std::uint16_t kUserDefined = 32767, kModelGeographic = 2;
  std::map<std::uint16_t, std::uint16_t> keys;
  for (std::size_t at = 8; at + 8 <= record.size(); at += 8)
    if (numberAt<std::uint16_t>(record, at + 2) == 0)  // the value itself, not a place in another record
      keys[numberAt<std::uint16_t>(record, at)] = numberAt<std::uint16_t>(record, at + 6);
  LasCrs crs;
  crs.is_geographic = keys[kModelType] == kModelGeographic;
  const std::uint16_t code = keys[crs.is_geographic ? kGeographic : kProjected];
  if (code != 0 && code != kUserDefined)
    crs.crs = "EPSG:" + std::to_string(code);
  else
    crs.fault = "its GeoTIFF keys hold no EPSG code";
  const std::uint16_t unit = keys[kLinearUnit];
  if (unit == 9001) crs.unit = LengthUnit::Metre;
  if (unit == 9002) crs.unit = LengthUnit::Foot;
  if (unit == 9003) crs.unit = LengthUnit::UsSurveyFoot;
  return crs;
}

LasCrs crsFromWkt(std::string_view record) {
  const std::string_view text = record.substr(0, record.find('\0'));
  LasCrs crs;
  std::size_t begin = std::string_view::npos;
  for (const std::string_view keyword : {"PROJCS[", "PROJCRS[", "PROJECTEDCRS["})
    begin = std::min(begin, text.find(keyword));
  if (begin == std::string_view::npos) {
    for (const std::string_view keyword : {"GEOGCS[", "GEOGCRS[", "GEODCRS["})
      begin = std::min(begin, text.find(keyword));
    crs.is_geographic = begin != std::string_view::npos;
  }
  if (begin == std::string_view::npos) {
    crs.fault = "its WKT holds no projected or geographic system";
    return crs;
  }
  const std::string_view node = nodeAt(text, begin);
  crs.crs = text;
  for (const std::string_view child : childrenOf(node)) {
    if (!child.starts_with("AUTHORITY") && !child.starts_with("ID")) continue;
    const std::vector<std::string_view> parts = childrenOf(child);
    if (parts.size() >= 2 && unquoted(parts[0]) == "EPSG") crs.crs = "EPSG:" + unquoted(parts[1]);
  }
  if (!crs.is_geographic) crs.unit = unitOfNode(node);
  return crs;
}

std::optional<LasCrs> lasCrsOf(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  const std::string header = bytesAt(stream, 0, 375);
  if (header.size() < 227 || !header.starts_with("LASF")) return std::nullopt;
  std::map<std::uint16_t, std::string> found;
  collectCrsRecords(stream, {numberAt<std::uint16_t>(header, 94), numberAt<std::uint32_t>(header, 100), false}, found);
  if (numberAt<std::uint8_t>(header, 25) == 4 && header.size() == 375)
    collectCrsRecords(stream, {numberAt<std::uint64_t>(header, 235), numberAt<std::uint32_t>(header, 243), true},
                      found);
  if (found.contains(kWktRecord)) return crsFromWkt(found[kWktRecord]);
  if (found.contains(kGeoKeyRecord)) return crsFromGeoKeys(found[kGeoKeyRecord]);
  return std::nullopt;
}

}  // namespace cluxel::scan
