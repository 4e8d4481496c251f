// SPDX-License-Identifier: Apache-2.0
// What a map takes of its inputs, and what its history and its readers tell.
#include <gtest/gtest.h>

#include <atomic>
#include <limits>
#include <thread>

#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "mapping/clouds/scan_store.hpp"
#include "mapping/facts/map_history.hpp"
#include "mapping/map_state.hpp"
#include "mapping/small_campus.hpp"

namespace cluxel::mapping {

using namespace scan;
using namespace rdf;
namespace {

namespace fs = std::filesystem;

TEST(InputsHash, TellsRulesOfOtherFileNamesApartAndNotFolders) {
  const MapInputs shipped = shippedInputs();
  MapInputs moved = shipped, renamed = shipped;
  moved.sparql_rules[0].name = "/elsewhere/" + fs::path(shipped.sparql_rules[0].name).filename().string();
  renamed.sparql_rules[0].name += ".other.rq";
  EXPECT_EQ(moved.hash(), shipped.hash());
  EXPECT_NE(renamed.hash(), shipped.hash()) << "the name stands in the map";
}

TEST(DefaultInputs, AreNotTakenFromFilesOfThatNameInTheWorkingDirectory) {
  const ScratchFolder folder;
  fs::create_directory(folder.path() / "oakland");  // scans, say
  writeFile(folder.path() / "outdoor.rules.yaml", "somebody's draft");
  const MapInputs shipped = shippedInputs();
  const fs::path before = fs::current_path();
  fs::current_path(folder.path());
  MapInputs there;
  EXPECT_NO_THROW(there = shippedInputs());
  fs::current_path(before);
  EXPECT_EQ(there.hash(), shipped.hash());
}

TEST(MapHistory, NamesFilesInUtf8WhateverTheirNames) {
  const auto environment = Environment::temporary();
  WriteTransaction transaction = environment->write();
  Cloud cloud;
  cloud.source = "caf\xE9.pcd";
  MapInputs inputs;
  inputs.model.name = "mod\xC3\xA8le";
  addActivity(transaction, {"build", 0, 1}, {cloud}, inputs);
  const QuadReader reader(transaction);
  EXPECT_TRUE(reader.idOf(Term::literal("caf\xEF\xBF\xBD.pcd")));
  EXPECT_TRUE(reader.idOf(Term::literal("mod\xC3\xA8le")));
}

TEST(ScanTimes, BeyondTheYearsOfDatesAreRefused) {
  const auto environment = Environment::temporary();
  WriteTransaction transaction = environment->write();
  Scan scan;
  scan.source = "late.pcd";
  scan.points.x = scan.points.y = scan.points.z = {1.0F};
  for (const double time_s :
       {1.7e18, 2.54e11, -7e10, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    scan.time_s = time_s;
    EXPECT_THROW(storeScan(transaction, scan), InputError) << time_s;
  }
  scan.time_s = 1.7e9;
  EXPECT_EQ(storeScan(transaction, scan).size(), 1U);
}

TEST(MapReaderSnapshot, IsOneForBlocksAndQuads) {
  const ScratchFolder folder;
  const fs::path map = folder.path() / "map.clx";
  const auto environment = Environment::open(map, OpenMode::Create);
  const auto addOne = [&](std::uint32_t i) {
    WriteTransaction transaction = environment->write();
    QuadWriter writer(transaction);
    writer.add(QuadIds{i, i, i, 0});
    writer.flush();
    storeState(transaction, {true, std::to_string(i)});
    transaction.commit();
  };
  addOne(1);
  std::atomic<bool> stop = false;
  std::thread writer([&] {
    for (std::uint32_t i = 2; !stop; ++i) addOne(i);
  });
  int torn = 0;
  for (int round = 0; round < 3000; ++round) {
    const MapReader reader(map);
    torn += reader.summary().inputs_hash != std::to_string(reader.quads().size()) ? 1 : 0;
  }
  stop = true;
  writer.join();
  EXPECT_EQ(torn, 0);
}

}  // namespace
}  // namespace cluxel::mapping
