// SPDX-License-Identifier: Apache-2.0
// Maps of a small campus with any of its scans at any poses, for tests of changes.
#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "mapping/change/map_change.hpp"
#include "mapping/map_tables.hpp"
#include "mapping/small_campus.hpp"

namespace cluxel::mapping {

inline constexpr std::size_t kScans = 4;

/// A campus of four scans, and maps of any of them with any poses, built once each.
class MapChange : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    campus = new SmallCampus({.seed = 5, .stops = kScans, .size_m = 45, .points_per_stop = 1200});
    inputs = new MapInputs(shippedInputs());
    const ScratchFolder manifest;  // gives the scans times, so that objects have a presence
    std::ofstream text(manifest.path() / "scans.yaml");
    text << "scans:\n";
    for (std::size_t i = 0; i < kScans; ++i)
      text << "  - {path: " << campus->files()[i].string() << ", time_s: " << 1600000000 + 1000 * i << "}\n";
    text.close();
    scans = new ScanSet(scansOf({manifest.path() / "scans.yaml"}));
    for (std::size_t i = 0; i < scans->size(); ++i) ids.push_back(scans->load(i).id);
  }
  static void TearDownTestSuite() {
    delete campus;
    delete inputs;
    delete scans;
    ids.clear();
    built.clear();
  }

  /// Scan number → pose number: 0 is the true pose, others are shifted by 0.5 m and turned by 2 degrees per number.
  using Poses = std::map<std::size_t, int>;

  static Eigen::Isometry3d poseOf(std::size_t scan, int number) {
    Eigen::Isometry3d T = scans->file(scan).T_map_sensor;
    if (number == 0) return T;
    T.pretranslate(Eigen::Vector3d(0.5 * number, 0, 0));
    T.rotate(Eigen::AngleAxisd(number * 0.035, Eigen::Vector3d::UnitZ()));
    return T;
  }
  static ScanSet posed(const Poses& poses) {
    std::vector<PosedScan> chosen;
    for (const auto& [scan, number] : poses) chosen.push_back({scan, poseOf(scan, number)});
    return scans->posed(chosen);
  }
  std::filesystem::path map() const { return folder.path() / "map.clx"; }
  void build(const Poses& poses) const { buildMap(posed(poses), *inputs, map(), {.force = true}, silence()); }

  /// The facts, and the stored outputs of the stages, whose traces cover also what is not stored.
  struct Content {
    std::string facts, stages;
    bool operator==(const Content&) const = default;
  };
  static Content contentOf(const std::filesystem::path& file) {
    Content content{canonicalText(file), ""};
    const auto environment = Environment::open(file, OpenMode::ReadOnly);
    const ReadTransaction transaction = environment->read();
    for (const auto table :
         {tables::kPoints, tables::kCluxels, tables::kGround, tables::kFeatures, tables::kLabels, tables::kSummaries,
          tables::kEven, tables::kComponents, tables::kContacts, tables::kSurfaces, tables::kWays})
      transaction.forEachBlock(
          table, "", [&](std::string_view key, std::string_view bytes) { content.stages.append(key).append(bytes); });
    return content;
  }
  static const Content& fromScratch(const Poses& poses) {
    auto [entry, fresh] = built.try_emplace(poses);
    if (fresh) {
      const ScratchFolder folder;
      buildMap(posed(poses), *inputs, folder.path() / "map.clx", {}, silence());
      entry->second = contentOf(folder.path() / "map.clx");
    }
    return entry->second;
  }
  void expectExact(const Poses& poses) const {
    const Content found = contentOf(map());
    EXPECT_TRUE(found.facts == fromScratch(poses).facts);
    EXPECT_TRUE(found.stages == fromScratch(poses).stages);
  }

  ChangeReport extend(std::size_t scan, int pose, const ChangeParams& params = {}) const {
    return extendMap(map(), posed({{scan, pose}}), params, silence());
  }
  ChangeReport retract(std::size_t scan, const ChangeParams& params = {}) const {
    return retractScans(map(), {ids[scan]}, params, silence());
  }
  ChangeReport move(const Poses& poses, const ChangeParams& params = {}) const {
    std::vector<ScanPose> moves;
    for (const auto& [scan, number] : poses) moves.push_back({ids[scan], poseOf(scan, number)});
    return moveScans(map(), moves, params, silence());
  }

  static std::function<MapInputs(MapInputs)> always(const MapInputs& inputs) {
    return [inputs](const MapInputs&) { return inputs; };
  }

  ScratchFolder folder;
  inline static SmallCampus* campus = nullptr;
  inline static MapInputs* inputs = nullptr;
  inline static ScanSet* scans = nullptr;
  inline static std::vector<ScanId> ids;
  inline static std::map<Poses, Content> built;
};

}  // namespace cluxel::mapping
