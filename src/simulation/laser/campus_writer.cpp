// SPDX-License-Identifier: Apache-2.0
// Scans are simulated and written one by one on each thread; tables are put together in the order of the scans.
#include "simulation/laser/campus_writer.hpp"

#include <charconv>
#include <cstdio>
#include <set>
#include <string>
#include <vector>

#include "base/counted_progress.hpp"
#include "base/file_bytes.hpp"
#include "base/packing/gzip_bytes.hpp"
#include "base/parallel.hpp"
#include "cluxel/error.hpp"
#include "scan/formats/scan_writer.hpp"
#include "simulation/laser/instance_table.hpp"
#include "simulation/laser/laser.hpp"
#include "simulation/laser/visit_truth.hpp"
#include "simulation/site/campus_random.hpp"
#include "simulation/site/site_visits.hpp"

namespace cluxel::simulation {
namespace {

namespace fs = std::filesystem;

std::string truthLines(const scan::PointTruth& truth) {
  std::string lines;
  char text[16];
  const auto append = [&](int value, char end) {
    lines.append(text, std::to_chars(text, text + sizeof text, value).ptr);
    lines.push_back(end);
  };
  for (std::size_t i = 0; i < truth.instance.size(); ++i) {
    append(truth.primitive[i], ' ');
    append(truth.object_class[i], ' ');
    append(truth.instance[i], '\n');
  }
  return lines;
}

std::string stemOf(std::size_t number) {
  char text[32];
  std::snprintf(text, sizeof text, "scan_%03zu", number);
  return text;
}

/// Poses with accumulated errors: each step is off by `drift_m` times 0.5 to 1.5 along its direction, with small errors
/// in the other directions. The first pose is exact.
std::vector<Eigen::Isometry3d> driftedPoses(const Campus& campus) {
  const double drift_m = campus.params.drift_m;
  if (drift_m == 0) return campus.stops;
  constexpr double kTurn_radPerM = 0.02, kTilt_radPerM = 0.005;
  std::vector<Eigen::Isometry3d> stated{campus.stops.front()};
  for (std::size_t stop = 1; stop < campus.stops.size(); ++stop) {
    CampusRandom random = streamOf(campus.params.seed, RandomUse::Drift, stop);
    const double forward = random.uniform(0.5, 1.5), left = 0.25 * random.normal(), up = 0.1 * random.normal();
    const double yaw = kTurn_radPerM * random.normal(), pitch = kTilt_radPerM * random.normal(),
                 roll = kTilt_radPerM * random.normal();
    const Eigen::Vector3d turn(drift_m * roll, drift_m * pitch, drift_m * yaw);
    Eigen::Isometry3d error(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
    error.translation() = drift_m * Eigen::Vector3d(forward, left, up);
    stated.push_back(stated.back() * (campus.stops[stop - 1].inverse() * campus.stops[stop]) * error);
  }
  return stated;
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

void prepare(const fs::path& folder) {
  std::error_code failure;
  if (folder.empty()) throw Error(ErrorKind::InvalidArgument, "the folder for the scans has no name");
  if (fs::exists(folder) && !(fs::is_directory(folder) && fs::is_empty(folder)))
    throw Error(ErrorKind::InvalidArgument,
                folder.string() + " is not an empty folder: name a new one, or remove it first");
  fs::create_directories(folder / "truth", failure);
  if (failure)
    throw Error(ErrorKind::StoreUnavailable, "cannot make the folder " + folder.string() + ": " + failure.message());
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
    SimulatedScan simulated = laser.scanAt(stop);
    written.sights[first + stop] = sightsOf(simulated);
    written.points[first + stop] = simulated.scan.points.size();
    simulated.scan.T_map_sensor = stated[stop];
    writeScanFile(simulated.scan, folder / (stemOf(first + stop) + ".pcd"));
    writeFile(folder / "truth" / (stemOf(first + stop) + ".truth.gz"), gzipped(truthLines(simulated.truth)));
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

CampusSummary summaryOf(const Campus& campus, const Written& written) {
  CampusSummary summary;
  summary.scans = written.points.size();
  std::set<std::int32_t> seen;
  for (std::size_t i = 0; i < summary.scans; ++i) {
    summary.points += written.points[i];
    for (const auto& [id, sight] : written.sights[i]) seen.insert(id);
  }
  summary.objects = seen.size();
  for (const std::int32_t id : seen)
    ++summary.objects_of_class[static_cast<std::size_t>(campus.objects[static_cast<std::size_t>(id)].class_number)];
  return summary;
}

}  // namespace

CampusSummary writeCampus(const Campus& campus, const fs::path& folder, unsigned threads, ProgressSink& sink) {
  prepare(folder);
  const auto visits = static_cast<std::size_t>(campus.params.visits);
  const VisitedSite site = visits > 1 ? visitSite(campus, visits) : VisitedSite{{campus}, {}};
  CountedProgress progress(sink, "scan", stopsOf(site));
  Written written;
  for (std::size_t visit = 0; visit < visits; ++visit)
    writeScans(site.visits[visit], visit, folder, threads, progress, written);
  const Campus& all = site.visits.front();
  writeFile(folder / "truth" / "instances.csv", instanceTable(all, written.sights, written.stems));
  writeFile(folder / "campus.json", describeCampus(all));
  scan::writeTimes(written.times_s, folder / "times.txt");
  scan::writePoses(written.stated, folder / "poses.txt");
  if (campus.params.drift_m != 0 || campus.params.pose_error_m != 0)
    scan::writePoses(written.exact, folder / "true_poses.txt");
  if (visits > 1) writeVisitTruth(site, folder / "truth", threads);
  return summaryOf(all, written);
}

}  // namespace cluxel::simulation
