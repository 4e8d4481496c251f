// SPDX-License-Identifier: Apache-2.0
// Scans are simulated and written one by one on each thread; tables are put together in the order of the scans.
#include "simulation/laser/campus_writer.hpp"

#include <cstdio>
#include <string>
#include <vector>

#include "base/counted_progress.hpp"
#include "base/file_bytes.hpp"
#include "base/parallel.hpp"
#include "scan/formats/scan_writer.hpp"
#include "simulation/laser/instance_table.hpp"
#include "simulation/laser/laser.hpp"
#include "simulation/laser/scan_output.hpp"
#include "simulation/laser/visit_truth.hpp"
#include "simulation/site/campus_random.hpp"
#include "simulation/site/site_visits.hpp"

namespace cluxel::simulation {
namespace {

namespace fs = std::filesystem;

std::string stemOf(std::size_t number) {
  char text[32];
  std::snprintf(text, sizeof text, "scan_%03zu", number);
  return text;
}

/// Errors of later visits: `pose_error_m` along x and y, less in height, and a hundredth of it per metre in heading.
void disturb(std::vector<Eigen::Isometry3d>& poses, const CampusParams& params) {
  for (std::size_t stop = 0; stop < poses.size(); ++stop) {
    CampusRandom random = streamOf(params.seed, RandomUse::Visit, stop);
    const double x = random.normal(), y = random.normal(), z = 0.4 * random.normal(), yaw = 0.01 * random.normal();
    const Eigen::Vector3d place = poses[stop].translation();
    poses[stop].linear() =
        Eigen::AngleAxisd(params.pose_error_m * yaw, Eigen::Vector3d::UnitZ()) * poses[stop].linear();
    poses[stop].translation() = place + params.pose_error_m * Eigen::Vector3d(x, y, z);
  }
}

/// The scans of all visits, numbered in the order in which they were taken, and what they contribute to the tables.
struct Written {
  std::vector<InstanceSights> sights;
  std::vector<std::size_t> points;
  std::vector<std::string> stems;
  std::vector<double> times_s;
  std::vector<Eigen::Isometry3d> stated, exact;
};

void writeScans(const Campus& campus, std::size_t visit, const fs::path& folder, unsigned threads,
                CountedProgress& progress, Written& written) {
  const Laser laser(campus);
  const std::size_t first = written.points.size(), count = campus.stops.size();
  std::vector<Eigen::Isometry3d> stated = driftedPoses(campus);
  if (visit > 0) disturb(stated, campus.params);
  written.sights.resize(first + count), written.points.resize(first + count);
  for (std::size_t stop = 0; stop < count; ++stop) {
    written.stems.push_back(stemOf(first + stop));
    written.times_s.push_back(stopTime_s(stop, visit));
  }
  parallelFor(count, threads, [&](std::size_t stop) {
    const std::string stem = stemOf(first + stop);
    const WrittenScan scan = writeScan(laser, stop,
                                       {.T_map_sensor = campus.stops[stop],
                                        .stated = stated[stop],
                                        .scan = folder / (stem + ".pcd"),
                                        .truth = folder / "truth" / (stem + ".truth.gz")});
    written.sights[first + stop] = scan.sights;
    written.points[first + stop] = scan.points;
    progress.step();
  });
  written.stated.insert(written.stated.end(), stated.begin(), stated.end());
  written.exact.insert(written.exact.end(), campus.stops.begin(), campus.stops.end());
}

std::size_t stopsOf(const VisitedSite& site) {
  std::size_t stops = 0;
  for (const Campus& campus : site.visits) stops += campus.stops.size();
  return stops;
}

CampusSummary summaryOf(const Campus& campus, const Written& written, const SeenObjects& seen) {
  CampusSummary summary;
  summary.scans = written.points.size();
  for (const std::size_t points : written.points) summary.points += points;
  for (const auto& [id, object] : seen.all()) summary.count(campus.objects[static_cast<std::size_t>(id)]);
  return summary;
}

}  // namespace

CampusSummary writeCampus(const Campus& campus, const fs::path& folder, unsigned threads, ProgressSink& sink) {
  prepareScanFolder(folder);
  const auto visits = static_cast<std::size_t>(campus.params.visits);
  const VisitedSite site = visits > 1 ? visitSite(campus, visits) : VisitedSite{{campus}, {}};
  CountedProgress progress(sink, "scan", stopsOf(site));
  Written written;
  for (std::size_t visit = 0; visit < visits; ++visit)
    writeScans(site.visits[visit], visit, folder, threads, progress, written);
  const Campus& all = site.visits.front();
  SeenObjects seen;
  for (std::size_t i = 0; i < written.sights.size(); ++i) seen.add(written.sights[i], written.stems[i]);
  writeFile(folder / "truth" / "instances.csv", instanceTable(all, seen));
  writeFile(folder / "campus.json", describeCampus(all));
  scan::writeTimes(written.times_s, folder / "times.txt");
  scan::writePoses(written.stated, folder / "poses.txt");
  if (campus.params.drift_m != 0 || campus.params.pose_error_m != 0)
    scan::writePoses(written.exact, folder / "true_poses.txt");
  if (visits > 1) writeVisitTruth(site, folder / "truth", threads);
  return summaryOf(all, written, seen);
}

}  // namespace cluxel::simulation
