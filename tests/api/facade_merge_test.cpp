// SPDX-License-Identifier: Apache-2.0
// Merges by the facade give the map that building gives, with a transform, chosen inputs, by force, and only in words.
#include <gmock/gmock.h>

#include <limits>

#include "api/facade_campus.hpp"
#include "base/file_bytes.hpp"

namespace cluxel {
namespace {

namespace fs = std::filesystem;

using Matrix = std::array<double, 16>;

Matrix shiftAlongX(double shift_m) {
  return {1, 0, 0, shift_m, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
}

/// Canonical texts are compared by ==: the differences that GoogleTest would show of them take too much memory.
class FacadeMerge : public ::testing::Test {
 protected:
  Map built(const std::vector<fs::path>& scans, const std::string& name, const fs::path& rules = {}) const {
    BuildOptions options = FacadeCampus::options();
    if (!rules.empty()) options.rules = {rules};
    return Map::build(scans, folder.path() / name, options);
  }
  std::string canonicalMerge(const std::vector<fs::path>& maps, const MergeOptions& options) {
    const fs::path target = folder.path() / ("merged" + std::to_string(++merges) + ".clx");
    return mapping::canonicalText(Map::merge(maps, target, options, silence).file());
  }
  /// The message of the Error (InvalidArgument) that a merge throws; it writes nothing.
  std::string refusalOf(const std::vector<fs::path>& maps, const MergeOptions& options, Remedy remedy) {
    const fs::path target = folder.path() / "refused.clx";
    try {
      Map::mergeInto(maps, target, options, silence);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::InvalidArgument) << error.what();
      EXPECT_EQ(error.remedy(), remedy) << error.what();
      EXPECT_FALSE(fs::exists(target));
      return error.what();
    }
    return "none";
  }

  rdf::ScratchFolder folder;
  const std::vector<fs::path> files = FacadeCampus::shared().campus.files();
  const std::vector<fs::path> first{files.front()}, rest{files.begin() + 1, files.end()};
  ProgressSink silence;
  int merges = 0;
};

TEST_F(FacadeMerge, ATransformTakesTheSecondMapToTheFirst) {
  const Map a = built(first, "a.clx");
  Map b = built(rest, "b.clx");
  const std::string whole = mapping::canonicalText(FacadeCampus::shared().map.file());
  EXPECT_TRUE(canonicalMerge({a.file(), b.file()}, {.T_first_second = shiftAlongX(0)}) == whole);
  std::vector<CloudPose> moved;
  for (const Cloud& cloud : b.clouds()) {
    moved.push_back({cloud.id, cloud.T_map_sensor});
    moved.back().T_map_sensor[3] += 64;  // four tiles, and exact in binary
  }
  b.repose(moved, {}, silence);
  const MergeOptions back{.T_first_second = shiftAlongX(-64)};
  EXPECT_TRUE(canonicalMerge({a.file(), b.file()}, back) == whole);
  EXPECT_FALSE(canonicalMerge({a.file(), b.file()}, {}) == whole);
  EXPECT_THAT(refusalOf({a.file(), b.file(), FacadeCampus::shared().map.file()}, back, Remedy::None),
              ::testing::HasSubstr("two maps"));
  MergeOptions scaled = back;
  (*scaled.T_first_second)[0] = 1.001;
  EXPECT_THAT(refusalOf({a.file(), b.file()}, scaled, Remedy::None), ::testing::HasSubstr("does not scale"));
  MergeOptions endless = back;
  (*endless.T_first_second)[7] = std::numeric_limits<double>::infinity();
  EXPECT_THAT(refusalOf({a.file(), b.file()}, endless, Remedy::None), ::testing::HasSubstr("not finite"));
}

TEST_F(FacadeMerge, ChosenInputsAreThoseOfTheResult) {
  std::string text = readFile(test::sourceFolder() / "rules/outdoor.rules.yaml");
  const std::string threshold = "group: { near: 1.5 m }";
  text.replace(text.find(threshold), threshold.size(), "group: { near: 0.2 m }");
  const fs::path rules = folder.path() / "other.rules.yaml";
  writeFile(rules, text);
  const Map a = built(first, "a.clx"), b = built(rest, "b.clx", rules), whole = built(files, "whole.clx", rules);
  EXPECT_THAT(refusalOf({a.file(), b.file()}, {}, Remedy::ChooseInputs), ::testing::HasSubstr("differs from"));
  EXPECT_THAT(refusalOf({a.file(), b.file()}, {.use = whole.file()}, Remedy::None),
              ::testing::HasSubstr("is not one of the maps"));
  EXPECT_TRUE(canonicalMerge({a.file(), b.file()}, {.use = fs::relative(b.file())}) ==
              mapping::canonicalText(whole.file()));
}

TEST_F(FacadeMerge, ForceReplacesAnotherFileAndADryRunNone) {
  const Map a = built(first, "a.clx"), b = built(rest, "b.clx");
  const fs::path target = folder.path() / "target.clx";
  fs::copy_file(a.file(), target);
  const MergeOptions planning{.force = true, .drop_statements = true, .dry_run = true};
  try {
    Map::merge({a.file(), b.file()}, target, {}, silence);
    FAIL() << "another map is there";
  } catch (const Error& error) {
    EXPECT_EQ(error.remedy(), Remedy::ReplaceMap);
  }
  Map::open(target).update("INSERT DATA { <https://e.org/a> <https://e.org/b> 1 }");
  const std::string stated = readFile(target);
  try {
    Map::merge({a.file(), b.file()}, target, {.force = true}, silence);
    FAIL() << "the operator's statements would be lost";
  } catch (const Error& error) {
    EXPECT_EQ(error.remedy(), Remedy::DropStatements);
  }
  EXPECT_TRUE(readFile(target) == stated);
  writeFile(target, "what somebody wrote\n");
  try {
    Map::merge({a.file(), b.file()}, target, {.force = true, .drop_statements = true}, silence);
    FAIL() << "a text is there";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::StoreUnavailable);
  }
  writeFile(target, stated);
  EXPECT_THAT(refusalOf({a.file(), b.file()}, {.drop_statements = true}, Remedy::None),
              ::testing::HasSubstr("goes with force"));
  const MapChanges planned = Map::mergeInto({a.file(), b.file()}, target, planning, silence);
  EXPECT_TRUE(readFile(target) == stated) << "a dry run wrote";
  EXPECT_THROW(Map::merge({a.file(), b.file()}, target, planning, silence), Error);
  EXPECT_TRUE(readFile(target) == stated);
  const MapChanges done =
      Map::mergeInto({a.file(), b.file()}, target, {.force = true, .drop_statements = true}, silence);
  EXPECT_TRUE(mapping::canonicalText(target) == mapping::canonicalText(FacadeCampus::shared().map.file()));
  EXPECT_EQ(planned.scans_added, done.scans_added);
  EXPECT_EQ(planned.objects.size(), done.objects.size());
  EXPECT_EQ(planned.objects_unchanged, done.objects_unchanged);
  EXPECT_GT(done.scans_added, 0U);
}

}  // namespace
}  // namespace cluxel
