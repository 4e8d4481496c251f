// SPDX-License-Identifier: Apache-2.0
// Changes through the facade give the maps that building gives, and tell what became of each object.
#include "cluxel/change.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <functional>
#include <thread>

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
    const bool has_own_name =
        change.kind == ChangeKind::Added || change.kind == ChangeKind::Gone || change.kind == ChangeKind::Redecided;
    EXPECT_EQ(change.derived_from.empty(), has_own_name);
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

/// Calls every function that reads, and keeps how the functions that write answer.
class ReadingSink : public ProgressSink {
 public:
  ReadingSink(Map& map, const ChangeOptions& options) : map_(map), options_(options) {}
  void progress(std::string_view, std::size_t, std::size_t) override { read(); }
  void note(std::string_view) override { read(); }

  std::size_t calls = 0, refused = 0, written = 0;
  MapSummary seen;

 private:
  void read() {
    if (++calls > 3) return;
    seen = map_.summary();
    const std::vector<Object> objects = map_.objects();
    EXPECT_EQ(objects.size(), seen.objects);
    const std::vector<Cloud> clouds = map_.clouds();
    EXPECT_EQ(map_.points(clouds.front()).size(), clouds.front().point_count);
    EXPECT_GT(map_.points(objects.front()).size(), 0U);
    EXPECT_FALSE(map_.explain(objects.front().iri).text.empty());
    EXPECT_TRUE(map_.query("ASK { ?s ?p ?o }").boolean());
    EXPECT_FALSE(map_.inventory().items.empty());
    EXPECT_FALSE(map_.costMap({.cell_m = 1}).cells.empty());
    ProgressSink silence;
    Map same = Map::open(map_.file());
    tryToWrite([&] { map_.update("INSERT DATA { <http://a> <http://b> 1 }"); });
    tryToWrite([&] { same.update("INSERT DATA { <http://a> <http://b> 1 }"); });
    tryToWrite([&] { map_.extend({"absent.pcd"}, options_, silence); });
    tryToWrite([&] { map_.retract({clouds.front().id}, options_, silence); });
    tryToWrite([&] { map_.repose({}, options_, silence); });
    tryToWrite([&] { Map::build({"absent.pcd"}, map_.file(), {}); });
    tryToWrite([&] { Map::merge({map_.file()}, map_.file(), {}, silence); });
  }
  void tryToWrite(const std::function<void()>& write) {
    try {
      write();
      ++written;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::InvalidArgument) << error.what();
      EXPECT_THAT(error.what(), ::testing::HasSubstr("a callback of a call that writes this map"));
      ++refused;
    }
  }

  Map& map_;
  const ChangeOptions options_;
};

TEST_F(MapChangeFacade, IsReadByCallbacksOfACallThatWrites) {
  Map map = FacadeCampus::shared().copyIn(folder.path());
  const MapSummary before = map.summary();
  const std::string cloud = map.clouds().front().id;
  CloudPose pose{map.clouds().back().id, map.clouds().back().T_map_sensor};
  pose.T_map_sensor[3] += 0.5;
  const std::vector<std::pair<const char*, std::function<void(ProgressSink&)>>> calls{
      {"retract", [&](ProgressSink& sink) { map.retract({cloud}, {}, sink); }},
      {"extend", [&](ProgressSink& sink) { map.extend(files, {}, sink); }},
      {"repose", [&](ProgressSink& sink) { map.repose({pose}, {}, sink); }}};
  for (const auto& [name, call] : calls) {
    const MapSummary present = map.summary();
    ReadingSink sink(map, {});
    call(sink);
    EXPECT_GE(sink.calls, 3U) << name;
    EXPECT_EQ(sink.refused, 21U) << name;
    EXPECT_EQ(sink.written, 0U) << name;
    EXPECT_EQ(sink.seen.quads, present.quads) << name << ": callbacks see the last commit";
  }
  EXPECT_EQ(map.summary().clouds, before.clouds);
}

TEST_F(MapChangeFacade, IsReadByOtherThreadsMeanwhile) {
  Map map = FacadeCampus::shared().copyIn(folder.path());
  class WaitingSink : public ProgressSink {
   public:
    explicit WaitingSink(const Map& map) : map_(map) {}
    void progress(std::string_view, std::size_t, std::size_t) override {
      if (has_read_) return;
      std::thread([this] { has_read_ = map_.summary().clouds > 0 && !map_.clouds().empty(); }).join();
      EXPECT_TRUE(has_read_);
    }

   private:
    const Map& map_;
    bool has_read_ = false;
  } sink(map);
  EXPECT_EQ(map.retract({map.clouds().front().id}, {}, sink).scans_removed, 1U);
}

TEST_F(MapChangeFacade, WritesOtherMapsInACallback) {
  Map map = FacadeCampus::shared().copyIn(folder.path());
  fs::create_directory(folder.path() / "other");
  Map other = FacadeCampus::shared().copyIn(folder.path() / "other");
  class UpdatingSink : public ProgressSink {
   public:
    explicit UpdatingSink(Map& map) : map_(map) {}
    void progress(std::string_view, std::size_t, std::size_t) override {
      inserted += map_.update("INSERT DATA { <http://a> <http://b> 1 }").inserted;
    }
    std::size_t inserted = 0;

   private:
    Map& map_;
  } sink(other);
  map.retract({map.clouds().front().id}, {}, sink);
  EXPECT_EQ(sink.inserted, 1U);
}

TEST_F(MapChangeFacade, HandsOnWhatACallbackThrows) {
  Map map = FacadeCampus::shared().copyIn(folder.path());
  class ThrowingSink : public ProgressSink {
   public:
    void progress(std::string_view, std::size_t, std::size_t) override {
      throw fs::filesystem_error("of the caller", {});
    }
  } sink;
  EXPECT_THROW(map.retract({map.clouds().front().id}, {}, sink), fs::filesystem_error);
  EXPECT_EQ(map.retract({map.clouds().front().id}, {}, silence).scans_removed, 1U);
}

}  // namespace
}  // namespace cluxel
