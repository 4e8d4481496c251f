// SPDX-License-Identifier: Apache-2.0
// Maps field names to roles, and records to points.
#include "scan/formats/point_fields.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "base/ascii.hpp"
#include "scan/formats/little_endian.hpp"
#include "scan/formats/text_scanner.hpp"

namespace cluxel::scan {

namespace {

using NamedRole = std::pair<std::string_view, FieldRole>;

constexpr std::array kNamedRoles{
    NamedRole{"x", FieldRole::X},
    NamedRole{"y", FieldRole::Y},
    NamedRole{"z", FieldRole::Z},
    NamedRole{"intensity", FieldRole::Intensity},
    NamedRole{"reflectance", FieldRole::Intensity},
    NamedRole{"reflectivity", FieldRole::Intensity},
    NamedRole{"remission", FieldRole::Intensity},
    NamedRole{"label", FieldRole::Label},
    NamedRole{"class", FieldRole::Label},
    NamedRole{"classification", FieldRole::Label},
    NamedRole{"semantic", FieldRole::Label},
    NamedRole{"vp_x", FieldRole::OriginX},
    NamedRole{"vp_y", FieldRole::OriginY},
    NamedRole{"vp_z", FieldRole::OriginZ},
};

constexpr double kMaxLabel = 4294967295.0;

/// A role, and the preference among fields of the same role: the lowest rank is taken.
struct RankedRole {
  FieldRole role = FieldRole::None;
  std::size_t rank = 0;
};

/// The rank follows the order of kNamedRoles; a name with CloudCompare's prefix comes after the same name without.
RankedRole rankedRoleOf(std::string_view name) {
  const std::string lower = lowerCase(name);
  std::string_view bare = lower;
  const bool prefixed = bare.starts_with("scalar_");
  if (prefixed) bare.remove_prefix(7);
  for (std::size_t i = 0; i < kNamedRoles.size(); ++i)
    if (kNamedRoles[i].first == bare) return {kNamedRoles[i].second, 2 * i + (prefixed ? 1 : 0)};
  return {};
}

/// Gives the role of field `later` to the preferred one of two fields that have it.
void keepPreferred(FieldRoles& found, const std::vector<PointField>& fields, std::size_t later,
                   const std::string& file) {
  const auto same = std::find(found.roles.begin(), found.roles.end() - 1, found.roles[later]);
  if (same == found.roles.end() - 1) return;
  const auto earlier = static_cast<std::size_t>(same - found.roles.begin());
  const std::size_t rank = rankedRoleOf(fields[earlier].name).rank, later_rank = rankedRoleOf(fields[later].name).rank;
  if (rank == later_rank) refuseFile(file, "field '" + fields[later].name + "' occurs twice");
  const std::size_t ignored = rank < later_rank ? later : earlier;
  found.roles[ignored] = FieldRole::None;
  found.ignored.push_back(fields[ignored].name);
}

double valueAt(std::string_view bytes, std::size_t at, FieldType type) {
  switch (type) {
    case FieldType::I8:
      return numberAt<std::int8_t>(bytes, at);
    case FieldType::U8:
      return numberAt<std::uint8_t>(bytes, at);
    case FieldType::I16:
      return numberAt<std::int16_t>(bytes, at);
    case FieldType::U16:
      return numberAt<std::uint16_t>(bytes, at);
    case FieldType::I32:
      return numberAt<std::int32_t>(bytes, at);
    case FieldType::U32:
      return numberAt<std::uint32_t>(bytes, at);
    case FieldType::I64:
      return static_cast<double>(numberAt<std::int64_t>(bytes, at));
    case FieldType::U64:
      return static_cast<double>(numberAt<std::uint64_t>(bytes, at));
    case FieldType::F32:
      return numberAt<float>(bytes, at);
    case FieldType::F64:
      return numberAt<double>(bytes, at);
  }
  return 0;
}

double at(const PointRow& row, FieldRole role) {
  return row[static_cast<std::size_t>(role)];
}

/// A field with a role, and its place in the record.
struct PlacedField {
  FieldRole role;
  FieldType type;
  std::size_t offset;
};

std::vector<PlacedField> placedFields(const std::vector<PointField>& fields, const std::vector<FieldRole>& roles) {
  std::vector<PlacedField> placed;
  std::size_t offset = 0;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    if (roles[i] != FieldRole::None) placed.push_back({roles[i], fields[i].type, offset});
    offset += fields[i].count * bytesOf(fields[i].type);
  }
  return placed;
}

}  // namespace

FieldRoles rolesOf(const std::vector<PointField>& fields, const std::string& file) {
  FieldRoles found;
  std::vector<FieldRole>& roles = found.roles;
  for (const PointField& field : fields) {
    roles.push_back(rankedRoleOf(field.name).role);
    if (roles.back() == FieldRole::None) continue;
    if (field.count != 1) refuseFile(file, "field '" + field.name + "' holds several numbers");
    keepPreferred(found, fields, roles.size() - 1, file);
  }
  const auto missing = [&](FieldRole role) { return std::find(roles.begin(), roles.end(), role) == roles.end(); };
  for (const auto& [name, role] : {kNamedRoles[0], kNamedRoles[1], kNamedRoles[2]})
    if (missing(role)) refuseFile(file, "has no field '" + std::string(name) + "'", "a scan needs x, y and z");
  const auto origins = {FieldRole::OriginX, FieldRole::OriginY, FieldRole::OriginZ};
  if (std::any_of(origins.begin(), origins.end(), missing))
    for (std::size_t i = 0; i < roles.size(); ++i) {
      if (roles[i] < FieldRole::OriginX || roles[i] == FieldRole::None) continue;
      roles[i] = FieldRole::None;
      found.lone_origins.push_back(fields[i].name);
    }
  return found;
}

RowCollector::RowCollector(const FieldRoles& fields, CloudGrid grid, ParsedScan& scan)
    : grid_(grid), scan_(&scan), points_(scan) {
  scan.ignored_fields = fields.ignored;
  scan.lone_origin_fields = fields.lone_origins;
  for (const FieldRole role : fields.roles)
    if (role != FieldRole::None) has_[static_cast<std::size_t>(role)] = true;
}

void RowCollector::reserve(std::size_t count) {
  points_.reserve(count);
  if (has(FieldRole::Intensity)) scan_->points.intensity.reserve(count);
  if (has(FieldRole::Label)) scan_->points.label.reserve(count);
  if (has(FieldRole::OriginX)) scan_->points.origin.reserve(count);
}

std::optional<std::string> RowCollector::add(const PointRow& row) {
  double x = at(row, FieldRole::X);
  const double y = at(row, FieldRole::Y), z = at(row, FieldRole::Z);
  if (grid_ == CloudGrid::Organised && x == 0 && y == 0 && z == 0) x = std::numeric_limits<double>::quiet_NaN();
  const PointUse use = points_.add(x, y, z);
  if (use == PointUse::NoReturn) return std::nullopt;
  if (use == PointUse::OutOfRange) return kOutOfRange;
  if (has(FieldRole::Intensity)) {
    const auto intensity = static_cast<float>(at(row, FieldRole::Intensity));
    if (!std::isfinite(intensity)) return "has an intensity that is not finite";
    scan_->points.intensity.push_back(intensity);
  }
  if (has(FieldRole::Label)) {
    const double label = at(row, FieldRole::Label);
    const bool whole = label >= -1 && label <= kMaxLabel && label == std::floor(label);
    if (!whole) return "has a label that is not a whole number from 0 to 4294967294, or -1 for none";
    scan_->points.label.push_back(label < 0 ? kNoLabel : static_cast<std::uint32_t>(label));
  }
  if (has(FieldRole::OriginX)) {
    const Eigen::Vector3d origin(at(row, FieldRole::OriginX), at(row, FieldRole::OriginY), at(row, FieldRole::OriginZ));
    if (!points_.addOrigin(origin)) return "has an origin that is not finite";
  }
  return std::nullopt;
}

ParsedScan scanFromRecords(std::string_view records, const std::vector<PointField>& fields, const RecordRange& range,
                           const std::string& file) {
  const FieldRoles roles = rolesOf(fields, file);
  const std::vector<PlacedField> placed = placedFields(fields, roles.roles);
  const std::size_t stride = recordBytes(fields);
  ParsedScan scan;
  RowCollector rows(roles, range.grid, scan);
  rows.reserve(range.count);
  PointRow row{};
  for (std::size_t i = 0; i < range.count; ++i) {
    for (const PlacedField& field : placed)
      row[static_cast<std::size_t>(field.role)] = valueAt(records, i * stride + field.offset, field.type);
    if (const auto fault = rows.add(row))
      refuseByte(file, range.body_offset + i * stride, "point " + std::to_string(i) + ' ' + *fault);
  }
  requirePoints(scan, file);
  return scan;
}

ParsedScan scanFromLines(TextScanner& scanner, const std::vector<PointField>& fields, const RecordRange& range) {
  const FieldRoles roles = rolesOf(fields, scanner.file());
  const std::uint64_t count = range.count;
  ParsedScan scan;
  RowCollector rows(roles, range.grid, scan);
  PointRow row{};
  for (std::uint64_t i = 0; i < count; ++i) {
    if (!scanner.nextLine())
      scanner.refuseEnd("ends after " + std::to_string(i) + " of " + std::to_string(count) + " points");
    for (std::size_t f = 0; f < fields.size(); ++f) {
      for (std::size_t k = 0; k < fields[f].count; ++k) {
        if (roles.roles[f] == FieldRole::None)
          scanner.word(fields[f].name.c_str());
        else
          row[static_cast<std::size_t>(roles.roles[f])] = scanner.anyNumber(fields[f].name.c_str());
      }
    }
    scanner.endLine("one value for each field of the header");
    if (const auto fault = rows.add(row)) scanner.refuse("the point " + *fault);
  }
  requirePoints(scan, scanner.file());
  return scan;
}

}  // namespace cluxel::scan
