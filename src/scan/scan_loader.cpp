// SPDX-License-Identifier: Apache-2.0
// Formats to parsers, and a parsed file to a scan.
#include "scan/scan_loader.hpp"

#include <cassert>

#include "cluxel/base/file_bytes.hpp"
#include "scan/kitti_format.hpp"
#include "scan/las_format.hpp"
#include "scan/pcd_format.hpp"
#include "scan/ply_format.hpp"
#include "scan/text_formats.hpp"

namespace cluxel {

namespace {

std::vector<std::uint32_t> readLabels(const ScanFile& file, std::size_t point_count) {
  const std::string bytes = readFile(*file.labels);
  if (file.format == ScanFormat::Kitti) return parseKittiLabels(bytes, file.labels->string(), point_count);
  return parseLabelLines(bytes, file.labels->string(), point_count);
}

/// Where the points are: the sensor's pose, or for files in the map frame the place of their local origin.
Eigen::Isometry3d poseOf(const ScanFile& file, const ParsedScan& parsed) {
  if (parsed.local_origin.isZero(0)) return file.T_map_sensor;
  if (file.has_pose)
    refuseFile(file.path.string(),
               "the first point lies more than " + std::to_string(static_cast<int>(kFloatReach_m)) +
                   " m from the sensor, but the scan has a pose",
               "points of a scan with a pose are in the sensor frame; for points in the map frame leave the "
               "pose out");
  return file.T_map_sensor * Eigen::Translation3d(parsed.local_origin);
}

}  // namespace

ParsedScan parseScan(std::string_view bytes, ScanFormat format, const std::string& file) {
  switch (format) {
    case ScanFormat::Pcd:
      return parsePcd(bytes, file);
    case ScanFormat::Ply:
      return parsePly(bytes, file);
    case ScanFormat::Kitti:
      return parseKittiPoints(bytes, file);
    case ScanFormat::Freiburg:
      return parseFreiburgPoints(bytes, file);
    case ScanFormat::LabelledText:
      return parseLabelledText(bytes, file);
    case ScanFormat::Xyz:
      return parseXyzText(bytes, file);
    case ScanFormat::Las:
      return parseLas(bytes, file);
  }
  refuseFile(file, "has an unknown format");
}

Scan loadScan(const ScanFile& file) {
  ParsedScan parsed = parseScan(readFile(file.path), file.format, file.path.string());
  Scan scan;
  scan.T_map_sensor = poseOf(file, parsed);
  scan.has_pose = file.has_pose;
  scan.time_s = file.time_s;
  scan.source = file.path.string();
  scan.points = std::move(parsed.points);
  if (file.labels) scan.points.label = readLabels(file, scan.points.size());
  scan.id = contentIdOf(scan);
  return scan;
}

}  // namespace cluxel
