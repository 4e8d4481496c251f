// SPDX-License-Identifier: Apache-2.0
// A path of a scan is not taken for another scan that the file holds now.
#include "mapping/change/named_clouds.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "cluxel/error.hpp"
#include "mapping/small_campus.hpp"

namespace cluxel::mapping {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

class NamedClouds : public testing::Test, public ProgressSink {
 protected:
  void SetUp() override {
    const SmallCampus campus({.seed = 6, .stops = 3, .size_m = 45, .points_per_stop = 1000});
    for (std::size_t i = 0; i < 3; ++i) fs::copy_file(campus.files()[i], file(i));
    const ScanSet scans = scansOf({file(0), file(1)});
    buildMap(scans, shippedInputs(), map(), {}, silence());
    for (std::size_t i = 0; i < 2; ++i) ids.push_back(scans.load(i).id);
  }
  void note(std::string_view text) override { notes.append(text); }

  fs::path map() const { return folder.path() / "map.clx"; }
  fs::path file(std::size_t i) const { return folder.path() / ("scan" + std::to_string(i) + ".pcd"); }
  std::vector<ScanId> named(const std::string& name, CompareFiles compare = CompareFiles::Yes) {
    return cloudsNamed(map(), std::vector{name}, *this, {IncludeRetracted::No, compare});
  }

  ScratchFolder folder;
  std::vector<ScanId> ids;
  std::string notes;
};

TEST_F(NamedClouds, AreThoseThatTheirFilesHold) {
  EXPECT_THAT(named(file(0)), ElementsAre(ids[0]));
  EXPECT_THAT(named("scan1"), ElementsAre(ids[1]));
  EXPECT_EQ(notes, "");
}

TEST_F(NamedClouds, AreRefusedWhenFilesWereSwapped) {
  fs::rename(file(0), file(2));
  fs::rename(file(1), file(0));
  fs::rename(file(2), file(1));
  for (std::size_t i = 0; i < 2; ++i) {
    try {
      named(file(i));
      ADD_FAILURE() << "was not refused";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::InvalidArgument);
      EXPECT_THAT(error.what(), HasSubstr(file(i).string() + ": holds cloud " + ids[1 - i].hex() + " now"));
      EXPECT_THAT(error.what(), HasSubstr("is cloud " + ids[i].hex() + ". Name one of them by its id"));
    }
    EXPECT_THAT(named(ids[i].hex().substr(0, 8)), ElementsAre(ids[i])) << "the id is plain";
    EXPECT_THAT(named(file(i), CompareFiles::No), ElementsAre(ids[i])) << "what was read from it";
    EXPECT_EQ(notes, "");
  }
}

TEST_F(NamedClouds, OfFilesWithOtherScansAreNoted) {
  fs::rename(file(2), file(0));
  EXPECT_THAT(named(file(0)), ElementsAre(ids[0]));
  EXPECT_THAT(notes, HasSubstr("is taken for cloud " + ids[0].hex()));
  notes.clear();
  std::ofstream(file(0)) << "no scan";
  EXPECT_THAT(named(file(0)), ElementsAre(ids[0]));
  fs::remove(file(0));
  EXPECT_THAT(named(file(0)), ElementsAre(ids[0]));
  EXPECT_EQ(notes, "") << "nothing is known of what the file holds";
}

}  // namespace
}  // namespace cluxel::mapping
