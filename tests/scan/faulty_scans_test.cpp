// SPDX-License-Identifier: Apache-2.0
// Sets of which faulty scans are left out: the others keep their poses.
#include "scan/scan_fixture.hpp"
#include "scan/scan_set.hpp"

namespace cluxel::scan {
namespace {

namespace fs = std::filesystem;

using test::refusalOf;
using test::ScratchFolder;
using testing::HasSubstr;

const std::string kTwoPoses = "1 0 0 5 0 1 0 0 0 0 1 0\n1 0 0 9 0 1 0 0 0 0 1 0\n";

ScanSet opened(const fs::path& folder, bool leaves_out_faulty) {
  ProgressSink silent;
  ScanSetParams params;
  params.leaves_out_faulty = leaves_out_faulty;
  return ScanSet::open({folder}, params, silent);
}

TEST(FaultyScans, AreLeftOutWhenAskedAndKeepTheirLinesInThePosesFile) {
  const ScratchFolder folder;
  fs::create_symlink(folder.path() / "gone", folder.path() / "a.xyz");
  folder.write("b.xyz", "4 5 6\n");
  folder.write("poses.txt", kTwoPoses);
  EXPECT_THAT(refusalOf([&] { opened(folder.path(), false); }), HasSubstr("the link leads nowhere"));
  const ScanSet set = opened(folder.path(), true);
  ASSERT_EQ(set.size(), 1U);
  EXPECT_EQ(set.file(0).T_map_sensor.translation().x(), 9);
  ASSERT_EQ(set.faulty().size(), 1U);
  EXPECT_EQ(set.faulty().front().path, folder.path() / "a.xyz");
}

TEST(FaultyScans, MayBeFilesWithoutAHeader) {
  const ScratchFolder folder;
  folder.write("a.xyz", "4 5 6\n");
  folder.write("broken.pcd", "no scan");
  EXPECT_THAT(refusalOf([&] { opened(folder.path(), false); }), HasSubstr("broken.pcd"));
  const ScanSet set = opened(folder.path(), true);
  EXPECT_EQ(set.size(), 1U);
  ASSERT_EQ(set.faulty().size(), 1U);
  EXPECT_THAT(set.faulty().front().fault.what(), HasSubstr("broken.pcd"));
}

TEST(FaultyScans, MayHaveNamesThatTellNoFrame) {
  const ScratchFolder folder;
  const std::string point(16, '\0');
  folder.write("velodyne/000001.bin", point);
  folder.write("velodyne/copy.bin", point);
  folder.write("poses.txt", kTwoPoses);
  EXPECT_THAT(refusalOf([&] { opened(folder.path(), false); }), HasSubstr("must be its frame number"));
  const ScanSet set = opened(folder.path(), true);
  ASSERT_EQ(set.size(), 1U);
  EXPECT_EQ(set.file(0).T_map_sensor.translation().x(), 9);
  EXPECT_EQ(set.faulty().size(), 1U);
}

}  // namespace
}  // namespace cluxel::scan
