// SPDX-License-Identifier: Apache-2.0
// A written manifest is read back to the same scans with the given poses.
#include "scan/formats/manifest_writer.hpp"

#include "scan/registration_fixture.hpp"

namespace cluxel::test {

using namespace scan;
namespace {

TEST(ManifestWriter, ReadingGivesBackEveryBit) {
  const ScratchFolder folder;
  NoteKeeper notes;
  folder.write("scans/odd \"name\" \\ #1.xyz", "1 2 3\n2 3 4\n");
  folder.write("scans/b.xyz", "1 2 3\n2 3 5\n");
  folder.write("in.yaml",
               "map_origin: [456000.1, 5412000, 0]\ncrs: EPSG:25832\nscans:\n"
               "  - {path: 'scans/odd \"name\" \\ #1.xyz', time_s: 1699990000.123456, pose: {xyz: [1, 2, 0.1], "
               "rpy_deg: [0, 1, 33]}}\n"
               "  - {path: scans/b.xyz, pose: {xyz: [0, 0, 0]}}\n");
  const ScanSet before = ScanSet::open({folder.path() / "in.yaml"}, {}, notes);
  std::vector<PosedScan> posed;
  for (std::size_t i = 0; i < before.size(); ++i)
    posed.push_back({i, before.file(i).T_map_sensor * moveBy({0.1, 1e-7, 1 / 3.0}, {0.1, 0.2, 1 / 3.0})});
  const fs::path file = folder.path() / "other" / "out.yaml";
  folder.write("other/out.yaml", manifestText(before, posed, file, "a comment"));
  const ScanSet after = ScanSet::open({file}, {}, notes);
  ASSERT_EQ(after.size(), 2U);
  EXPECT_EQ(after.mapOrigin(), before.mapOrigin());
  EXPECT_EQ(after.crs(), before.crs());
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(after.file(i).T_map_sensor.matrix(), posed[i].T_map_sensor.matrix());
    EXPECT_EQ(after.file(i).time_s, before.file(i).time_s);
    EXPECT_EQ(after.load(i).id, before.load(i).id);
  }
}

}  // namespace
}  // namespace cluxel::test
