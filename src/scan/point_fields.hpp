// SPDX-License-Identifier: Apache-2.0
// Point records whose fields are named in a file's header (PCD, PLY), and which of the fields make a scan.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scan/parsed_scan.hpp"

namespace cluxel {

enum class FieldType : std::uint8_t { I8, U8, I16, U16, I32, U32, I64, U64, F32, F64 };
std::size_t bytesOf(FieldType type);

struct PointField {
  std::string name;
  FieldType type = FieldType::F32;
  std::size_t count = 1;  ///< numbers of this field in one record
};

std::size_t recordBytes(const std::vector<PointField>& fields);

/// What a field of a record is for.
enum class FieldRole : std::uint8_t { X, Y, Z, Intensity, Label, OriginX, OriginY, OriginZ, None };
inline constexpr std::size_t kFieldRoleCount = 8;

/// The role of each field, by its name in the conventions of PCL, CloudCompare, the KITTI tools and LAS
/// converters. Throws InputError when x, y or z is missing, or a field with a role occurs twice or holds
/// several numbers.
std::vector<FieldRole> rolesOf(const std::vector<PointField>& fields, const std::string& file);

/// One record's numbers by role.
using PointRow = std::array<double, kFieldRoleCount>;

/// Collects rows as the points of a scan.
class RowCollector {
 public:
  RowCollector(const std::vector<FieldRole>& roles, ParsedScan& scan);
  /// The fault of this row, or nothing.
  std::optional<std::string> add(const PointRow& row);
  /// Room for `count` points, which the caller has checked against the file's length.
  void reserve(std::size_t count);

 private:
  bool has(FieldRole role) const { return has_[static_cast<std::size_t>(role)]; }
  std::array<bool, kFieldRoleCount> has_{};
  ParsedScan* scan_;
  PointCollector points_;
};

/// A scan from `count` packed little-endian records; `body_offset` is where the first one lies in the file,
/// for messages.
ParsedScan scanFromRecords(std::string_view records, const std::vector<PointField>& fields, std::size_t count,
                           const std::string& file, std::uint64_t body_offset);

class TextScanner;
/// The next `count` lines as records of `fields`.
ParsedScan scanFromLines(TextScanner& scanner, const std::vector<PointField>& fields, std::uint64_t count);

}  // namespace cluxel
