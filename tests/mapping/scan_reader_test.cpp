// SPDX-License-Identifier: Apache-2.0
// Scans come in turn for any number of threads, and so do their faults.
#include "mapping/clouds/scan_reader.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "mapping/clouds/recent_scans.hpp"
#include "mapping/small_campus.hpp"

namespace cluxel::mapping {
namespace {

const CampusParams kCampus{.seed = 4, .stops = 5, .size_m = 45, .points_per_stop = 1000};

TEST(ScanReader, GivesTheScansInTurn) {
  const SmallCampus campus(kCampus);
  const ScanSet scans = scansOf(campus.files());
  for (const unsigned threads : {0U, 1U, 2U, 4U, 9U}) {
    ScanReader reader(scans, threads);
    reader.begin(0);
    for (std::size_t i = 0; i < scans.size(); ++i) EXPECT_EQ(reader.take(i).scan.cloud.id, scans.load(i).id) << threads;
  }
}

TEST(ScanReader, TellsAFaultWhenItIsTheTurnOfTheScan) {
  const SmallCampus campus(kCampus);
  const ScanSet scans = scansOf(campus.files());
  std::filesystem::resize_file(campus.files()[2], 300);
  for (const unsigned threads : {1U, 2U, 9U}) {
    ScanReader reader(scans, threads);
    EXPECT_NO_THROW(reader.take(0));
    EXPECT_NO_THROW(reader.take(1));
    EXPECT_THROW(reader.take(2), std::exception);
  }
}

TEST(RecentScans, AreTheStoredOnesInAnyOrder) {
  const SmallCampus campus(kCampus);
  const rdf::ScratchFolder folder;
  const std::filesystem::path map = folder.path() / "map.clx";
  buildMap(scansOf(campus.files()), shippedInputs(), map, {}, silence());
  const auto environment = Environment::open(map, OpenMode::ReadOnly);
  const ReadTransaction transaction = environment->read();
  const std::vector<Cloud> clouds = storedClouds(transaction);
  ASSERT_EQ(clouds.size(), 5U);
  RecentScans recent(transaction);
  for (const std::size_t i : {0U, 3U, 0U, 1U, 4U, 3U, 2U, 0U}) {
    const Scan stored = storedScan(transaction, clouds[i].id);
    EXPECT_EQ(recent.scan(clouds[i].id).id, stored.id);
    EXPECT_EQ(recent.scan(clouds[i].id).points.x, stored.points.x);
  }
}

}  // namespace
}  // namespace cluxel::mapping
