// SPDX-License-Identifier: Apache-2.0
// Poses are refined where surfaces constrain them, and kept where they do not.
#include "scan/registration/pose_registration.hpp"

#include <algorithm>

#include "scan/registration_fixture.hpp"

namespace cluxel::test {

using namespace scan;
namespace {

using Poses = std::vector<Eigen::Isometry3d>;

Poses straightDrive(std::size_t scans, double step_m = 1.5) {
  Poses poses;
  for (std::size_t i = 0; i < scans; ++i)
    poses.push_back(
        poseAt(-3 + step_m * static_cast<double>(i), 0.1 * static_cast<double>(i % 2), 2.0 * static_cast<double>(i)));
  return poses;
}

/// Errors that accumulate from pose to pose.
Poses drifting(const Poses& truth, const Eigen::Isometry3d& error) {
  Poses given{truth.front()};
  for (std::size_t i = 1; i < truth.size(); ++i)
    given.push_back(given.back() * (truth[i - 1].inverse() * truth[i]) * error);
  return given;
}

TEST(PoseRegistration, RefinesPosesThatDrift) {
  const ScratchFolder folder;
  const Poses truth = straightDrive(4);
  const Drive drive =
      writeDrive(folder, yardPlace(), truth, drifting(truth, moveBy({0.10, 0.03, 0.02}, {0.1, 0.1, 0.4})));
  PoseRegistration report;
  const Poses poses = refinedPoses(drive, report);
  for (std::size_t i = 1; i < truth.size(); ++i) {
    EXPECT_GT(errorBetween(drive.given, truth, i - 1, i).translation().norm(), 0.1);
    EXPECT_LT(errorBetween(poses, truth, i - 1, i).translation().norm(), 0.01) << i;
    EXPECT_LT(angle_deg(errorBetween(poses, truth, i - 1, i)), 0.05) << i;
  }
  EXPECT_GT(report.residual_before_m, 0.04);
  EXPECT_LT(report.residual_after_m, 0.02);
  for (const RefinedScan& scan : report.scans) EXPECT_GE(scan.pairs, 2U);
}

TEST(PoseRegistration, ChangesAllPosesAsAWholeAsLittleAsItCan) {
  const ScratchFolder folder;
  const Poses truth = straightDrive(3);
  Poses given = truth;
  given[1] = given[1] * moveBy({0.15, 0, 0}, {0, 0, 0});
  PoseRegistration report;
  const Poses poses = refinedPoses(writeDrive(folder, yardPlace(), truth, given), report);
  for (const RegisteredPair& pair : report.pairs)
    EXPECT_EQ(pair.outcome, PairOutcome::Used)
        << pair.first << " - " << pair.second << ": " << nameOf(pair.outcome) << ", overlap " << pair.overlap
        << ", residual " << pair.residual_before_m << " -> " << pair.residual_after_m;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < 3; ++i) sum += poses[i].translation() - given[i].translation();
  EXPECT_LT(sum.norm() / 3, 0.005) << "the mean stays where it was";
  EXPECT_NEAR((poses[1].translation() - given[1].translation()).norm(), 0.10, 0.01) << "two thirds of what was wrong";
}

TEST(PoseRegistration, SomePointsMeasureWhatAllDo) {
  const ScratchFolder folder;
  NoteKeeper notes;
  const Poses truth = straightDrive(4);
  const Drive drive = writeDrive(folder, yardPlace(), truth, drifting(truth, moveBy({0.10, 0.03, 0.02}, {0, 0, 0})));
  const ScanSet set = ScanSet::open(drive.files, {}, notes);
  const PoseRegistration all = measurePoses(set, {}, 1, notes);
  const PoseRegistration some = measurePoses(set, {.max_compared = 3000}, 2, notes);
  EXPECT_GT(all.residual_before_m, 0.05);
  EXPECT_NE(some.residual_before_m, all.residual_before_m) << "all points were compared";
  EXPECT_NEAR(some.residual_before_m, all.residual_before_m, 0.01);
  ASSERT_EQ(some.pairs.size(), all.pairs.size());
  for (std::size_t i = 0; i < all.pairs.size(); ++i) EXPECT_NEAR(some.pairs[i].overlap, all.pairs[i].overlap, 0.1) << i;
}

TEST(PoseRegistration, ASampleIsOfNearScansSpreadOverTheSet) {
  const ScratchFolder folder;
  NoteKeeper notes;
  const Drive drive = writeDrive(folder, plainPlace(), straightDrive(9, 3.0), straightDrive(9, 3.0));
  const ScanSet set = ScanSet::open(drive.files, {}, notes);
  std::vector<std::size_t> chosen;
  for (const PosedScan& scan : sampledNeighbours(set)) {
    chosen.push_back(scan.index);
    EXPECT_EQ(scan.T_map_sensor.matrix(), set.file(scan.index).T_map_sensor.matrix());
  }
  EXPECT_EQ(chosen, (std::vector<std::size_t>{0, 1, 3, 4, 7, 8})) << "first, middle and last, each with its nearest";
  EXPECT_EQ(sampledNeighbours(ScanSet::open({drive.files[0], drive.files[1]}, {}, notes)).size(), 2U);
  EXPECT_TRUE(sampledNeighbours(ScanSet::open({drive.files[0]}, {}, notes)).empty());
}

TEST(PoseRegistration, LeavesRightPosesRight) {
  const ScratchFolder folder;
  const Poses truth = straightDrive(3);
  PoseRegistration report;
  const Poses poses = refinedPoses(writeDrive(folder, yardPlace(), truth, truth), report);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    EXPECT_LT((truth[i].inverse() * poses[i]).translation().norm(), 0.01);
    EXPECT_LT(angle_deg(truth[i].inverse() * poses[i]), 0.05);
  }
}

TEST(PoseRegistration, GivesTheSameBytesForAnyOrderAndNumberOfThreads) {
  const ScratchFolder folder;
  const Poses truth = straightDrive(4);
  Drive drive = writeDrive(folder, yardPlace(), truth, drifting(truth, moveBy({0.05, 0, 0}, {0, 0, 0.2})));
  NoteKeeper notes;
  const auto manifestOf = [&](unsigned threads) {
    const ScanSet set = ScanSet::open(drive.files, {}, notes);
    return manifestText(set, registerPoses(set, {}, threads, notes).poses(), folder.path() / "refined.yaml", "test");
  };
  const std::string once = manifestOf(1);
  EXPECT_EQ(manifestOf(2), once);
  std::rotate(drive.files.begin(), drive.files.begin() + 2, drive.files.end());
  std::swap(drive.files[0], drive.files[1]);
  EXPECT_EQ(manifestOf(2), once);
}

TEST(PoseRegistration, KeepsTheGivenPlaceAlongACorridor) {
  const ScratchFolder folder;
  Poses truth{poseAt(-2, 0, 0), poseAt(-1, 0, 0), poseAt(0, 0.1, 0), poseAt(1, 0, 0)};
  const Poses given = drifting(truth, moveBy({0.10, 0.05, 0}, {0, 0, 0.3}));
  PoseRegistration report;
  const Poses poses = refinedPoses(writeDrive(folder, corridorPlace(), truth, given), report);
  for (std::size_t i = 1; i < truth.size(); ++i) {
    const Eigen::Isometry3d error = errorBetween(poses, truth, i - 1, i);
    EXPECT_LT(std::abs(error.translation().y()), 0.01) << "walls tell how far to the left";
    EXPECT_LT(angle_deg(error), 0.05);
    EXPECT_NEAR(error.translation().x(), 0.10, 0.01) << "nothing tells how far ahead: what was given stays";
  }
}

TEST(PoseRegistration, KeepsPlaceAndHeadingOnABarePlane) {
  const ScratchFolder folder;
  const Poses truth{poseAt(-1, 0, 0), poseAt(0, 0, 5), poseAt(1, 0, 10)};
  const Poses given = drifting(truth, moveBy({0.08, -0.06, 0.05}, {0.3, 0.2, 0.5}));
  PoseRegistration report;
  const Poses poses = refinedPoses(writeDrive(folder, plainPlace(), truth, given), report);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Eigen::Isometry3d moved = given[i].inverse() * poses[i];
    EXPECT_LT(moved.translation().head<2>().norm(), 0.01) << i;
    EXPECT_LT(std::abs(std::atan2(moved(1, 0), moved(0, 0))) * 180 / M_PI, 0.05) << i;
  }
  const Eigen::Isometry3d error = errorBetween(poses, truth, 0, 2);
  EXPECT_LT(std::abs(error.translation().z()), 0.01) << "the ground tells the height";
}

TEST(PoseRegistration, AScanFarFromAllOthersKeepsItsPoseToTheLastBit) {
  const ScratchFolder folder;
  Poses truth = straightDrive(3);
  Poses given = drifting(truth, moveBy({0.05, 0, 0}, {0, 0, 0}));
  truth.push_back(poseAt(0, 0, 0));
  given.push_back(poseAt(3000, 0, 7));
  PoseRegistration report;
  const Poses poses = refinedPoses(writeDrive(folder, yardPlace(), truth, given), report);
  EXPECT_EQ(poses[3].matrix(), ScanSet::open({folder.path() / "drive_3.pcd"}, {}, *std::make_unique<NoteKeeper>())
                                   .file(0)
                                   .T_map_sensor.matrix());
  EXPECT_EQ(report.scans[3].pairs, 0U);
  EXPECT_LT(errorBetween(poses, truth, 0, 2).translation().norm(), 0.01) << "the others are refined";
}

TEST(PoseRegistration, TellsGroupsThatNothingJoins) {
  const ScratchFolder folder;
  Poses truth = straightDrive(2), given = truth;
  for (std::size_t i = 0; i < 2; ++i) {
    truth.push_back(poseAt(static_cast<double>(i), 2, 20));
    given.push_back(Eigen::Translation3d(500, 0, 0) * truth.back());
  }
  given[1] = given[1] * moveBy({0.1, 0, 0}, {0, 0, 0});
  PoseRegistration report;
  const Poses poses = refinedPoses(writeDrive(folder, yardPlace(), truth, given), report);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(report.scans[i].group, i < 2 ? 0U : 2U);
  EXPECT_LT(errorBetween(poses, truth, 0, 1).translation().norm(), 0.01);
  EXPECT_LT((poses[2].translation() - given[2].translation()).norm(), 0.01);
}

TEST(PoseRegistration, LeavesOutAScanThatIsNotWhereItsPoseSays) {
  const ScratchFolder folder;
  const Poses truth = straightDrive(4);
  Poses given = truth;
  given[2] = given[2] * moveBy({3, 4, 0}, {0, 0, 40});
  PoseRegistration report;
  const Poses poses = refinedPoses(writeDrive(folder, yardPlace(), truth, given), report);
  EXPECT_EQ(report.scans[2].pairs, 0U);
  EXPECT_LT((given[2].inverse() * poses[2]).translation().norm(), 1e-9);
  EXPECT_LT(errorBetween(poses, truth, 0, 3).translation().norm(), 0.01) << "the others are not led astray";
  EXPECT_TRUE(std::any_of(report.pairs.begin(), report.pairs.end(), [](const auto& pair) {
    return (pair.first == 2 || pair.second == 2) && pair.outcome != PairOutcome::Used;
  }));
}

TEST(PoseRegistration, TwoScansShareTheCorrectionAndOneIsLeftAlone) {
  const ScratchFolder folder;
  const Poses truth = straightDrive(2);
  Drive drive = writeDrive(folder, yardPlace(), truth, drifting(truth, moveBy({0.12, 0, 0}, {0, 0, 0.3})));
  PoseRegistration report;
  const Poses poses = refinedPoses(drive, report);
  EXPECT_LT(errorBetween(poses, truth, 0, 1).translation().norm(), 0.01);
  ASSERT_EQ(report.scans.size(), 2U);
  EXPECT_NEAR(report.scans[0].shift_m, report.scans[1].shift_m, 0.02);
  drive.files.resize(1);
  refinedPoses(drive, report);
  EXPECT_TRUE(report.pairs.empty());
  EXPECT_EQ(report.scans[0].shift_m, 0);
}

TEST(PoseRegistration, MeasuringTellsRightPosesFromWrongOnesAndChangesNone) {
  const ScratchFolder right, wrong;
  const Poses truth = straightDrive(3);
  NoteKeeper notes;
  const auto worst = [&](const ScratchFolder& folder, const Poses& given) {
    const Drive drive = writeDrive(folder, yardPlace(), truth, given);
    const PoseRegistration report = measurePoses(ScanSet::open(drive.files, {}, notes), {}, 1, notes);
    double worst_m = 0;
    for (const RegisteredPair& pair : report.pairs) worst_m = std::max(worst_m, pair.residual_before_m);
    for (const RefinedScan& scan : report.scans) EXPECT_EQ(scan.shift_m, 0);
    return worst_m;
  };
  EXPECT_LT(worst(right, truth), 0.02);
  EXPECT_GT(worst(wrong, drifting(truth, moveBy({0.12, 0, 0}, {0, 0, 0}))), 0.05);
}

TEST(PoseRegistration, RefusesScansWithoutPosesAndScansWithTwo) {
  const ScratchFolder folder;
  NoteKeeper notes;
  folder.write("a.xyz", "1 2 3\n2 3 4\n");
  const ScanSet unposed = ScanSet::open({folder.path() / "a.xyz"}, {}, notes);
  const std::string refusal = refusalOf([&] { registerPoses(unposed, {}, 1, notes); });
  EXPECT_NE(refusal.find("a.xyz"), std::string::npos) << refusal;
  EXPECT_NE(refusal.find("name a poses file"), std::string::npos) << refusal;
  const Drive drive = writeDrive(folder, yardPlace(), {poseAt(0, 0, 0)}, {poseAt(0, 0, 0)});
  const ScanSet same = ScanSet::open({drive.files[0], drive.files[0]}, {}, notes);
  EXPECT_EQ(registerPoses(same, {}, 1, notes).scans.size(), 1U) << "once";
  folder.write(
      "two.yaml",
      "scans:\n  - {path: drive_0.pcd, pose: {xyz: [0, 0, 0]}}\n  - {path: drive_0.pcd, pose: {xyz: [1, 0, 0]}}\n");
  const ScanSet two = ScanSet::open({folder.path() / "two.yaml"}, {}, notes);
  EXPECT_NE(refusalOf([&] { registerPoses(two, {}, 1, notes); }).find("another pose"), std::string::npos);
}

TEST(PoseRegistration, ScansOfFewPointsAreLeftAlone) {
  const ScratchFolder folder;
  NoteKeeper notes;
  folder.write("few.yaml",
               "scans:\n  - {path: a.xyz, pose: {xyz: [0, 0, 0]}}\n  - {path: b.xyz, pose: {xyz: [1, 0, 0]}}\n");
  folder.write("a.xyz", "1 2 3\n2 3 4\n");
  folder.write("b.xyz", "1 2 3\n2 3 5\n");
  const PoseRegistration report = registerPoses(ScanSet::open({folder.path() / "few.yaml"}, {}, notes), {}, 1, notes);
  for (const RefinedScan& scan : report.scans) EXPECT_EQ(scan.pairs, 0U);
}

}  // namespace
}  // namespace cluxel::test
