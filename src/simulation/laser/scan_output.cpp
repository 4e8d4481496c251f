// SPDX-License-Identifier: Apache-2.0
// Points go to a PCD file, truth to a packed text, sights to the caller.
#include "simulation/laser/scan_output.hpp"

#include <charconv>
#include <string>

#include "base/file_bytes.hpp"
#include "base/packing/gzip_bytes.hpp"
#include "cluxel/error.hpp"
#include "scan/formats/scan_writer.hpp"
#include "simulation/site/campus_random.hpp"

namespace cluxel::simulation {

namespace fs = std::filesystem;

namespace {

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

}  // namespace

WrittenScan writeScan(const Laser& laser, std::size_t stop, const ScanFiles& files) {
  SimulatedScan simulated = laser.scanAt(stop);
  simulated.scan.T_map_sensor = files.T_map_sensor;
  WrittenScan written{.sights = sightsOf(simulated), .points = simulated.scan.points.size()};
  simulated.scan.T_map_sensor = files.stated;
  writeScanFile(simulated.scan, files.scan);
  writeFile(files.truth, gzipped(truthLines(simulated.truth)));
  return written;
}

// Each step is off by `drift_m` times 0.5 to 1.5 along its direction, with small errors in the other directions. The
// first pose is exact.
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

void prepareScanFolder(const fs::path& folder) {
  std::error_code failure;
  if (folder.empty()) throw Error(ErrorKind::InvalidArgument, "the folder for the scans has no name");
  if (fs::exists(folder, failure) && !(fs::is_directory(folder, failure) && fs::is_empty(folder, failure)) && !failure)
    throw Error(ErrorKind::InvalidArgument,
                folder.string() + " is not an empty folder: name a new one, or remove it first");
  fs::create_directories(folder / "truth", failure);
  if (failure)
    throw Error(ErrorKind::StoreUnavailable, "cannot make the folder " + folder.string() + ": " + failure.message());
}

}  // namespace cluxel::simulation
