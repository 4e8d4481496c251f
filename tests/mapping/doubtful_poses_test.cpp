// SPDX-License-Identifier: Apache-2.0
// Which poses a build doubts: those of another place, another scan or another heading, and never the true ones.
#include "mapping/build/build_poses.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "mapping/small_campus.hpp"
#include "scan/registration/pose_registration.hpp"
#include "scan/scan_fixture.hpp"

namespace cluxel::mapping {
namespace {

using testing::AnyOf;
using testing::HasSubstr;
using testing::IsEmpty;

using Poses = std::vector<Eigen::Isometry3d>;

class DoubtfulPoses : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    campus = new SmallCampus({.seed = 2, .stops = 6, .size_m = 80, .points_per_stop = 15'000});
    set = new ScanSet(scansOf(campus->files()));
  }
  static void TearDownTestSuite() {
    delete set;
    delete campus;
  }

  static Poses truePoses() {
    Poses poses;
    for (std::size_t i = 0; i < set->size(); ++i) poses.push_back(set->file(i).T_map_sensor);
    return poses;
  }
  /// What is noted when the scans have these poses.
  static std::string notesOn(const Poses& poses) {
    std::vector<PosedScan> posed;
    for (std::size_t i = 0; i < poses.size(); ++i) posed.push_back({i, poses[i]});
    return notesOn(set->posed(posed));
  }
  static std::string notesOn(const ScanSet& scans) {
    test::NoteKeeper sink;
    noteDoubtfulPoses(scans, 2, sink);
    std::string notes;
    for (const std::string& note : sink.notes) notes += note + '\n';
    return notes;
  }
  static Poses withScanAt(std::size_t scan, const Eigen::Isometry3d& T_true_given) {
    Poses poses = truePoses();
    poses[scan] = poses[scan] * T_true_given;
    return poses;
  }

  static inline SmallCampus* campus = nullptr;
  static inline ScanSet* set = nullptr;
};

TEST_F(DoubtfulPoses, AreNotTheTrueOnes) {
  EXPECT_THAT(notesOn(truePoses()), IsEmpty());
}

TEST_F(DoubtfulPoses, AreThoseOfOneScanAmongRightOnes) {
  Eigen::Isometry3d turned = Eigen::Isometry3d::Identity();
  turned.rotate(Eigen::AngleAxisd(0.35, Eigen::Vector3d::UnitZ()));
  for (const std::size_t scan : {0U, 2U, 5U}) {
    const auto is_doubted = AnyOf(HasSubstr("poses do not fit each other"), HasSubstr("poses may be wrong"));
    const Eigen::Isometry3d shifted(Eigen::Translation3d(0.9, 1.2, 0));
    EXPECT_THAT(notesOn(withScanAt(scan, shifted)), is_doubted) << scan;
    EXPECT_THAT(notesOn(withScanAt(scan, turned)), is_doubted) << scan;
  }
}

TEST_F(DoubtfulPoses, AreThoseOfATrackThatRunsBackwards) {
  Poses poses = truePoses();
  std::reverse(poses.begin(), poses.end());
  EXPECT_THAT(notesOn(poses), HasSubstr("poses may be wrong, or a wall or floor lies between scans: "));
}

TEST_F(DoubtfulPoses, AreNotThoseOfAnotherFloor) {
  for (const std::size_t scan : {0U, 2U, 5U})
    EXPECT_THAT(notesOn(withScanAt(scan, Eigen::Isometry3d(Eigen::Translation3d(0, 0, 30)))), IsEmpty()) << scan;
}

TEST_F(DoubtfulPoses, NameTheScansThatFitWorst) {
  Poses poses = truePoses();
  for (std::size_t i = 0; i < poses.size(); ++i) poses[i].pretranslate(Eigen::Vector3d(0, 0, i % 2 == 0 ? 0 : 0.15));
  EXPECT_THAT(notesOn(poses),
              testing::ContainsRegex("median of the scans examined\\), those of .* and .* 0\\.[0-9]+ m"));
}

TEST_F(DoubtfulPoses, HaveASpacingThatIsANumber) {
  const ScratchFolder folder;
  std::ofstream(folder.path() / "a.xyz") << "1 2 3\n1 2 4\n1 3 4\n";
  std::ofstream(folder.path() / "b.xyz") << "1 2 3\n1 2 4\n1 3 5\n";
  std::ofstream(folder.path() / "m.yaml") << "scans:\n"
                                             "  - {path: a.xyz, pose: {xyz: [0, 0, 0]}}\n"
                                             "  - {path: b.xyz, pose: {xyz: [0, 0, 1]}}\n";
  const auto found = measurePoses(scansOf({folder.path() / "m.yaml"}), {}, 1, silence());
  ASSERT_EQ(found.pairs.size(), 1U);
  EXPECT_TRUE(std::isinf(found.pairs[0].spacing));
}

TEST_F(DoubtfulPoses, AreFoundBesideScansWithoutAPose) {
  const ScratchFolder folder;
  std::ofstream(folder.path() / "a.xyz") << "1 2 3\n";
  std::vector<std::filesystem::path> files = campus->files();
  files.insert(files.begin() + 1, folder.path() / "a.xyz");
  const ScanSet mixed = scansOf(files);
  EXPECT_THAT(notesOn(mixed), IsEmpty());
  std::vector<std::size_t> posed;
  for (const PosedScan& scan : sampledNeighbours(mixed)) posed.push_back(scan.index);
  EXPECT_THAT(posed, testing::Not(IsEmpty()));
  EXPECT_THAT(posed, testing::Not(testing::Contains(1U)));
}

}  // namespace
}  // namespace cluxel::mapping
