// SPDX-License-Identifier: Apache-2.0
// Wrong poses refined on the command line, and what `register` refuses.
#include <array>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "app/program_fixture.hpp"

namespace cluxel::app {

using namespace rdf;
namespace {

using Json = nlohmann::json;

class RegisterCommand : public Program {
 protected:
  static void SetUpTestSuite() {
    folder = new ScratchFolder;
    made = run("simulate " + path("drive").string() +
               " --laser spinning --stops 3 --stop-distance 1 --size 50 --points-per-stop 20000 --drift 0.12 --seed 3");
    refined = run("register " + path("drive").string() + " -o " + path("refined.yaml").string() + " --json");
  }
  static inline Outcome made, refined;
};

TEST_F(RegisterCommand, RefinesPosesAndBuildTakesThem) {
  ASSERT_EQ(made.code, 0) << made.err;
  ASSERT_EQ(refined.code, 0) << refined.err;
  const Json report = Json::parse(refined.out);
  EXPECT_GT(report.at("residual_before_m"), 2 * report.at("residual_after_m").get<double>());
  ASSERT_EQ(report.at("scans").size(), 3U);
  double farthest_m = 0;
  for (const Json& scan : report.at("scans")) farthest_m = std::max(farthest_m, scan.at("shift_m").get<double>());
  EXPECT_NEAR(farthest_m, 0.12, 0.06) << "half of two drifts";
  const Json info = Json::parse(run("info --json " + path("refined.yaml").string()).out);
  EXPECT_EQ(info.at("points"), Json::parse(run("info --json " + path("drive").string()).out).at("points"));
  const Outcome built =
      run("build " + path("refined.yaml").string() + " -o " + path("refined.clx").string() + " --json");
  EXPECT_EQ(built.code, 0) << built.err;
  EXPECT_EQ(Json::parse(built.out).at("scans"), 3);
}

TEST_F(RegisterCommand, BuildRefinesThemItselfIntoTheSameMap) {
  const std::string one = path("by_manifest.clx").string(), other = path("by_build.clx").string();
  ASSERT_EQ(run("build " + path("refined.yaml").string() + " -o " + one).code, 0);
  const Outcome built = run("build --register " + path("drive").string() + " -o " + other);
  ASSERT_EQ(built.code, 0) << built.err;
  EXPECT_NE(built.err.find("pairs of scans used, median residual"), std::string::npos) << built.err;
  EXPECT_NE(built.err.find("0 of 3 scans keep their pose"), std::string::npos) << built.err;
  EXPECT_EQ(built.err.find("do not fit"), std::string::npos) << built.err;
  const Outcome again = run("build --register " + path("drive").string() + " -o " + other);
  EXPECT_EQ(again.code, 2) << "the finished map is refused ...";
  EXPECT_EQ(again.err.find("poses refined"), std::string::npos) << "... before minutes go into poses: " << again.err;
  const std::string expected = run("export --canonical " + one).out;
  EXPECT_GT(expected.size(), 1000U);
  EXPECT_EQ(run("export --canonical " + other).out, expected);
}

TEST_F(RegisterCommand, BuildSaysThatPosesDoNotFitAndTakesThemAsGiven) {
  const Outcome wrong = run("build " + path("drive").string() + " -o " + path("wrong.clx").string());
  ASSERT_EQ(wrong.code, 0) << wrong.err;
  EXPECT_NE(wrong.err.find("poses do not fit each other"), std::string::npos) << wrong.err;
  EXPECT_NE(wrong.err.find("refine the poses"), std::string::npos) << wrong.err;
  const Outcome right = run("build --force " + path("refined.yaml").string() + " -o " + path("wrong.clx").string());
  ASSERT_EQ(right.code, 0) << right.err;
  EXPECT_EQ(right.err.find("do not fit"), std::string::npos) << right.err;
}

TEST_F(RegisterCommand, CheckIsExitCodeOneForWrongPosesAndZeroForRefinedOnes) {
  const Outcome wrong = run("register --check --json " + path("drive").string());
  EXPECT_EQ(wrong.code, 1) << wrong.err;
  EXPECT_GT(Json::parse(wrong.out).at("worst_residual_m"), 0.05);
  const Outcome right = run("register --check " + path("refined.yaml").string());
  EXPECT_EQ(right.code, 0) << right.out;
  EXPECT_NE(right.out.find("worst residual"), std::string::npos);
  const Outcome strict = run("register --check --max-residual 0.0001 " + path("refined.yaml").string());
  EXPECT_EQ(strict.code, 1);
  EXPECT_NE(strict.out.find(": above --max-residual 0.0001 m"), std::string::npos) << strict.out;
  EXPECT_EQ(run("register --check --max-residual 5 " + path("drive").string()).code, 0);
}

TEST_F(RegisterCommand, CheckIsExitCodeOneWhenAScanIsTooFarOffToBeCompared) {
  const std::string right = path("exact").string();
  ASSERT_EQ(run("simulate " + right + " --stops 3 --size 50 --points-per-stop 20000").code, 0);
  EXPECT_EQ(run("register --check " + right).code, 0);
  for (const char* off : {"0 0 3", "4 -3 0", "100 0 0", "0 0 30"}) {
    std::ifstream poses(right + "/poses.txt");
    std::ofstream wrong(path("wrong.txt"));
    std::istringstream by(off);
    std::array<double, 3> shift{};
    for (double& part : shift) by >> part;
    std::string line;
    for (int number = 0; std::getline(poses, line);) {
      if (line.starts_with('#')) continue;
      std::istringstream values(line);
      for (int i = 0; i < 16; ++i) {
        double value = 0;
        values >> value;
        if (number == 1 && i % 4 == 3 && i < 12) value += shift[static_cast<std::size_t>(i / 4)];
        wrong << value << (i == 15 ? "\n" : " ");
      }
      ++number;
    }
    wrong.close();
    const Outcome check = run("register --check --json " + right + " --poses " + path("wrong.txt").string());
    EXPECT_EQ(check.code, 1) << off << "\n" << check.out;
    EXPECT_FALSE(Json::parse(check.out).at("fits").get<bool>());
  }
}

TEST_F(RegisterCommand, TheBytesDoNotDependOnTheOrderOfScans) {
  std::string scans;
  for (const char* name : {"scan_002.pcd", "scan_000.pcd", "scan_001.pcd"})
    scans += path("drive").string() + "/" + name + " ";
  const std::string again = path("again.yaml").string();
  ASSERT_EQ(run("register " + scans + " -o " + again).code, 0);
  EXPECT_EQ(readFile(again), readFile(path("refined.yaml")));
}

TEST_F(RegisterCommand, RefusesWhatItCannotDoAndTouchesNothing) {
  const std::string drive = path("drive").string(), out = path("refined.yaml").string(), before = readFile(out);
  expectError(run("register " + drive), 2, "-o FILE.yaml");
  expectError(run("register --check " + drive + " -o " + path("x.yaml").string()), 2, "leave out -o");
  expectError(run("register " + drive + " -o " + path("poses.txt").string()), 2, "*.yaml");
  expectError(run("register --check --max-residual 0 " + drive), 2, "above 0");
  expectError(run("register " + drive + " -o " + out), 5, "--force");
  EXPECT_EQ(readFile(out), before);
  EXPECT_EQ(run("register " + drive + " -o " + out + " --force").code, 0);
  EXPECT_EQ(readFile(out), before);
  writeFile(path("lone.xyz"), "1 2 3\n4 5 6\n");
  expectError(run("register " + path("lone.xyz").string() + " -o " + path("lone.yaml").string()), 4, "has no pose");
  EXPECT_FALSE(fs::exists(path("lone.yaml")));
  expectError(run("register " + path("absent").string() + " --check"), 4, "absent");
}

TEST_F(RegisterCommand, SimulatedDriftIsWrittenBesideTheTruth) {
  EXPECT_TRUE(fs::exists(path("drive/true_poses.txt")));
  EXPECT_NE(readFile(path("drive/true_poses.txt")), readFile(path("drive/poses.txt")));
  ASSERT_EQ(run("simulate " + path("right").string() + " --stops 1 --size 50 --points-per-stop 2000").code, 0);
  EXPECT_FALSE(fs::exists(path("right/true_poses.txt")));
  expectError(run("simulate " + path("no").string() + " --laser radar"), 2, "");
}

}  // namespace
}  // namespace cluxel::app
