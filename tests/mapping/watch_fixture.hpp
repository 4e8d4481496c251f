// SPDX-License-Identifier: Apache-2.0
// Fixture for tests of watched folders: scans that arrive in a folder, and a watch that runs until something is so.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <iomanip>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "mapping/small_campus.hpp"
#include "mapping/watch/folder_watch.hpp"

namespace cluxel::mapping {

class Notes : public ProgressSink {
 public:
  void note(std::string_view message) override { all.emplace_back(message); }
  bool has(std::string_view text) const { return count(text) > 0; }
  std::size_t count(std::string_view text) const {
    return std::count_if(all.begin(), all.end(),
                         [&](const std::string& note) { return note.find(text) != std::string::npos; });
  }
  std::vector<std::string> all;
};

class FolderWatch : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    campus = new SmallCampus({.seed = 8, .stops = 3, .size_m = 45, .points_per_stop = 1000});
    inputs = new MapInputs(shippedInputs());
  }
  static void TearDownTestSuite() {
    delete campus;
    delete inputs;
  }

  FolderWatch() { std::filesystem::create_directory(scans()); }
  std::filesystem::path scans() const { return folder.path() / "scans"; }
  std::filesystem::path map() const { return folder.path() / "map.clx"; }

  /// Writes the file in two steps, as a slow recorder does.
  void arrive(std::size_t number) const {
    const std::string bytes = readFile(campus->files()[number]);
    const std::filesystem::path file = scans() / campus->files()[number].filename();
    writeFile(file, bytes.substr(0, bytes.size() / 2));
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    writeFile(file, bytes);
  }

  /// Watches until `count` scans are in the map; `each` runs after each commit.
  std::size_t watch(std::size_t count, const std::function<void(std::size_t)>& each) {
    WatchCallbacks callbacks;
    std::size_t in_map = 0;
    callbacks.inputs = [] { return *inputs; };
    callbacks.committed = [&](const WatchCommit& commit) { each(in_map = commit.scans); };
    callbacks.is_stopped = [&] { return in_map >= count; };
    return watchFolder(scans(), map(), {.threads = 1, .interval_s = 0.05, .idle_s = 120}, callbacks, notes);
  }

  /// Watches until `isDone`, which is asked before each look and may change the folder.
  std::size_t watchUntil(const std::function<bool()>& isDone) {
    WatchCallbacks callbacks;
    callbacks.inputs = [] { return *inputs; };
    callbacks.is_stopped = isDone;
    callbacks.committed = [&](const WatchCommit& commit) { scans_in_map = commit.scans, ++commits; };
    return watchFolder(scans(), map(), {.threads = 1, .interval_s = 0.05, .idle_s = 120}, callbacks, notes);
  }
  /// Watches until nothing happens any more.
  std::size_t watchUntilIdle() {
    WatchCallbacks callbacks;
    callbacks.inputs = [] { return *inputs; };
    return watchFolder(scans(), map(), {.threads = 1, .interval_s = 0.05, .idle_s = 0.4}, callbacks, notes);
  }
  std::string builtOfFolder() const { return builtText({scans()}, *inputs); }

  rdf::ScratchFolder folder;
  Notes notes;
  std::size_t scans_in_map = 0, commits = 0;
  static inline SmallCampus* campus = nullptr;
  static inline MapInputs* inputs = nullptr;
};

/// Writes poses of the first scans, the x of the first one shifted.
inline void writePoses(const std::filesystem::path& file, const std::vector<std::filesystem::path>& scans,
                       std::size_t count, double shift_m) {
  std::ostringstream text;
  text << std::setprecision(17);
  for (std::size_t i = 0; i < count; ++i) {
    Eigen::Matrix4d pose = scansOf({scans[i]}).file(0).T_map_sensor.matrix();
    if (i == 0) pose(0, 3) += shift_m;
    for (int row = 0; row < 4; ++row)
      for (int column = 0; column < 4; ++column) text << pose(row, column) << ' ';
    text << '\n';
  }
  writeFile(file, text.str());
}

}  // namespace cluxel::mapping
