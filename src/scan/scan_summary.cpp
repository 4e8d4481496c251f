// SPDX-License-Identifier: Apache-2.0
// Counts and extents of scans.
#include "scan/scan_summary.hpp"

#include "base/parallel.hpp"

namespace cluxel::scan {

ScanSummary summarize(const Scan& scan, ScanFormat format) {
  ScanSummary summary;
  summary.source = scan.source;
  summary.format = format;
  summary.id = scan.id;
  summary.point_count = scan.points.size();
  summary.has_pose = scan.has_pose;
  summary.T_map_sensor = scan.T_map_sensor;
  summary.time_s = scan.time_s;
  summary.has_intensity = !scan.points.intensity.empty();
  summary.has_origins = !scan.points.origin.empty();
  for (std::size_t i = 0; i < scan.points.size(); ++i)
    summary.extent_map_m.extend(toMap(scan.T_map_sensor, {scan.points.x[i], scan.points.y[i], scan.points.z[i]}));
  for (const std::uint32_t label : scan.points.label) ++summary.points_by_label[label];
  return summary;
}

ScanSetSummary summarize(const ScanSet& scans, unsigned threads) {
  ScanSetSummary total;
  total.map_origin_m = scans.mapOrigin();
  total.crs = scans.crs();
  total.scans.resize(scans.size());
  std::vector<ScanReading> readings(scans.size());
  parallelFor(scans.size(), threads, [&](std::size_t i) {
    LoadedScan loaded = scans.read(i);
    total.scans[i] = summarize(loaded.scan, scans.file(i).format);
    readings[i] = std::move(loaded.reading);
  });
  ReadingNotes notes(scans.remedies());
  for (const ScanReading& reading : readings)
    for (std::string& note : notes.add(reading)) total.notes.push_back(std::move(note));
  for (std::string& note : notes.totals()) total.notes.push_back(std::move(note));
  for (const ScanSummary& scan : total.scans) {
    total.point_count += scan.point_count;
    total.extent_map_m.extend(scan.extent_map_m);
    for (const auto& [label, count] : scan.points_by_label) total.points_by_label[label] += count;
  }
  return total;
}

}  // namespace cluxel::scan
