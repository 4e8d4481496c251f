// SPDX-License-Identifier: Apache-2.0
// Scans are simulated and written one by one on each thread; tables are put together in the order of the
// stops.
#include "simulation/laser/campus_writer.hpp"

#include <zlib.h>

#include <charconv>
#include <cstdio>
#include <set>
#include <string>
#include <vector>

#include "base/counted_progress.hpp"
#include "base/file_bytes.hpp"
#include "base/parallel.hpp"
#include "cluxel/error.hpp"
#include "scan/formats/scan_writer.hpp"
#include "simulation/laser/instance_table.hpp"
#include "simulation/laser/laser.hpp"
#include "simulation/site/campus_random.hpp"

namespace cluxel::simulation {
namespace {

namespace fs = std::filesystem;

/// A gzip file of `text`, without a time in its header.
std::string gzip(const std::string& text) {
  z_stream stream{};
  constexpr int kGzipWindow = 15 + 16, kMemory = 8;
  if (deflateInit2(&stream, 6, Z_DEFLATED, kGzipWindow, kMemory, Z_DEFAULT_STRATEGY) != Z_OK)
    throw Error(ErrorKind::StoreUnavailable, "zlib does not start, so truth files cannot be written");
  std::string packed(deflateBound(&stream, text.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  const int outcome = deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  if (outcome != Z_STREAM_END) throw Error(ErrorKind::StoreUnavailable, "zlib could not pack a truth file");
  return packed;
}

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

std::string stemOf(std::size_t stop) {
  char text[32];
  std::snprintf(text, sizeof text, "scan_%03zu", stop);
  return text;
}

/// Poses with accumulated errors: each step is off by `drift_m` times 0.5 to 1.5 along its direction, with small errors
/// in the other directions. The first pose is exact.
std::vector<Eigen::Isometry3d> statedPoses(const Campus& campus) {
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

/// The contribution of one scan to the tables.
struct Written {
  std::vector<InstanceSights> sights;
  std::vector<std::size_t> points;
};

Written writeScans(const Campus& campus, const std::vector<Eigen::Isometry3d>& stated, const fs::path& folder,
                   unsigned threads, ProgressSink& sink) {
  const Laser laser(campus);
  const std::size_t count = campus.stops.size();
  Written written{.sights = std::vector<InstanceSights>(count), .points = std::vector<std::size_t>(count)};
  CountedProgress progress(sink, "scan", count);
  parallelFor(count, threads, [&](std::size_t stop) {
    SimulatedScan simulated = laser.scanAt(stop);
    written.sights[stop] = sightsOf(simulated);
    written.points[stop] = simulated.scan.points.size();
    simulated.scan.T_map_sensor = stated[stop];
    writeScanFile(simulated.scan, folder / (stemOf(stop) + ".pcd"));
    writeFile(folder / "truth" / (stemOf(stop) + ".truth.gz"), gzip(truthLines(simulated.truth)));
    progress.step();
  });
  return written;
}

CampusSummary summaryOf(const Campus& campus, const Written& written) {
  CampusSummary summary;
  summary.scans = campus.stops.size();
  std::set<std::int32_t> seen;
  for (std::size_t stop = 0; stop < summary.scans; ++stop) {
    summary.points += written.points[stop];
    for (const auto& [id, sight] : written.sights[stop]) seen.insert(id);
  }
  summary.objects = seen.size();
  for (const std::int32_t id : seen)
    ++summary.objects_of_class[static_cast<std::size_t>(campus.objects[static_cast<std::size_t>(id)].class_number)];
  return summary;
}

}  // namespace

CampusSummary writeCampus(const Campus& campus, const fs::path& folder, unsigned threads, ProgressSink& sink) {
  prepare(folder);
  const std::vector<Eigen::Isometry3d> stated = statedPoses(campus);
  const Written written = writeScans(campus, stated, folder, threads, sink);
  std::vector<std::string> stems;
  std::vector<double> times_s;
  for (std::size_t stop = 0; stop < campus.stops.size(); ++stop) {
    stems.push_back(stemOf(stop));
    times_s.push_back(stopTime_s(stop));
  }
  writeFile(folder / "truth" / "instances.csv", instanceTable(campus, written.sights, stems));
  writeFile(folder / "campus.json", describeCampus(campus));
  scan::writeTimes(times_s, folder / "times.txt");
  scan::writePoses(stated, folder / "poses.txt");
  if (campus.params.drift_m != 0) scan::writePoses(campus.stops, folder / "true_poses.txt");
  return summaryOf(campus, written);
}

}  // namespace cluxel::simulation
