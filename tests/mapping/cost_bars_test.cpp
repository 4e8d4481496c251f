// SPDX-License-Identifier: Apache-2.0
// Aims for size and cost in a form without a clock: bytes a point, free space, and tiles that a change decides.
#include <gtest/gtest.h>

#include <algorithm>

#include "mapping/change/map_change.hpp"
#include "mapping/change/map_compaction.hpp"
#include "mapping/small_campus.hpp"
#include "rdf/file/layer_sizes.hpp"

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

TEST(CostBars, AChangeLeavesAQuarterOfTheFileFreeAtMost) {
  const SmallCampus campus({.seed = 1, .stops = 4, .size_m = 60, .points_per_stop = 20'000});
  const ScratchFolder folder;
  const fs::path map = folder.path() / "map.clx";
  buildMap(scansOf({campus.files()[0], campus.files()[1]}), shippedInputs(), map, {}, silence());
  for (const std::size_t stop : {2U, 3U}) {
    extendMap(map, scansOf({campus.files()[stop]}), {}, silence());
    EXPECT_LE(freeShare(map), kMaxFreeShareOfChanged);
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

/// The same last scan of a street, in maps of two lengths: it changes the same tiles and decides about as many.
TEST(CostBars, OneMoreScanDecidesNoMoreInALongMap) {
  const SmallCampus campus({.seed = 8, .stops = 16, .size_m = 400, .points_per_stop = 4000, .max_range_m = 16});
  const ScanSet all = scansOf(campus.files());
  std::vector<PosedScan> from_west;
  for (std::size_t i = 0; i < all.size(); ++i) from_west.push_back({i, all.file(i).T_map_sensor});
  const auto x = [](const PosedScan& scan) { return scan.T_map_sensor.translation().x(); };
  std::sort(from_west.begin(), from_west.end(), [&](const auto& a, const auto& b) { return x(a) < x(b); });
  const auto scans = [&](std::size_t first, std::size_t end) {
    return all.posed(
        {from_west.begin() + static_cast<std::ptrdiff_t>(first), from_west.begin() + static_cast<std::ptrdiff_t>(end)});
  };
  const ScratchFolder folder;
  std::vector<ChangeReport> reports;
  std::vector<std::size_t> tiles;
  for (const std::size_t first : {8U, 0U}) {
    const fs::path map = folder.path() / ("from" + std::to_string(first));
    buildMap(scans(first, all.size() - 1), shippedInputs(), map, {}, silence());
    reports.push_back(extendMap(map, scans(all.size() - 1, all.size()), {.max_window_share = 2}, silence()));
    tiles.push_back(reports.back().tiles);
  }
  EXPECT_GT(2 * tiles[1], 3 * tiles[0]);
  EXPECT_EQ(reports[0].local_commits, 1U);
  EXPECT_EQ(reports[1].local_commits, 1U);
  EXPECT_EQ(reports[0].tiles_changed, reports[1].tiles_changed);
  EXPECT_LT(2 * reports[1].tiles_decided, tiles[1]);
  // Where the short map ends, the window ends, too.
  EXPECT_LE(reports[0].tiles_decided, reports[1].tiles_decided);
  EXPECT_LE(10 * reports[1].tiles_decided, 13 * reports[0].tiles_decided);
}

}  // namespace
}  // namespace cluxel::mapping
