// SPDX-License-Identifier: Apache-2.0
// The JSON of changes: every change has the same keys, also of what is no object of the map.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "mapping/small_campus.hpp"
#include "tasks/changes/site_changes.hpp"

namespace cluxel::tasks {
namespace {

using Json = nlohmann::json;

std::vector<std::string> keysOf(const Json& json) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : json.items()) keys.push_back(key);
  return keys;
}

class ChangesJson : public testing::Test {
 protected:
  static mapping::MapReader mapIn(const std::filesystem::path& folder) {
    const mapping::SmallCampus campus({.seed = 5, .stops = 1, .size_m = 45, .points_per_stop = 1200});
    const std::filesystem::path file = folder / "map.clx";
    buildMap(mapping::scansOf(campus.files()), mapping::shippedInputs(), file, {}, mapping::silence());
    return mapping::MapReader(file);
  }

  const rdf::ScratchFolder folder;
  const mapping::MapReader map = mapIn(folder.path());
};

TEST_F(ChangesJson, TellsHowSureAStateIsAndOfHowMuchOfTheObject) {
  SiteChanges found;
  found.states.resize(1);
  found.states[0].after = perception::PresenceState::Absent;
  found.states[0].log_odds_after = -81.234, found.states[0].coverage_after = 0.9684;
  const Json state = Json::parse(changesJson(map, found)).at("states").at(0);
  EXPECT_EQ(state.at("after"), "absent");
  EXPECT_EQ(state.at("log_odds_after"), -81.23);
  EXPECT_EQ(state.at("coverage_after"), 0.97);
  EXPECT_EQ(state.at("coverage_before"), 0);
}

TEST_F(ChangesJson, HasNullForTheNamesOfSomethingUnnamed) {
  const Eigen::AlignedBox3d box(Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 2, 3));
  const ChangedThing named{{1, 2}, 0, true, box}, unnamed{{3}, std::nullopt, false, box};
  SiteChanges found;
  found.changes = {{SiteChange::Kind::Appeared, named, std::nullopt, 0},
                   {SiteChange::Kind::Vanished, unnamed, std::nullopt, 0},
                   {SiteChange::Kind::Moved, unnamed, unnamed, 2}};
  const Json changes = Json::parse(changesJson(map, found)).at("changes");
  ASSERT_EQ(changes.size(), 3U);
  EXPECT_EQ(keysOf(changes[0]), keysOf(changes[1]));
  EXPECT_EQ(changes[0].at("part"), true);
  for (const Json& thing : {changes[1], changes[2], changes[2].at("now")}) {
    for (const char* key : {"object", "number", "class"}) EXPECT_TRUE(thing.at(key).is_null()) << key;
    EXPECT_EQ(thing.at("part"), false);
  }
}

}  // namespace
}  // namespace cluxel::tasks
