// SPDX-License-Identifier: Apache-2.0
// Scans through PCL's PCD writer; poses and times with the shortest digits that give back the same double.
#include "scan/formats/scan_writer.hpp"

#include <charconv>
#include <cstring>

#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "scan/pcl/pcl_functions.hpp"

namespace cluxel::scan {

namespace fs = std::filesystem;

namespace {

std::vector<PointField> fieldsOf(const ScanPoints& points) {
  std::vector<PointField> fields{{"x", FieldType::F32}, {"y", FieldType::F32}, {"z", FieldType::F32}};
  if (!points.intensity.empty()) fields.push_back({"intensity", FieldType::F32});
  if (!points.label.empty()) fields.push_back({"label", FieldType::U32});
  if (!points.origin.empty())
    for (const char* name : {"vp_x", "vp_y", "vp_z"}) fields.push_back({name, FieldType::F32});
  return fields;
}

void checkLengths(const ScanPoints& points, const fs::path& path) {
  const std::size_t count = points.size();
  const auto fits = [&](std::size_t size) { return size == 0 || size == count; };
  const bool whole = points.y.size() == count && points.z.size() == count && fits(points.intensity.size()) &&
                     fits(points.label.size()) && fits(points.origin.size());
  if (count == 0 || !whole)
    throw InputError({.file = path.string()},
                     count == 0 ? "an empty scan cannot be written" : "the scan's arrays differ in length");
}

template <typename T>
void append(std::string& records, T value) {
  char bytes[sizeof value];
  std::memcpy(bytes, &value, sizeof value);
  records.append(bytes, sizeof value);
}

std::string recordsOf(const ScanPoints& points, std::size_t record_bytes) {
  std::string records;
  records.reserve(record_bytes * points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    append(records, points.x[i]);
    append(records, points.y[i]);
    append(records, points.z[i]);
    if (!points.intensity.empty()) append(records, points.intensity[i]);
    if (!points.label.empty()) append(records, points.label[i]);
    if (!points.origin.empty())
      for (int axis = 0; axis < 3; ++axis) append(records, points.origin[i][axis]);
  }
  return records;
}

void appendNumber(std::string& text, double number, char end) {
  char digits[32];
  text.append(digits, std::to_chars(digits, digits + sizeof digits, number).ptr);
  text += end;
}

}  // namespace

void writeScanFile(const Scan& scan, const fs::path& path) {
  checkLengths(scan.points, path);
  const std::vector<PointField> fields = fieldsOf(scan.points);
  writeFile(path,
            pcl().pcdFile(recordsOf(scan.points, recordBytes(fields)), fields, scan.points.size(), scan.T_map_sensor));
}

void writePoses(const std::vector<Eigen::Isometry3d>& T_map_sensor, const fs::path& path) {
  std::string text = "# T_map_sensor, 4x4 row by row, one line a scan\n";
  for (const Eigen::Isometry3d& pose : T_map_sensor)
    for (int i = 0; i < 16; ++i) appendNumber(text, pose(i / 4, i % 4), i == 15 ? '\n' : ' ');
  writeFile(path, text);
}

void writeTimes(const std::vector<double>& time_s, const fs::path& path) {
  std::string text;
  for (const double time : time_s) appendNumber(text, time, '\n');
  writeFile(path, text);
}

}  // namespace cluxel::scan
