// SPDX-License-Identifier: Apache-2.0
// What maps and changes say of boxes that leave, return, and are seen from the edge.
#include <gtest/gtest.h>

#include <optional>

#include "sparql/query_engine.hpp"
#include "tasks/box_visits.hpp"
#include "tasks/changes/site_changes.hpp"

namespace cluxel::tasks {
namespace {

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
    return changesIn(*map_, 1.7e9 + 86400.0 * static_cast<double>(visit), 1);
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

TEST(ReturningThings, OneRayThatPassesOnTheSameVisitDoesNotHideThatAThingLeft) {
  const auto votes = [](double time_s, std::size_t hits, std::size_t seen_through) {
    perception::ScanVotes scan;
    scan.time_s = time_s;
    for (std::size_t i = 0; i < hits; ++i) scan.hits.set(i);
    for (std::size_t i = 0; i < seen_through; ++i) scan.seen_through.set(hits + i);
    return scan;
  };
  constexpr double kDay_s = 86400;
  const auto wasAway = [&](const std::vector<perception::ScanVotes>& history) {
    return statesOf(0, history, 2 * kDay_s).was_away;
  };
  EXPECT_TRUE(wasAway({votes(0, 60, 0), votes(60, 0, 1), votes(kDay_s, 0, 50), votes(2 * kDay_s, 60, 0)}));
  EXPECT_FALSE(wasAway({votes(0, 60, 0), votes(60, 0, 50), votes(2 * kDay_s, 60, 0)})) << "within one visit";
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
