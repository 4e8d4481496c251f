// SPDX-License-Identifier: Apache-2.0
// Aims for size and cost in a form without a clock: bytes a point, free space, and tiles that a change decides.
#include <gtest/gtest.h>

#include <deque>
#include <string>
#include <vector>

#include "mapping/change/map_change.hpp"
#include "mapping/change/map_compaction.hpp"
#include "mapping/small_campus.hpp"
#include "rdf/file/space/layer_sizes.hpp"
#include "rdf/holes.hpp"

namespace cluxel::mapping {
namespace {

namespace fs = std::filesystem;

double bytesPerPoint(const fs::path& map) {
  return static_cast<double>(fs::file_size(map)) / static_cast<double>(MapReader(map).summary().points);
}

/// What compact would gain, as a share of the file.
double freeShare(const fs::path& map) {
  const FreeSpace space = freeSpaceOf(Environment::open(map, OpenMode::ReadOnly)->read());
  return static_cast<double>(space.bytes) / static_cast<double>(space.file_bytes);
}

TEST(CostBars, ADenseCampusTakesFortyBytesAPointAndCompactGainsNothing) {
  const SmallCampus campus({.seed = 1, .stops = 4, .size_m = 60, .points_per_stop = 170'000});
  const ScratchFolder folder;
  const fs::path map = folder.path() / "map.clx";
  buildMap(scansOf(campus.files()), shippedInputs(), map, {.threads = 2}, silence());
  EXPECT_LE(bytesPerPoint(map), 40);
  EXPECT_LE(freeShare(map), kMaxFreeShare);
  const auto before = static_cast<double>(fs::file_size(map));
  compactMap(map);
  EXPECT_GE(static_cast<double>(fs::file_size(map)), 0.95 * before);
}

TEST(CostBars, AChangeLeavesAQuarterOfTheFileFreeAtMostAndATwentiethOfTheDisk) {
  const SmallCampus campus({.seed = 1, .stops = 4, .size_m = 60, .points_per_stop = 20'000});
  const ScratchFolder folder;
  const fs::path map = folder.path() / "map.clx";
  buildMap(scansOf({campus.files()[0], campus.files()[1]}), shippedInputs(), map, {}, silence());
  for (const std::size_t stop : {2U, 3U}) {
    extendMap(map, scansOf({campus.files()[stop]}), {}, silence());
    EXPECT_LE(freeShare(map), kMaxFreeShareOfChanged);
    if (!hasHoles(folder.path())) continue;
    const fs::path copy = folder.path() / ("copy " + std::to_string(stop));
    copyCompacted(map, copy);
    EXPECT_GE(static_cast<double>(diskBytes(copy)), 0.95 * static_cast<double>(diskBytes(map)));
  }
}

TEST(CostBarsOfOakland, AMapTakesNinetyBytesAPoint) {
  const fs::path data = test::outsideDataFolder() / "oakland3d";
  if (!fs::exists(data)) GTEST_SKIP() << "outside data absent: oakland3d";
  std::vector<fs::path> chunks;
  for (const auto& entry : fs::directory_iterator(data))
    if (entry.path().extension() == ".xyz_label_conf") chunks.push_back(entry.path());
  ASSERT_FALSE(chunks.empty());
  const ScratchFolder folder;
  buildMap(scansOf(chunks), shippedInputs(), folder.path() / "map.clx", {.threads = 2}, silence());
  EXPECT_LE(bytesPerPoint(folder.path() / "map.clx"), 90);
}

/// The same scan is added to the map of its campus, and to a map that has three more of them beside it.
TEST(CostBars, OneMoreScanDecidesTheSameTilesInALargeMap) {
  std::deque<SmallCampus> campuses;
  for (const unsigned seed : {8U, 9U, 10U, 11U})
    campuses.emplace_back(CampusParams{.seed = seed, .stops = 4, .size_m = 60, .points_per_stop = 4000});
  std::vector<fs::path> files;
  for (const SmallCampus& campus : campuses) files.insert(files.end(), campus.files().begin(), campus.files().end());
  const ScanSet all = scansOf(files);
  std::vector<PosedScan> scans;
  for (std::size_t i = 0; i < all.size(); ++i) {
    scans.push_back({i, all.file(i).T_map_sensor});
    scans.back().T_map_sensor.pretranslate(Eigen::Vector3d(256 * static_cast<double>(i / 4), 0, 0));
  }
  const ScanSet added = all.posed({scans[3]});
  const std::vector<PosedScan> of_campus(scans.begin(), scans.begin() + 3);
  std::vector<PosedScan> of_all = of_campus;
  of_all.insert(of_all.end(), scans.begin() + 4, scans.end());
  const ScratchFolder folder;
  std::vector<ChangeReport> reports;
  for (const auto& before : {of_campus, of_all}) {
    const fs::path map = folder.path() / std::to_string(before.size());
    buildMap(all.posed(before), shippedInputs(), map, {.threads = 2}, silence());
    reports.push_back(extendMap(map, added, {.max_window_share = 2}, silence()));
    EXPECT_EQ(reports.back().local_commits, 1U);
  }
  EXPECT_GT(reports[1].tiles, 3 * reports[0].tiles);
  EXPECT_EQ(reports[0].tiles_changed, reports[1].tiles_changed);
  EXPECT_EQ(reports[0].tiles_decided, reports[1].tiles_decided);
}

}  // namespace
}  // namespace cluxel::mapping
