// SPDX-License-Identifier: Apache-2.0
// A district is made, scanned, written and forgotten before the next one is made.
#include "simulation/laser/city_writer.hpp"

#include <cstdio>
#include <fstream>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "base/counted_progress.hpp"
#include "base/file_bytes.hpp"
#include "base/parallel.hpp"
#include "cluxel/error.hpp"
#include "scan/formats/scan_writer.hpp"
#include "simulation/laser/instance_table.hpp"
#include "simulation/laser/scan_output.hpp"

namespace cluxel::simulation {
namespace {

namespace fs = std::filesystem;

std::string numbered(const char* name, std::size_t number, int digits) {
  char text[48];
  std::snprintf(text, sizeof text, "%s_%0*zu", name, digits, number);
  return text;
}

Eigen::Isometry3d inMap(const DistrictPlace& place, Eigen::Isometry3d T_district_sensor) {
  T_district_sensor.translation() += place.origin_map;
  return T_district_sensor;
}

void makeFolder(const fs::path& folder) {
  std::error_code failure;
  fs::create_directories(folder, failure);
  if (failure)
    throw Error(ErrorKind::StoreUnavailable, "cannot make the folder " + folder.string() + ": " + failure.message());
}

/// The table of instances, written as far as no later scan can add to it.
class GrowingTable {
 public:
  explicit GrowingTable(fs::path file) : file_(std::move(file)), out_(file_, std::ios::binary) {
    out_ << instanceHeader();
  }

  void add(const InstanceSights& sights, const std::string& scan) { seen_.add(sights, scan); }
  void add(const District& district) {
    for (auto [id, object] : district.objects) {
      object.position += district.place.origin_map;
      object.box.translate(district.place.origin_map);
      objects_.emplace(id, std::move(object));
    }
  }
  /// Writes the rows of instances below `end`, and counts them.
  void writeUpTo(std::int32_t end, CampusSummary& summary) {
    while (!seen_.all().empty() && seen_.all().begin()->first < end) {
      const auto& [id, seen] = *seen_.all().begin();
      out_ << instanceRow(id, objects_.at(id), seen);
      summary.count(objects_.at(id));
      seen_.forget(std::int32_t{id});
    }
    objects_.erase(objects_.begin(), objects_.lower_bound(end));
    if (!out_.flush()) throw Error(ErrorKind::StoreUnavailable, "cannot write " + file_.string());
  }

 private:
  fs::path file_;
  std::ofstream out_;
  SeenObjects seen_;
  std::map<std::int32_t, CampusObject> objects_;
};

class CityWriter {
 public:
  CityWriter(const City& city, const DistrictRange& range, const fs::path& folder, ProgressSink& sink)
      : city_(city),
        range_(range),
        folder_(folder),
        table_(folder / "truth" / "instances.csv"),
        progress_(sink, "scan", (range.last - range.first + 1) * stops()) {}

  void write(std::size_t number, unsigned threads) {
    const District district = city_.district(number);
    const std::string name = numbered("district", number, 4);
    makeFolder(folder_ / name);
    makeFolder(folder_ / "truth" / name);
    writeScans(district, name, threads);
    writeFile(folder_ / name / "campus.json", describeDistrict(district.campus, district.place));
  }

  /// What no scan after this district's can see is complete.
  void finish(std::size_t number) {
    while (next_to_list_ < city_.size() && (number == range_.last || city_.lastToSee(next_to_list_) <= number))
      ++next_to_list_;
    const bool is_end = next_to_list_ == city_.size();
    table_.writeUpTo(is_end ? std::numeric_limits<std::int32_t>::max() : city_.placeOf(next_to_list_).first_instance,
                     summary_);
  }

  const CampusSummary& summary() const { return summary_; }

 private:
  std::size_t stops() const { return static_cast<std::size_t>(city_.params().district.stops); }

  void writeScans(const District& district, const std::string& name, unsigned threads) {
    const Laser laser(district.scene);
    const std::vector<Eigen::Isometry3d> drifted = driftedPoses(district.campus);
    std::vector<Eigen::Isometry3d> stated, exact;
    std::vector<double> times_s;
    std::vector<std::string> stems;
    for (std::size_t stop = 0; stop < stops(); ++stop) {
      exact.push_back(inMap(district.place, district.campus.stops[stop]));
      stated.push_back(inMap(district.place, drifted[stop]));
      times_s.push_back(stopTime_s(district.place.number * stops() + stop));
      stems.push_back(numbered(numbered("scan", district.place.number, 4).c_str(), stop, 3));
    }
    std::vector<WrittenScan> written(stops());
    parallelFor(stops(), threads, [&](std::size_t stop) {
      written[stop] = writeScan(laser, stop,
                                {.T_map_sensor = exact[stop],
                                 .stated = stated[stop],
                                 .scan = folder_ / name / (stems[stop] + ".pcd"),
                                 .truth = folder_ / "truth" / name / (stems[stop] + ".truth.gz")});
      progress_.step();
    });
    scan::writeTimes(times_s, folder_ / name / "times.txt");
    scan::writePoses(stated, folder_ / name / "poses.txt");
    if (city_.params().district.drift_m != 0) scan::writePoses(exact, folder_ / name / "true_poses.txt");
    note(district, written, stems);
  }

  void note(const District& district, const std::vector<WrittenScan>& written, const std::vector<std::string>& stems) {
    table_.add(district);
    for (std::size_t stop = 0; stop < written.size(); ++stop) {
      table_.add(written[stop].sights, stems[stop]);
      summary_.points += written[stop].points;
      ++summary_.scans;
    }
  }

  const City& city_;
  DistrictRange range_;
  fs::path folder_;
  GrowingTable table_;
  CountedProgress progress_;
  CampusSummary summary_;
  std::size_t next_to_list_ = 0;
};

void check(const DistrictRange& range, const City& city) {
  if (range.first <= range.last && range.last < city.size()) return;
  throw Error(ErrorKind::InvalidArgument, "the city has no districts " + std::to_string(range.first) + ".." +
                                              std::to_string(range.last) + ": they are numbered 0.." +
                                              std::to_string(city.size() - 1));
}

}  // namespace

CampusSummary writeCity(const City& city, const DistrictRange& range, const fs::path& folder, unsigned threads,
                        ProgressSink& sink) {
  check(range, city);
  prepareScanFolder(folder);
  CityWriter writer(city, range, folder, sink);
  for (std::size_t number = range.first; number <= range.last; ++number) {
    writer.write(number, threads);
    writer.finish(number);
  }
  return writer.summary();
}

}  // namespace cluxel::simulation
