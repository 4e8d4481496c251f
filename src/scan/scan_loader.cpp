// SPDX-License-Identifier: Apache-2.0
// Chooses the parser of a format, and makes a scan of its result.
#include "scan/scan_loader.hpp"

#include <cassert>

#include "base/file_bytes.hpp"
#include "scan/formats/kitti_format.hpp"
#include "scan/formats/las_format.hpp"
#include "scan/formats/pcd_format.hpp"
#include "scan/formats/ply_format.hpp"
#include "scan/formats/text_formats.hpp"

namespace cluxel::scan {

namespace {

/// The labels of the points: a label file has one entry for each record, also for those without a return.
std::vector<std::uint32_t> readLabels(const ScanFile& file, const ParsedScan& parsed) {
  const std::string bytes = readFile(*file.labels), name = file.labels->string();
  const std::size_t records = parsed.points.size() + parsed.no_return.size();
  const std::vector<std::uint32_t> all =
      file.format == ScanFormat::Kitti ? parseKittiLabels(bytes, name, records) : parseLabelLines(bytes, name, records);
  std::vector<std::uint32_t> labels;
  labels.reserve(parsed.points.size());
  auto skipped = parsed.no_return.begin();
  for (std::size_t i = 0; i < records; ++i) {
    if (skipped != parsed.no_return.end() && *skipped == i)
      ++skipped;
    else
      labels.push_back(all[i]);
  }
  return labels;
}

/// The sensor's pose; for a file in the map frame the position of its local origin.
Eigen::Isometry3d poseOf(const ScanFile& file, const ParsedScan& parsed) {
  if (parsed.local_origin.isZero(0)) return file.T_map_sensor;
  if (file.has_pose)
    refuseFile(file.path.string(),
               "the first point lies more than " + std::to_string(static_cast<int>(kFloatReach_m)) +
                   " m from the sensor, but the scan has a pose",
               "points of a scan with a pose are in the sensor frame; leave the pose out for points in the map frame");
  return file.T_map_sensor * Eigen::Translation3d(toMetresZUp(parsed.local_origin, file.frame));
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

LoadedScan loadScan(const ScanFile& file) {
  ParsedScan parsed = parseScan(readFile(file.path), file.format, file.path.string());
  toMetresZUp(parsed.points, file.frame);
  LoadedScan loaded;
  Scan& scan = loaded.scan;
  scan.T_map_sensor = poseOf(file, parsed);
  scan.has_pose = file.has_pose;
  scan.time_s = file.time_s;
  scan.source = file.path.string();
  if (file.labels) parsed.points.label = readLabels(file, parsed);
  scan.points = std::move(parsed.points);
  scan.id = contentIdOf(scan);
  loaded.reading = {scan.source, parsed.no_return.size(), parsed.ignored_fields, frameDoubtsOf(scan)};
  return loaded;
}

}  // namespace cluxel::scan
