// SPDX-License-Identifier: Apache-2.0
// Chooses the parser of a format, and makes a scan of its result.
#include "scan/scan_loader.hpp"

#include <cassert>

#include "base/file_bytes.hpp"
#include "base/utc_time.hpp"
#include "scan/formats/kitti_format.hpp"
#include "scan/formats/las_format.hpp"
#include "scan/formats/pcd_format.hpp"
#include "scan/formats/ply_format.hpp"
#include "scan/formats/text_formats.hpp"

namespace cluxel::scan {

namespace fs = std::filesystem;

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

/// Makes points relative to a local origin relative to the sensor.
void moveToSensor(ScanPoints& points, const Eigen::Vector3d& local_origin, const fs::path& path) {
  const Eigen::Vector3d first = local_origin + Eigen::Vector3f(points.x[0], points.y[0], points.z[0]).cast<double>();
  if (first.cwiseAbs().maxCoeff() > kFloatReach_m)
    refuseFile(path.string(),
               "the first point lies more than " + std::to_string(static_cast<int>(kFloatReach_m)) +
                   " m from the sensor, but the scan has a pose",
               "points of a scan with a pose are in the sensor frame; leave the pose out for points in the map frame");
  for (std::size_t i = 0; i < points.size(); ++i) {
    points.x[i] = static_cast<float>(points.x[i] + local_origin.x());
    points.y[i] = static_cast<float>(points.y[i] + local_origin.y());
    points.z[i] = static_cast<float>(points.z[i] + local_origin.z());
  }
  for (Eigen::Vector3f& origin : points.origin) origin = (origin.cast<double>() + local_origin).cast<float>();
}

/// The sensor's pose; for a file in the map frame the position of its local origin. `parsed`: in metres.
Eigen::Isometry3d poseOf(const ScanFile& file, ParsedScan& parsed) {
  if (parsed.local_origin.isZero(0)) return file.T_map_sensor;
  const Eigen::Vector3d local_origin = toMetresZUp(parsed.local_origin, file.frame);
  if (!file.has_pose) return file.T_map_sensor * Eigen::Translation3d(local_origin);
  moveToSensor(parsed.points, local_origin, file.path);  // 4096 millimetres are near
  return file.T_map_sensor;
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

Scan scanOf(const ScanFile& file, ParsedScan& parsed) {
  toMetresZUp(parsed.points, file.frame);
  Scan scan;
  scan.T_map_sensor = poseOf(file, parsed);
  scan.has_pose = file.has_pose;
  scan.time_s = toMicroseconds(file.time_s);  // as all later layers write and compare it
  scan.source = file.path.string();
  if (file.labels) parsed.points.label = readLabels(file, parsed);
  scan.points = std::move(parsed.points);
  requireInMapRange(scan);
  scan.id = contentIdOf(scan);
  return scan;
}

LoadedScan loadScan(const ScanFile& file) {
  ParsedScan parsed = parseScan(readFile(file.path), file.format, file.path.string());
  LoadedScan loaded;
  loaded.scan = scanOf(file, parsed);
  loaded.reading = {loaded.scan.source,        parsed.no_return.size() - parsed.withheld_count,
                    parsed.withheld_count,     parsed.ignored_fields,
                    parsed.lone_origin_fields, frameDoubtsOf(loaded.scan)};
  return loaded;
}

}  // namespace cluxel::scan
