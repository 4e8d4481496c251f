// SPDX-License-Identifier: Apache-2.0
// Clouds that are answered region by region are answered as by the whole map.
#include "mapping/regions/answered_clouds.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <stdexcept>

#include "base/temporary_folder.hpp"
#include "cluxel/error.hpp"
#include "mapping/street_map.hpp"

namespace cluxel::mapping {
namespace {

class AnsweredCloudsTest : public StreetMap {};

TEST_F(AnsweredCloudsTest, HaveTheAnswersOfTheWholeMapInItsOrderWhateverTheRegions) {
  const std::vector<Cloud> clouds = map->clouds();
  const std::size_t cluxels = map->scene().cluxels.size();
  std::size_t with_object = 0, without = 0;
  for (const std::size_t max_cluxels : {std::size_t{1}, std::size_t{1500}, cluxels / 2, cluxels}) {
    std::size_t next = 0;
    forEachAnsweredCloud(
        *map,
        [&](const Cloud& cloud, const scan::ScanPoints& points, const PointAnswers& answers) {
          ASSERT_LT(next, clouds.size());
          EXPECT_EQ(cloud.id, clouds[next++].id);
          const scan::ScanPoints stored = map->pointsOf(cloud.id);
          EXPECT_EQ(points.x, stored.x);
          EXPECT_EQ(points.z, stored.z);
          const PointAnswers expected = map->answersFor(cloud);
          EXPECT_EQ(answers.cluxel, expected.cluxel) << max_cluxels;
          EXPECT_EQ(answers.label, expected.label) << max_cluxels;
          EXPECT_EQ(answers.object, expected.object) << max_cluxels;
          for (const std::uint32_t object : answers.object) ++(object == kNoObjectOfPoint ? without : with_object);
        },
        max_cluxels);
    EXPECT_EQ(next, clouds.size());
  }
  EXPECT_GT(with_object, 1000);
  EXPECT_GT(without, 1000);
}

TEST_F(AnsweredCloudsTest, ComeInTheOrderThatIsAskedFor) {
  std::vector<Cloud> clouds = map->clouds();
  std::reverse(clouds.begin(), clouds.end());
  std::size_t next = 0;
  forEachAnsweredCloud(
      *map, clouds,
      [&](const Cloud& cloud, const scan::ScanPoints&, const PointAnswers& answers) {
        ASSERT_LT(next, clouds.size());
        EXPECT_EQ(cloud.id, clouds[next++].id);
        EXPECT_EQ(answers.object, map->answersFor(cloud).object);
      },
      1500);
  EXPECT_EQ(next, clouds.size());
}

TEST_F(AnsweredCloudsTest, AnswerForOneOfThemAsForAll) {
  for (const Cloud& cloud : map->clouds())
    for (const std::size_t max_cluxels : {std::size_t{1}, std::size_t{1500}, kAnsweredCluxels}) {
      std::size_t visits = 0;
      forEachAnsweredCloud(
          *map, {cloud},
          [&](const Cloud& visited, const scan::ScanPoints&, const PointAnswers& answers) {
            ++visits;
            EXPECT_EQ(visited.id, cloud.id);
            const PointAnswers expected = map->answersFor(cloud);
            EXPECT_EQ(answers.cluxel, expected.cluxel) << max_cluxels;
            EXPECT_EQ(answers.object, expected.object) << max_cluxels;
          },
          max_cluxels);
      EXPECT_EQ(visits, 1U);
    }
}

using PointsByObject = std::map<std::uint32_t, std::map<ContentHash, LabelledPoints>>;  // and by cloud

PointsByObject pointsByObject(const MapReader& map) {
  PointsByObject points;
  for (const Cloud& cloud : map.clouds()) {
    const PointAnswers answers = map.answersFor(cloud);
    for (std::uint32_t i = 0; i < answers.object.size(); ++i)
      if (answers.object[i] != kNoObjectOfPoint) points[answers.object[i]][cloud.id].emplace_back(i, answers.label[i]);
  }
  return points;
}

TEST_F(AnsweredCloudsTest, HaveThePointsOfEachObjectWhateverTheRegions) {
  const PointsByObject expected = pointsByObject(*map);
  std::size_t in_several_clouds = 0;
  for (std::uint32_t object = 0; object < map->objectIds().size(); ++object)
    for (const std::size_t max_cluxels : {std::size_t{1}, std::size_t{1500}, kAnsweredCluxels}) {
      std::vector<ContentHash> visited;
      forEachCloudOfObject(
          *map, object,
          [&](const Cloud& cloud, const scan::ScanPoints& points, const LabelledPoints& labelled) {
            visited.push_back(cloud.id);
            EXPECT_EQ(points.x, map->pointsOf(cloud.id).x);
            EXPECT_EQ(labelled, expected.at(object).at(cloud.id)) << object << " " << max_cluxels;
          },
          max_cluxels);
      EXPECT_EQ(visited.size(), expected.at(object).size());
      EXPECT_TRUE(std::is_sorted(visited.begin(), visited.end())) << "clouds are sorted by id";
      in_several_clouds += visited.size() > 1 ? 1 : 0;
    }
  EXPECT_GT(in_several_clouds, 0);
}

TEST_F(AnsweredCloudsTest, AreTheSameFromWhatIsKeptWhateverWasAskedBefore) {
  const PointsByObject expected = pointsByObject(*map);
  const std::vector<Cloud> clouds = map->clouds();
  std::mt19937 random(5);
  for (const std::size_t max_cluxels : {std::size_t{1}, std::size_t{600}, std::size_t{2500}, kAnsweredCluxels}) {
    KeptAnswers kept(*map, max_cluxels);
    EXPECT_TRUE(kept.isOf(*map));
    for (int call = 0; call < 25; ++call) {
      const Cloud& cloud = clouds[random() % clouds.size()];
      const PointAnswers answers = kept.answersFor(*map, cloud, map->pointsOf(cloud.id)), all = map->answersFor(cloud);
      EXPECT_EQ(answers.cluxel, all.cluxel) << max_cluxels;
      EXPECT_EQ(answers.label, all.label) << max_cluxels;
      EXPECT_EQ(answers.object, all.object) << max_cluxels;
      const auto object = static_cast<std::uint32_t>(random() % map->objectIds().size());
      std::map<ContentHash, LabelledPoints> visited;
      kept.forEachCloud(*map, object, [&](const Cloud& visited_cloud, const auto&, const LabelledPoints& labelled) {
        visited.emplace(visited_cloud.id, labelled);
      });
      EXPECT_EQ(visited, expected.at(object)) << object << " " << max_cluxels;
    }
  }
}

TEST_F(AnsweredCloudsTest, GoOnFromWhatIsKeptAfterACallerThrew) {
  KeptAnswers kept(*map);
  const auto fail = [](const Cloud&, const auto&, const auto&) { throw std::runtime_error("enough"); };
  EXPECT_THROW(kept.forEachCloud(*map, 0, fail), std::runtime_error);
  const Cloud cloud = map->clouds().front();
  EXPECT_EQ(kept.answersFor(*map, cloud, map->pointsOf(cloud.id)).object, map->answersFor(cloud).object);
}

TEST_F(AnsweredCloudsTest, NeedTheFolderForTemporaryFilesOnlyForSeveralRegions) {
  const auto ignore = [](const Cloud&, const scan::ScanPoints&, const PointAnswers&) {};
  const TemporaryFolderIs none("/there/is/none");
  EXPECT_NO_THROW(forEachAnsweredCloud(*map, ignore));
  EXPECT_THROW(forEachAnsweredCloud(*map, ignore, 1), Error);
  const auto ignoreObject = [](const Cloud&, const scan::ScanPoints&, const LabelledPoints&) {};
  for (std::uint32_t object = 0; object < map->objectIds().size(); ++object)
    EXPECT_NO_THROW(forEachCloudOfObject(*map, object, ignoreObject));
}

}  // namespace
}  // namespace cluxel::mapping
