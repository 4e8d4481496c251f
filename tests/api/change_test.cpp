// SPDX-License-Identifier: Apache-2.0
// Changes through the facade give the maps that building gives, and tell what became of each object.
#include "cluxel/change.hpp"

#include <gmock/gmock.h>

#include <algorithm>

#include "api/facade_campus.hpp"
#include "cluxel/map.hpp"

namespace cluxel {
namespace {

namespace fs = std::filesystem;

class MapChangeFacade : public ::testing::Test {
 protected:
  static std::string canonical(const Map& map) { return mapping::canonicalText(map.file()); }
  Map built(const std::vector<fs::path>& scans, const std::string& name) const {
    BuildOptions options;
    options.model = "campus";
    options.home = test::sourceFolder();
    return Map::build(scans, folder.path() / name, options);
  }

  rdf::ScratchFolder folder;
  std::vector<fs::path> files = FacadeCampus::shared().campus.files();
  ProgressSink silence;
};

TEST_F(MapChangeFacade, ExtendsRetractsAndMerges) {
  ASSERT_GE(files.size(), 2U);
  const std::vector<fs::path> first{files.front()}, rest(files.begin() + 1, files.end());
  const Map whole = built(files, "whole.clx"), other = built(rest, "other.clx");
  Map map = built(first, "map.clx");
  const std::string before = canonical(map);
  const MapChanges changes = map.extend(rest, {}, silence);
  EXPECT_EQ(changes.scans_added, rest.size());
  EXPECT_EQ(canonical(map), canonical(whole));
  const auto objects = map.objects();
  for (const ObjectChange& change : changes.objects) {
    const bool is_there =
        std::any_of(objects.begin(), objects.end(), [&](const Object& o) { return o.iri == change.iri; });
    EXPECT_EQ(is_there, change.kind != ChangeKind::Gone) << change.iri;
    EXPECT_EQ(change.derived_from.empty(), change.kind == ChangeKind::Added || change.kind == ChangeKind::Gone);
  }
  std::vector<std::string> names;
  for (const fs::path& file : rest) names.push_back(file.filename());
  EXPECT_EQ(map.retract(names, {}, silence).scans_removed, rest.size());
  EXPECT_EQ(canonical(map), before);
  EXPECT_EQ(canonical(Map::merge({map.file(), other.file()}, folder.path() / "merged.clx", {}, silence)),
            canonical(whole));
}

TEST_F(MapChangeFacade, MovesAScanThereAndBack) {
  Map map = built(files, "map.clx");
  const std::string before = canonical(map);
  const Cloud cloud = map.clouds().front();
  CloudPose pose{cloud.id, cloud.T_map_sensor};
  pose.T_map_sensor[3] += 0.5;  // along x
  ChangeOptions dry_run;
  dry_run.dry_run = true;
  EXPECT_EQ(map.repose({pose}, dry_run, silence).scans_moved, 1U);
  EXPECT_EQ(canonical(map), before) << "a dry run writes nothing";
  EXPECT_EQ(map.repose({pose}, {}, silence).scans_moved, 1U);
  EXPECT_NE(canonical(map), before);
  EXPECT_EQ(map.repose({{cloud.id, cloud.T_map_sensor}}, {}, silence).scans_moved, 1U);
  EXPECT_EQ(canonical(map), before);
}

}  // namespace
}  // namespace cluxel
