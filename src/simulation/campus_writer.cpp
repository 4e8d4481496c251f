// SPDX-License-Identifier: Apache-2.0
// Scans are simulated and written one by one on each thread; tables are put together in the order of the
// stops.
#include "cluxel/simulation/campus_writer.hpp"

#include <zlib.h>

#include <charconv>
#include <cstdio>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "cluxel/base/diagnostic.hpp"
#include "cluxel/base/file_bytes.hpp"
#include "cluxel/base/parallel.hpp"
#include "cluxel/scan/scan_writer.hpp"
#include "cluxel/simulation/laser.hpp"
#include "simulation/instance_table.hpp"

namespace cluxel {
namespace {

namespace fs = std::filesystem;

/// A gzip file of `text`, without a time in its header.
std::string gzip(const std::string& text) {
  z_stream stream{};
  constexpr int kGzipWindow = 15 + 16, kMemory = 8;
  if (deflateInit2(&stream, 6, Z_DEFLATED, kGzipWindow, kMemory, Z_DEFAULT_STRATEGY) != Z_OK)
    throw Error(ExitCode::StoreUnavailable, "zlib does not start, so truth files cannot be written");
  std::string packed(deflateBound(&stream, text.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  const int outcome = deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  if (outcome != Z_STREAM_END) throw Error(ExitCode::StoreUnavailable, "zlib could not pack a truth file");
  return packed;
}

std::string truthLines(const PointTruth& truth) {
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

void prepare(const fs::path& folder) {
  std::error_code failure;
  if (fs::exists(folder) && !(fs::is_directory(folder) && fs::is_empty(folder)))
    throw Error(ExitCode::Usage,
                folder.string() + " is not an empty folder: name a new one, or remove it first");
  fs::create_directories(folder / "truth", failure);
  if (failure)
    throw Error(ExitCode::StoreUnavailable,
                "cannot make the folder " + folder.string() + ": " + failure.message());
}

/// What each scan leaves behind for the tables.
struct Written {
  std::vector<InstanceSights> sights;
  std::vector<std::size_t> points;
};

Written writeScans(const Campus& campus, const fs::path& folder, unsigned threads, ProgressSink& sink) {
  const Laser laser(campus);
  const std::size_t count = campus.stops.size();
  Written written{.sights = std::vector<InstanceSights>(count), .points = std::vector<std::size_t>(count)};
  std::mutex sink_mutex;
  std::size_t done = 0;
  parallelFor(count, threads, [&](std::size_t stop) {
    const SimulatedScan simulated = laser.scanAt(stop);
    writeScanFile(simulated.scan, folder / (stemOf(stop) + ".pcd"));
    writeFile(folder / "truth" / (stemOf(stop) + ".truth.gz"), gzip(truthLines(simulated.truth)));
    written.sights[stop] = sightsOf(simulated);
    written.points[stop] = simulated.scan.points.size();
    const std::lock_guard lock(sink_mutex);
    sink.progress("scan", ++done, count);
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
    ++summary.objects_of_class[static_cast<std::size_t>(
        campus.objects[static_cast<std::size_t>(id)].class_number)];
  return summary;
}

}  // namespace

CampusSummary writeCampus(const Campus& campus, const fs::path& folder, unsigned threads,
                          ProgressSink& sink) {
  prepare(folder);
  const Written written = writeScans(campus, folder, threads, sink);
  std::vector<std::string> stems;
  std::vector<double> times_s;
  for (std::size_t stop = 0; stop < campus.stops.size(); ++stop) {
    stems.push_back(stemOf(stop));
    times_s.push_back(stopTime_s(stop));
  }
  writeFile(folder / "truth" / "instances.csv", instanceTable(campus, written.sights, stems));
  writeFile(folder / "campus.json", describeCampus(campus));
  writeTimes(times_s, folder / "times.txt");
  writePoses(campus.stops, folder / "poses.txt");
  return summaryOf(campus, written);
}

}  // namespace cluxel
