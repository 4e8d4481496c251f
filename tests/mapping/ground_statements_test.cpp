// SPDX-License-Identifier: Apache-2.0
// The ground is one object over all of the map: what was stated of a thing, or of a region, does not change it.
#include <gtest/gtest.h>

#include "mapping/change/map_change.hpp"
#include "mapping/change/map_update.hpp"
#include "mapping/change/statement_change.hpp"
#include "mapping/small_campus.hpp"
#include "mapping/stated_builds.hpp"
#include "rdf/map_iris.hpp"
#include "rules/objects/finished_objects.hpp"

namespace cluxel::mapping {
namespace {

namespace fs = std::filesystem;

const std::string kGroundClass = rdf::vocabulary::clx("Ground");
const std::string kLabelProperty = rdf::vocabulary::rdfs("label");

class GroundStatements : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    campus = new SmallCampus({.seed = 5, .stops = 4, .size_m = 60, .points_per_stop = 2500});
    inputs = new MapInputs(shippedInputs());
  }
  static void TearDownTestSuite() {
    delete campus;
    delete inputs;
  }
  static ScanSet scans(std::size_t first, std::size_t end) {
    return scansOf({campus->files().begin() + static_cast<std::ptrdiff_t>(first),
                    campus->files().begin() + static_cast<std::ptrdiff_t>(end)});
  }
  fs::path built(std::size_t scan_count) const {
    buildMap(scans(0, scan_count), *inputs, map(), {.force = true}, silence());
    return map();
  }
  fs::path map() const { return folder.path() / "map.clx"; }

  /// The map of the same scans, built from scratch with the statements that the map has.
  std::string fromScratch(std::size_t scan_count) const {
    return builtWithStatementsOf(map(), scans(0, scan_count), *inputs);
  }
  std::vector<KnownStatement> known() const { return knownStatements(MapReader(map()).quads()); }
  std::size_t groundCount() const {
    const MapReader reader(map());
    std::size_t count = 0;
    for (const rules::SemanticObject& object : reader.objects()) count += object.class_iri == kGroundClass ? 1 : 0;
    return count;
  }

  ScratchFolder folder;
  inline static SmallCampus* campus = nullptr;
  inline static MapInputs* inputs = nullptr;
};

/// As of a bush that more scans show to be ground.
TEST_F(GroundStatements, OfPointsThatAreGroundNowAreDormant) {
  built(2);
  const ContentHash ground = rules::idOfClassWide(kGroundClass);
  const PointAnchor points = MapReader(map()).anchorOf(ground);
  ASSERT_FALSE(points.empty());
  const std::vector<Statement> all{{StatementKind::Remove, "", {}, points, {}},
                                   {StatementKind::IsNot, "", Term::iri(kGroundClass), points, {}},
                                   {StatementKind::Is, "", Term::iri(rdf::vocabulary::clx("Building")), points, {}},
                                   {StatementKind::Fact, kLabelProperty, Term::literal("old oak"), points, {}}};
  for (const double window : {0.0, 2.0}) {
    const std::string before = canonicalText(built(2));
    const ChangeReport report = changeStatements(map(), {all, {}, ""}, {.max_window_share = window}, silence());
    EXPECT_TRUE(report.objects.isEmpty());
    EXPECT_EQ(groundCount(), 1U);
    for (const KnownStatement& statement : known()) {
      EXPECT_EQ(statement.effect, "dormant");
      EXPECT_FALSE(statement.lacks_scans) << "its scan is there, but its points are ground";
    }
    EXPECT_TRUE(canonicalText(map()) == fromScratch(2));
    std::vector<ContentHash> ids;
    for (const Statement& statement : all) ids.push_back(statement.id());
    changeStatements(map(), {{}, ids, ""}, {.max_window_share = window}, silence());
    EXPECT_TRUE(canonicalText(map()) == before);
  }
}

TEST_F(GroundStatements, ThatARegionHoldsNothingLeaveTheGround) {
  built(2);
  const std::vector<Cloud> clouds = MapReader(map()).clouds();
  const std::vector<Eigen::Vector2d> everywhere{{-500, -500}, {500, -500}, {500, 500}, {-500, 500}};
  const Statement nothing{StatementKind::IgnoreRegion, "", {}, {}, regionAnchor(clouds, everywhere)};
  changeStatements(map(), {{nothing}, {}, ""}, {}, silence());
  EXPECT_EQ(groundCount(), 1U);
  EXPECT_EQ(MapReader(map()).objectIds().size(), 1U) << "all else is gone";
  EXPECT_TRUE(canonicalText(map()) == fromScratch(2));
  extendMap(map(), scans(2, 4), {.max_window_share = 2}, silence());
  EXPECT_TRUE(canonicalText(map()) == fromScratch(4));
}

TEST_F(GroundStatements, OfItsPropertiesStayThroughChanges) {
  const ContentHash ground = rules::idOfClassWide(kGroundClass);
  const std::string iri = rdf::iriOfObject(ground);
  for (const std::uint64_t whole_cluxels : {UpdateParams{}.whole_cluxels, std::uint64_t{100}})
    for (const double window : {0.0, 2.0}) {
      built(2);
      updateMap(map(), "INSERT DATA { <" + iri + "> <" + kLabelProperty + "> \"yard\" }", {}, silence());
      ASSERT_EQ(known().size(), 1U);
      EXPECT_EQ(known()[0].statement.class_iri, kGroundClass);
      const ChangeParams params{.max_window_share = window, .whole_cluxels = whole_cluxels};
      for (std::size_t count = 2; count <= 4; ++count) {
        if (count > 2) extendMap(map(), scans(count - 1, count), params, silence());
        EXPECT_EQ(known()[0].effect, "applied");
        EXPECT_EQ(known()[0].object, iri);
        EXPECT_NE(canonicalText(map()).find("<" + iri + "> <" + kLabelProperty + "> \"yard\""), std::string::npos);
        EXPECT_TRUE(canonicalText(map()) == fromScratch(count));
      }
      const ScanId last = scans(3, 4).load(0).id;
      retractScans(map(), {last}, params, silence());
      EXPECT_TRUE(canonicalText(map()) == fromScratch(3));
      changeStatements(map(), {{}, {known()[0].statement.id()}, ""}, params, silence());
      EXPECT_EQ(canonicalText(map()).find("\"yard\""), std::string::npos);
      EXPECT_TRUE(canonicalText(map()) == fromScratch(3));
    }
}

}  // namespace
}  // namespace cluxel::mapping
