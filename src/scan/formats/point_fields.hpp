// SPDX-License-Identifier: Apache-2.0
// Point records whose fields are named in a file's header (PCD, PLY), and the roles of these fields in a scan.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scan/formats/parsed_scan.hpp"

namespace cluxel::scan {

enum class FieldType : std::uint8_t { I8, U8, I16, U16, I32, U32, I64, U64, F32, F64 };
inline std::size_t bytesOf(FieldType type) {
  constexpr std::array<std::size_t, 10> bytes{1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return bytes[static_cast<std::size_t>(type)];
}

struct PointField {
  std::string name;
  FieldType type = FieldType::F32;
  std::size_t count = 1;  ///< numbers of this field in one record
};

inline std::size_t recordBytes(const std::vector<PointField>& fields) {
  std::size_t bytes = 0;
  for (const PointField& field : fields) bytes += field.count * bytesOf(field.type);
  return bytes;
}

/// The role of a field in a scan.
enum class FieldRole : std::uint8_t { X, Y, Z, Intensity, Label, OriginX, OriginY, OriginZ, None };
inline constexpr std::size_t kFieldRoleCount = 8;

/// The role of each field of a record.
struct FieldRoles {
  std::vector<FieldRole> roles;
  std::vector<std::string> ignored;       ///< names of fields whose role a preferred field has
  std::vector<std::string> lone_origins;  ///< names of fields that tell of a part of an origin, and are ignored
};

/// Roles by the names that PCL, CloudCompare, sensor drivers (Ouster, Velodyne), the KITTI tools and LAS converters
/// use. Of several fields with one role the first of this order is taken: intensity, reflectance, reflectivity,
/// remission; label, class, classification, semantic; a name without the prefix "scalar_" before the same name with it.
/// Throws InputError when x, y or z is missing, a name occurs twice, or a field with a role holds several numbers.
FieldRoles rolesOf(const std::vector<PointField>& fields, const std::string& file);

/// One record's numbers by role.
using PointRow = std::array<double, kFieldRoleCount>;

/// Drivers fill the directions without a return of an organised cloud (a grid of rings and azimuths) with NaN or zeros.
enum class CloudGrid { Unorganised, Organised };

/// Collects rows as the points of a scan.
class RowCollector {
 public:
  RowCollector(const FieldRoles& fields, CloudGrid grid, ParsedScan& scan);
  /// The fault of this row, or nothing.
  std::optional<std::string> add(const PointRow& row);
  /// Room for `count` points, which the caller has checked against the file's length.
  void reserve(std::size_t count);

 private:
  bool has(FieldRole role) const { return has_[static_cast<std::size_t>(role)]; }
  std::array<bool, kFieldRoleCount> has_{};
  CloudGrid grid_;
  ParsedScan* scan_;
  PointCollector points_;
};

/// The records of a file.
struct RecordRange {
  std::size_t count = 0;
  CloudGrid grid = CloudGrid::Unorganised;
  std::uint64_t body_offset = 0;  ///< byte of the first record in the file, for messages
};

/// A scan from packed little-endian records.
ParsedScan scanFromRecords(std::string_view records, const std::vector<PointField>& fields, const RecordRange& range,
                           const std::string& file);

class TextScanner;
/// A scan from the next lines, each a record of `fields`.
ParsedScan scanFromLines(TextScanner& scanner, const std::vector<PointField>& fields, const RecordRange& range);

}  // namespace cluxel::scan
