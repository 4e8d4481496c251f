// SPDX-License-Identifier: Apache-2.0
// What maps and changes say of boxes that leave, return, and are seen from the edge.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>

#include "cluxel/error.hpp"
#include "sparql/query_engine.hpp"
#include "tasks/box_visits.hpp"
#include "tasks/changes/site_changes.hpp"

namespace cluxel::tasks {
namespace {

constexpr double kDay_s = 86400;
const Box kNorth = boxFrom({-15, 10, 0}, {15, 10.5, 5}), kSouth = boxFrom({-15, -12.5, 0}, {15, -12, 5});
const Box kCar = boxFrom({2, 4, 0.25}, {6.2, 5.8, 1.5});

BoxVisit visit(const std::vector<Box>& things) {
  BoxVisit at{{kNorth, kSouth}, {{-3, 0, 1.8}, {1, -1, 1.8}, {5, 0, 1.8}, {8, 1, 1.8}}};
  at.boxes.insert(at.boxes.end(), things.begin(), things.end());
  return at;
}

class BoxMap {
 public:
  explicit BoxMap(const std::vector<BoxVisit>& visits) {
    writeVisits(visits, folder_.path() / "scans");
    mapping::buildMap(mapping::scansOf({folder_.path() / "scans"}), mapping::shippedInputs(),
                      folder_.path() / "map.clx", {}, mapping::silence());
    map_.emplace(folder_.path() / "map.clx");
  }
  const mapping::MapReader& map() const { return *map_; }
  SiteChanges changesSince(std::size_t visit) const {
    return changesIn(*map_, {1.7e9 + kDay_s * static_cast<double>(visit)}, 1);
  }
  /// Objects around a place that rays of later scans saw through.
  std::size_t goneAt(const Eigen::Vector3d& place) const {
    const std::string query =
        "PREFIX clx: <https://w3id.org/cluxel/ontology#> SELECT ?o WHERE { ?o clx:seenThrough ?t }";
    const sparql::ResultTable table = sparql::PreparedQuery(map_->quads(), query, {}).evaluate().table;
    std::size_t gone = 0;
    for (std::size_t row = 0; row < table.row_count; ++row)
      for (const ObjectStates& states : changesSince(1).states)
        gone += states.box.contains(place) && table.at(row, 0)->text.ends_with(map_->objects()[states.object].id.hex());
    return gone;
  }

 private:
  rdf::ScratchFolder folder_;
  std::optional<mapping::MapReader> map_;
};

std::vector<const SiteChange*> changesAt(const SiteChanges& found, const Eigen::Vector3d& place) {
  std::vector<const SiteChange*> at;
  for (const SiteChange& change : found.changes)
    if (change.thing.box.exteriorDistance(place) < 0.5) at.push_back(&change);
  return at;
}

std::vector<SiteChange::Kind> kindsAt(const SiteChanges& found, const Eigen::Vector3d& place) {
  std::vector<SiteChange::Kind> kinds;
  for (const SiteChange* change : changesAt(found, place))
    if (change->thing.object) kinds.push_back(change->kind);
  return kinds;
}

TEST(ReturningThings, ACarThatLeftAndCameBackIsThere) {
  const BoxMap site({visit({kCar}), visit({}), visit({kCar})});
  EXPECT_EQ(site.goneAt(kCar.center()), 0U);
  const SiteChanges found = site.changesSince(2);
  const auto changes = changesAt(found, kCar.center());
  ASSERT_EQ(changes.size(), 1U);
  EXPECT_EQ(changes[0]->kind, SiteChange::Kind::Appeared);
  EXPECT_FALSE(changes[0]->thing.is_part);
  const SiteChanges later = site.changesSince(1);
  EXPECT_TRUE(changesAt(later, kCar.center()).empty()) << "it was there before, and it is there at the end";
}

TEST(ReturningThings, ACarThatCameAndLeftIsGone) {
  const BoxMap site({visit({}), visit({kCar}), visit({}), visit({kCar}), visit({})});
  EXPECT_EQ(site.goneAt(kCar.center()), 1U);
  const SiteChanges since_it_came = site.changesSince(3);
  EXPECT_TRUE(changesAt(since_it_came, kCar.center()).empty()) << "away before, and away at the end";
  const SiteChanges since_it_left = site.changesSince(4);
  const auto changes = changesAt(since_it_left, kCar.center());
  ASSERT_EQ(changes.size(), 1U);
  EXPECT_EQ(changes[0]->kind, SiteChange::Kind::Vanished);
}

TEST(ReturningThings, WhatStandsWhereACarLeftIsThere) {
  const Box crate = boxFrom({2, 4, 0}, {4.2, 5.8, 1.3});
  const BoxMap site({visit({kCar}), visit({}), visit({crate})});
  EXPECT_EQ(site.goneAt(crate.center()), 0U);
}

/// Two cars of one size, 6 m apart.
const Box kOther = boxFrom({-6, 4, 0.25}, {-1.8, 5.8, 1.5});

TEST(ReturningThings, WhatLeftBeforeHasNotVanishedSince) {
  const BoxMap site({visit({kCar}), visit({}), visit({})});
  EXPECT_EQ(changesAt(site.changesSince(1), kCar.center()).size(), 1U);
  EXPECT_TRUE(changesAt(site.changesSince(2), kCar.center()).empty());
}

TEST(ReturningThings, WhatCameAndLeftAgainHasNotAppearedSince) {
  const BoxMap site({visit({}), visit({kCar}), visit({})});
  EXPECT_TRUE(changesAt(site.changesSince(1), kCar.center()).empty());
  const SiteChanges of_second = changesIn(site.map(), {.since_s = 1.7e9 + kDay_s, .until_s = 1.7e9 + 1.5 * kDay_s}, 1);
  const auto changes = changesAt(of_second, kCar.center());
  ASSERT_EQ(changes.size(), 1U) << "as the second visit saw it";
  EXPECT_EQ(changes[0]->kind, SiteChange::Kind::Appeared);
}

TEST(ReturningThings, CarsThatOneVisitSawBothHaveNotMoved) {
  const BoxMap site({visit({kOther}), visit({kCar, kOther}), visit({kCar})});
  const SiteChanges since_first = site.changesSince(1), since_second = site.changesSince(2);
  EXPECT_EQ(kindsAt(since_first, kCar.center()), std::vector{SiteChange::Kind::Appeared});
  EXPECT_EQ(kindsAt(since_first, kOther.center()), std::vector{SiteChange::Kind::Vanished});
  EXPECT_EQ(kindsAt(since_second, kOther.center()), std::vector{SiteChange::Kind::Vanished});
  const BoxMap moved({visit({kOther}), visit({kCar})});
  EXPECT_EQ(kindsAt(moved.changesSince(1), kOther.center()), std::vector{SiteChange::Kind::Moved});
}

TEST(ReturningThings, WhatLeavesBesideThePlaceOfWhatLeftBeforeHasVanished) {
  const Box beside = boxFrom({2.4, 5.9, 0.25}, {6.6, 7.7, 1.5});
  const BoxMap site({visit({beside}), visit({}), visit({kCar}), visit({})});
  const SiteChanges found = site.changesSince(3);
  const auto changes = changesAt(found, kCar.center());
  ASSERT_EQ(changes.size(), 1U);
  EXPECT_EQ(changes[0]->kind, SiteChange::Kind::Vanished);
  EXPECT_LT(changes[0]->thing.box.max().y(), 6.3) << "with what left before";
}

TEST(ReturningThings, AVisitTellsWhatItChangedOnce) {
  const BoxMap site({visit({kCar}), visit({}), visit({kOther}), visit({kOther})});
  const std::vector<SiteChanges> visits = changesOfVisits(site.map(), 1);
  ASSERT_EQ(visits.size(), 3U);
  EXPECT_EQ(kindsAt(visits[0], kCar.center()), std::vector{SiteChange::Kind::Vanished});
  EXPECT_EQ(kindsAt(visits[1], kOther.center()), std::vector{SiteChange::Kind::Appeared});
  EXPECT_TRUE(kindsAt(visits[0], kOther.center()).empty());
  EXPECT_TRUE(kindsAt(visits[1], kCar.center()).empty());
  EXPECT_TRUE(visits[2].changes.empty());
}

TEST(ReturningThings, ATimeUntilWhichThereIsTooLittleIsToldAsTheCause) {
  const BoxMap site({visit({kCar}), visit({})});
  const auto message = [&](const ChangeTimes& times) {
    try {
      changesIn(site.map(), times, 1);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const double first_s = 1.7e9, noon_s = first_s + kDay_s / 2;
  using testing::HasSubstr;
  EXPECT_THAT(message({.until_s = noon_s}), HasSubstr("until 2023-11-15T10:13:20.000000Z the map has scans without"));
  EXPECT_THAT(message({.until_s = 1e9}), HasSubstr("the map has no scan with a time and a pose"));
  EXPECT_THAT(message({.since_s = noon_s, .until_s = first_s}), HasSubstr("which is earlier"));
  EXPECT_THAT(message({.since_s = noon_s, .until_s = noon_s + 60}), HasSubstr("and until 2023-11-15T10:14:20.000000Z"));
}

TEST(EdgesOfThings, ARoofThatALowerLaserSeesFromTheEdgeStays) {
  const Box car = boxFrom({2, 4, 0.25}, {6.2, 5.8, 1.4});
  BoxVisit high = visit({car}), low = high;
  for (Eigen::Vector3d& sensor : high.sensors) sensor.z() = 1.9;
  for (Eigen::Vector3d& sensor : low.sensors) sensor.z() = 1.5;
  const BoxMap site({high, low});
  EXPECT_TRUE(site.changesSince(1).changes.empty());
}

}  // namespace
}  // namespace cluxel::tasks
