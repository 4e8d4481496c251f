// SPDX-License-Identifier: Apache-2.0
// Field names to roles, and records to points.
#include "scan/point_fields.hpp"

#include <algorithm>
#include <utility>

#include "scan/little_endian.hpp"
#include "scan/text_scanner.hpp"

namespace cluxel {

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

constexpr double kLargestLabel = 4294967295.0;

FieldRole roleOf(std::string_view name) {
  std::string lower(name);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  std::string_view bare = lower;
  if (bare.starts_with("scalar_")) bare.remove_prefix(7);
  for (const auto& [known, role] : kNamedRoles)
    if (known == bare) return role;
  return FieldRole::None;
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

/// A field with a role, and where it lies in the record.
struct Column {
  FieldRole role;
  FieldType type;
  std::size_t offset;
};

std::vector<Column> columnsOf(const std::vector<PointField>& fields, const std::vector<FieldRole>& roles) {
  std::vector<Column> columns;
  std::size_t offset = 0;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    if (roles[i] != FieldRole::None) columns.push_back({roles[i], fields[i].type, offset});
    offset += fields[i].count * bytesOf(fields[i].type);
  }
  return columns;
}

}  // namespace

std::size_t bytesOf(FieldType type) {
  constexpr std::array<std::size_t, 10> bytes{1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return bytes[static_cast<std::size_t>(type)];
}

std::size_t recordBytes(const std::vector<PointField>& fields) {
  std::size_t bytes = 0;
  for (const PointField& field : fields) bytes += field.count * bytesOf(field.type);
  return bytes;
}

std::vector<FieldRole> rolesOf(const std::vector<PointField>& fields, const std::string& file) {
  std::vector<FieldRole> roles;
  for (const PointField& field : fields) {
    FieldRole role = roleOf(field.name);
    const bool twice = std::find(roles.begin(), roles.end(), role) != roles.end();
    if (role != FieldRole::None && (twice || field.count != 1))
      refuseFile(file, "field '" + field.name + "' " +
                           (twice ? "has the meaning of an earlier field" : "holds several numbers"));
    roles.push_back(role);
  }
  const auto missing = [&](FieldRole role) { return std::find(roles.begin(), roles.end(), role) == roles.end(); };
  for (const auto& [name, role] : {kNamedRoles[0], kNamedRoles[1], kNamedRoles[2]})
    if (missing(role)) refuseFile(file, "has no field '" + std::string(name) + "'", "a scan needs x, y and z");
  const auto origins = {FieldRole::OriginX, FieldRole::OriginY, FieldRole::OriginZ};
  if (std::any_of(origins.begin(), origins.end(), missing))
    for (FieldRole& role : roles)
      if (role >= FieldRole::OriginX) role = FieldRole::None;
  return roles;
}

RowCollector::RowCollector(const std::vector<FieldRole>& roles, ParsedScan& scan) : scan_(&scan), points_(scan) {
  for (const FieldRole role : roles)
    if (role != FieldRole::None) has_[static_cast<std::size_t>(role)] = true;
}

void RowCollector::reserve(std::size_t count) {
  points_.reserve(count);
  if (has(FieldRole::Intensity)) scan_->points.intensity.reserve(count);
  if (has(FieldRole::Label)) scan_->points.label.reserve(count);
  if (has(FieldRole::OriginX)) scan_->points.origin.reserve(count);
}

std::optional<std::string> RowCollector::add(const PointRow& row) {
  if (!points_.add(at(row, FieldRole::X), at(row, FieldRole::Y), at(row, FieldRole::Z))) return kUnusableCoordinate;
  if (has(FieldRole::Intensity)) {
    const auto intensity = static_cast<float>(at(row, FieldRole::Intensity));
    if (!std::isfinite(intensity)) return "has an intensity that is not finite";
    scan_->points.intensity.push_back(intensity);
  }
  if (has(FieldRole::Label)) {
    const double label = at(row, FieldRole::Label);
    const bool whole = label >= -1 && label <= kLargestLabel && label == std::floor(label);
    if (!whole) return "has a label that is no whole number from 0 to 4294967295 (or -1 for none)";
    scan_->points.label.push_back(label < 0 ? 0xFFFFFFFFU : static_cast<std::uint32_t>(label));
  }
  if (has(FieldRole::OriginX)) {
    const Eigen::Vector3d origin(at(row, FieldRole::OriginX), at(row, FieldRole::OriginY), at(row, FieldRole::OriginZ));
    scan_->points.origin.push_back(origin.cast<float>());
    if (!scan_->points.origin.back().allFinite()) return "has an origin that is not finite";
  }
  return std::nullopt;
}

ParsedScan scanFromRecords(std::string_view records, const std::vector<PointField>& fields, std::size_t count,
                           const std::string& file, std::uint64_t body_offset) {
  const std::vector<FieldRole> roles = rolesOf(fields, file);
  const std::vector<Column> columns = columnsOf(fields, roles);
  const std::size_t stride = recordBytes(fields);
  ParsedScan scan;
  RowCollector rows(roles, scan);
  rows.reserve(count);
  PointRow row{};
  for (std::size_t i = 0; i < count; ++i) {
    for (const Column& column : columns)
      row[static_cast<std::size_t>(column.role)] = valueAt(records, i * stride + column.offset, column.type);
    if (const auto fault = rows.add(row))
      refuseByte(file, body_offset + i * stride, "point " + std::to_string(i) + ' ' + *fault, kNotFiniteHint);
  }
  return scan;
}

ParsedScan scanFromLines(TextScanner& scanner, const std::vector<PointField>& fields, std::uint64_t count) {
  const std::vector<FieldRole> roles = rolesOf(fields, scanner.file());
  ParsedScan scan;
  RowCollector rows(roles, scan);
  PointRow row{};
  for (std::uint64_t i = 0; i < count; ++i) {
    if (!scanner.nextLine())
      scanner.refuseEnd("ends after " + std::to_string(i) + " of " + std::to_string(count) + " points");
    for (std::size_t f = 0; f < fields.size(); ++f) {
      for (std::size_t k = 0; k < fields[f].count; ++k) {
        if (roles[f] == FieldRole::None)
          scanner.word(fields[f].name.c_str());
        else
          row[static_cast<std::size_t>(roles[f])] = scanner.number(fields[f].name.c_str());
      }
    }
    scanner.endLine("one value for each field of the header");
    if (const auto fault = rows.add(row)) scanner.refuse("the point " + *fault);
  }
  return scan;
}

}  // namespace cluxel
