// SPDX-License-Identifier: Apache-2.0
// Streets of a file beside the inventory: their column, and a note where none is near.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "tasks/ask/inventory_task.hpp"
#include "tasks/campus_map_fixture.hpp"

namespace cluxel::tasks {
namespace {

TEST(QuestionsOfACampus, StreetsThatAreFarFromTheMapAreTold) {
  const MapReader& map = CampusMap::shared().map();
  const InventoryParams trees{.classes = {"Tree"}, .with_rows = false, .with_sidewalks = false};
  const auto along = [](double y) { return std::vector<Street>{{"High Street", {{-1000, y}, {1000, y}}}}; };
  const auto noteOf = [&](const std::vector<Street>& streets) {
    for (const std::string& note : inventoryAnswer(map, trees, streets).notes)
      if (note.starts_with("no street")) return note;
    return std::string();
  };
  EXPECT_EQ(noteOf({}), "");
  EXPECT_EQ(noteOf(along(0)), "");
  EXPECT_TRUE(noteOf(along(500)).starts_with("no street lies within 25 m of what is listed; the nearest is 4"));
  EXPECT_EQ(noteOf(along(500)).find("exchanged"), std::string::npos) << "the next village has other streets";
  EXPECT_NE(noteOf(along(5e6)).find("are longitude and latitude exchanged?"), std::string::npos);
  EXPECT_NE(noteOf(along(std::numeric_limits<double>::infinity())).find("exchanged?"), std::string::npos);
  const TaskAnswer named = inventoryAnswer(map, trees, along(0));
  EXPECT_EQ(named.columns[2].name, "street");
  EXPECT_TRUE(std::any_of(named.rows.begin(), named.rows.end(),
                          [](const TaskRow& row) { return row.cells[2] == TaskCell("High Street"); }));
  const TaskAnswer bare = inventoryAnswer(map, trees);
  ASSERT_EQ(bare.columns.size() + 1, named.columns.size());
  for (std::size_t c = 0; c < bare.columns.size(); ++c) {
    EXPECT_EQ(bare.columns[c].name, named.columns[c < 2 ? c : c + 1].name);
    EXPECT_EQ(bare.rows[0].cells[c], named.rows[0].cells[c < 2 ? c : c + 1]);
  }
}

}  // namespace
}  // namespace cluxel::tasks
