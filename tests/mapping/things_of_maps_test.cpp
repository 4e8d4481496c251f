// SPDX-License-Identifier: Apache-2.0
// Things of real maps keep their names while maps grow, shrink, move and merge, however a change is computed.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "mapping/change/map_change.hpp"
#include "mapping/change/map_merge.hpp"
#include "mapping/small_campus.hpp"
#include "mapping/thing_history.hpp"
#include "mapping/window/former_objects.hpp"
#include "rdf/map_iris.hpp"

namespace cluxel::mapping {
namespace {

namespace fs = std::filesystem;
using Names = std::map<ContentHash, std::string>;  ///< of present objects

Names namesIn(const fs::path& file) {
  const MapReader map(file);
  const Things things = storedThings(map.quads());
  Names names;
  for (const ContentHash& object : map.objectIds()) names[object] = thingOf(things, object).iri;
  return names;
}

/// A thing has one present object, or an end.
void expectNothingStale(const fs::path& file) {
  const Names names = namesIn(file);
  std::set<std::string> present;
  for (const auto& [object, thing] : names)
    EXPECT_TRUE(present.insert(thing).second) << thing << " is the name of two objects";
  const MapReader map(file);
  const ThingLookup lookup(map.quads());
  for (const auto& [thing, time] : timesOfThings(map.quads()))
    EXPECT_EQ(lookup.endsOf(thing).empty(), present.contains(thing)) << thing;
}

/// Objects go on under their names: `changes` tells which objects came from which. One that comes back may have its
/// former name, which is among the things `known` before.
void expectNamesToGoOn(const Names& before, const Things& known, const Names& after, const ObjectChanges& changes) {
  const auto had = [&](const ContentHash& object) {
    const auto things = known.find(object);
    return things != known.end() && std::any_of(things->second.begin(), things->second.end(),
                                                [&](const Thing& thing) { return thing.iri == after.at(object); });
  };
  for (const auto& [object, thing] : before) {
    const auto same = after.find(object);
    EXPECT_TRUE(same == after.end() || same->second == thing) << thing;
  }
  std::set<std::string> former;
  for (const auto& [object, thing] : before) former.insert(thing);
  for (const ContentHash& added : changes.added) EXPECT_TRUE(!former.contains(after.at(added)) || had(added));
  for (const DerivedObject& changed : changes.changed)
    EXPECT_TRUE(after.at(changed.id) == before.at(changed.from.front()) || had(changed.id));
  for (const DerivedObject& joined : changes.joined) {
    std::set<std::string> of_parts;
    for (const ContentHash& part : joined.from) of_parts.insert(before.at(part));
    EXPECT_TRUE(of_parts.contains(after.at(joined.id)) || had(joined.id));
  }
  std::map<ContentHash, std::size_t> heirs;  // of what was split
  for (const DerivedObject& split : changes.split)
    heirs[split.from.front()] += after.at(split.id) == before.at(split.from.front()) ? 1 : 0;
  std::set<std::string> held;
  for (const auto& [object, thing] : after) held.insert(thing);
  for (const auto& [object, count] : heirs) {
    EXPECT_LE(count, 1U);
    EXPECT_TRUE(held.contains(before.at(object))) << "a name was lost";
  }
}

/// What has gone on in one object is found by its former name.
void expectNamesToLead(const fs::path& file, const ObjectChanges& changes) {
  const MapReader map(file);
  const std::vector<ContentHash>& present = map.objectIds();
  const Lineage lineage(map.quads(), present);
  for (const auto* objects : {&changes.changed, &changes.joined})
    for (const DerivedObject& object : *objects)
      for (const ContentHash& from : object.from)
        EXPECT_TRUE(std::count(present.begin(), present.end(), from) > 0 || lineage.find(rdf::iriOfObject(from)))
            << from.hex() << " went on in " << object.id.hex();
}

/// The lineage of objects in the history.
std::set<std::pair<std::string, std::string>> derivationsIn(const fs::path& file) {
  const MapReader map(file);
  std::set<std::pair<std::string, std::string>> derivations;
  forEachHistoryLink(map.quads(), "wasDerivedFrom", [&](const Term& object, const Term& from) {
    if (hashIn(object.text, "object")) derivations.emplace(object.text, from.text);
  });
  return derivations;
}

void expectLineage(const fs::path& file, const ObjectChanges& changes) {
  const auto derivations = derivationsIn(file);
  for (const auto* objects : {&changes.changed, &changes.split, &changes.joined})
    for (const DerivedObject& object : *objects)
      for (const ContentHash& from : object.from)
        EXPECT_TRUE(derivations.contains({rdf::iriOfObject(object.id), rdf::iriOfObject(from)}));
}

class ThingsOfMaps : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    campus = new SmallCampus({.seed = 6, .stops = 4, .size_m = 45, .points_per_stop = 2500});
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
  fs::path built(std::size_t first, std::size_t end, const std::string& name) const {
    buildMap(scans(first, end), *inputs, folder.path() / name, {}, silence());
    return folder.path() / name;
  }

  /// Changes two copies of a map: as a whole with one thread, and around the change with two. Both give the same names,
  /// by the same lineage.
  template <typename Change>
  ChangeReport changedBothWays(const fs::path& map, const Change& change) {
    const Names before = namesIn(map);
    const Things known = storedThings(MapReader(map).quads());
    const fs::path other = map.string() + ".other";
    fs::copy_file(map, other, fs::copy_options::overwrite_existing);
    const ChangeReport report = change(map, ChangeParams{.threads = 1, .max_window_share = 0});
    EXPECT_EQ(report.local_commits, 0U);
    local_commits_ += change(other, ChangeParams{.threads = 2, .max_window_share = 2}).local_commits;
    const Names after = namesIn(map);
    EXPECT_EQ(after, namesIn(other));
    EXPECT_EQ(derivationsIn(map), derivationsIn(other));
    expectNamesToGoOn(before, known, after, report.objects);
    expectNamesToLead(map, report.objects);
    expectLineage(map, report.objects);
    expectNothingStale(map);
    expectNothingStale(other);
    derived_ += report.objects.changed.size() + report.objects.joined.size() + report.objects.split.size();
    return report;
  }

  ScratchFolder folder;
  std::size_t local_commits_ = 0, derived_ = 0;
  inline static SmallCampus* campus = nullptr;
  inline static MapInputs* inputs = nullptr;
};

/// By id: class, and seeds with places.
using SortedMembers = std::map<ContentHash, std::pair<std::string, std::map<std::uint64_t, MemberPlace>>>;
SortedMembers sorted(const std::vector<ObjectMembers>& objects) {
  SortedMembers all;
  for (const ObjectMembers& object : objects) {
    auto& [class_iri, members] = all[object.id];
    class_iri = object.class_iri;
    for (std::size_t i = 0; i < object.seeds.size(); ++i) members.emplace(object.seeds[i], object.placeOf(i));
  }
  return all;
}

TEST_F(ThingsOfMaps, MembersAreReadTileByTile) {
  const MapReader map(built(0, 3, "map"));
  const std::vector<ObjectMembers> members = storedMembers(map.transaction());
  EXPECT_TRUE(std::is_sorted(members.begin(), members.end(), [](const auto& a, const auto& b) { return a.id < b.id; }));
  EXPECT_EQ(sorted(members), sorted(membersOf(map.objects(), map.scene().cluxels)));
}

/// Of each cell of 0.2 m another point becomes the seed when there are more of them.
TEST_F(ThingsOfMaps, KeepTheirNamesWhenMoreScansSeeThem) {
  const SmallCampus dense({.seed = 2, .stops = 5, .size_m = 45, .points_per_stop = 20000});
  const fs::path map = folder.path() / "map";
  buildMap(scansOf({dense.files()[0]}), *inputs, map, {}, silence());
  const Names first = namesIn(map);
  ASSERT_GT(first.size(), 15U);
  const ChangeReport report = changedBothWays(map, [&](const fs::path& file, const ChangeParams& params) {
    return extendMap(file, scansOf(dense.files()), params, silence());
  });
  EXPECT_EQ(report.objects.gone.size(), 0U);
  std::vector<MapToMerge> parts;
  for (const fs::path& file : dense.files()) {
    parts.push_back({folder.path() / ("part" + std::to_string(parts.size()))});
    buildMap(scansOf({file}), *inputs, parts.back().file, {}, silence());
  }
  const fs::path merged = folder.path() / "merged";
  const ChangeReport of_merge = mergeMaps(parts, merged, {}, silence());
  EXPECT_EQ(canonicalText(merged), canonicalText(map));
  EXPECT_LE(4 * of_merge.objects.gone.size(), of_merge.objects.joined.size()) << "some are decided otherwise";
  expectNothingStale(merged);
  const auto ground = std::find_if(of_merge.after.begin(), of_merge.after.end(), [](const ObjectMembers& object) {
    return object.class_iri == rdf::vocabulary::clx("Ground");
  });
  ASSERT_NE(ground, of_merge.after.end());
  EXPECT_EQ(std::count(of_merge.objects.gone.begin(), of_merge.objects.gone.end(), ground->id), 0);
  for (const auto* objects : {&of_merge.objects.changed, &of_merge.objects.split, &of_merge.objects.joined})
    for (const DerivedObject& object : *objects)
      EXPECT_NE(object.id, ground->id) << "something that is no ground has become the ground";
  const MapReader reader(merged);
  std::map<std::string, int> begins;
  forEachHistoryLink(reader.quads(), "generatedAtTime", [&](const Term& thing, const Term&) {
    if (hashIn(thing.text, "thing")) ++begins[thing.text];
  });
  for (const auto& [thing, count] : begins) EXPECT_EQ(count, 1) << thing;
}

TEST_F(ThingsOfMaps, KeepTheirNamesWhenAMapChanges) {
  const fs::path map = built(0, 1, "map");
  const Names of_first = namesIn(map);
  for (std::size_t stop = 1; stop < 4; ++stop)
    changedBothWays(map, [&](const fs::path& file, const ChangeParams& params) {
      return extendMap(file, scans(stop, stop + 1), params, silence());
    });
  const ScanId last = scans(3, 4).load(0).id;
  Eigen::Isometry3d moved = scans(3, 4).file(0).T_map_sensor;
  moved.pretranslate(Eigen::Vector3d(0.4, -0.3, 0));
  changedBothWays(map, [&](const fs::path& file, const ChangeParams& params) {
    return moveScans(file, {{last, moved}}, params, silence());
  });
  const Names of_all = namesIn(map);
  for (const double shift_m : {0.3, 0.0})
    changedBothWays(map, [&](const fs::path& file, const ChangeParams& params) {
      std::vector<ScanPose> poses;
      for (std::size_t stop = 0; stop < 4; ++stop) {
        poses.push_back({scans(stop, stop + 1).load(0).id, scans(stop, stop + 1).file(0).T_map_sensor});
        poses.back().T_map_sensor.pretranslate(Eigen::Vector3d(shift_m, 0, 0));
      }
      return moveScans(file, poses, params, silence());
    });
  std::size_t back = 0, other = 0;
  for (const auto& [object, thing] : namesIn(map))
    if (const auto known = of_all.find(object); known != of_all.end()) ++(known->second == thing ? back : other);
  EXPECT_GT(back, 0U);
  EXPECT_EQ(other, 0U) << "names have changed hands";
  MapInputFiles files;
  files.model = "campus";
  for (const MapInputs& model : {readMapInputs(files, DataHome(test::sourceFolder())), *inputs})
    changedBothWays(map, [&](const fs::path& file, ChangeParams params) {  // part by part, where it is local
      params.stage_points = params.max_window_share > 1 ? 1500 : 1'000'000;
      return applyInputs(
          file, [&](const MapInputs&) { return model; }, params, silence());
    });
  for (std::size_t stop = 4; --stop > 0;) {
    const ScanId id = scans(stop, stop + 1).load(0).id;
    changedBothWays(map, [&](const fs::path& file, const ChangeParams& params) {
      return retractScans(file, {id}, params, silence());
    });
  }
  std::size_t same = 0;
  for (const auto& [object, thing] : namesIn(map)) same += of_first.at(object) == thing ? 1 : 0;
  EXPECT_GT(2 * same, of_first.size()) << "most things are there under their first names";
  EXPECT_GT(local_commits_, 0U);
  EXPECT_GT(derived_, 10U);
}

TEST_F(ThingsOfMaps, OfMergedMapsEndOnceAndHaveNoObjectThatIsGone) {
  const fs::path a = built(0, 3, "a"), b = folder.path() / "b", merged = folder.path() / "merged";
  fs::copy_file(a, b);
  const ScanId second = scans(1, 2).load(0).id;
  for (const fs::path& map : {a, b}) retractScans(map, {second}, {}, silence());
  extendMap(a, scans(3, 4), {}, silence());
  extendMap(a, scans(1, 2), {}, silence());
  buildMap(scansOf({campus->files()[0], campus->files()[1], campus->files()[3]}), *inputs, folder.path() / "c", {},
           silence());
  mergeMaps({{a}, {b}, {folder.path() / "c"}}, merged, {}, silence());
  expectNothingStale(merged);
  const MapReader reader(merged);
  const ThingLookup lookup(reader.quads());
  const auto present = std::set<ContentHash>(reader.objectIds().begin(), reader.objectIds().end());
  std::size_t ended = 0;
  for (const auto& [thing, time] : timesOfThings(reader.quads())) {
    EXPECT_LE(lookup.endsOf(thing).size(), 1U) << thing;
    ended += lookup.endsOf(thing).size();
  }
  EXPECT_GT(ended, 0U);
  forEachHistoryLink(reader.quads(), "wasInvalidatedBy", [&](const Term& object, const Term&) {
    EXPECT_FALSE(present.contains(*hashIn(object.text, "object"))) << object.text << " is there";
  });
  forEachHistoryLink(reader.quads(), "wasDerivedFrom",
                     [](const Term& object, const Term& from) { EXPECT_NE(object.text, from.text); });
}

/// Other cells of the grid have other seeds, and things are told by where they are.
TEST_F(ThingsOfMaps, KeepTheirNamesWhenAllScansMoveAlike) {
  const fs::path map = built(0, 4, "map"), copy = folder.path() / "copy", moved = folder.path() / "moved";
  fs::copy_file(map, copy);
  const Eigen::Isometry3d T = Eigen::Translation3d(106.07, 53.03, 0) * Eigen::AngleAxisd(1.2, Eigen::Vector3d::UnitZ());
  std::vector<ScanPose> poses;
  for (std::size_t stop = 0; stop < 4; ++stop)
    poses.push_back({scans(stop, stop + 1).load(0).id, T * scans(stop, stop + 1).file(0).T_map_sensor});
  const ChangeReport report = moveScans(copy, poses, {}, silence());
  EXPECT_GT(namesIn(map).size(), 8U);
  EXPECT_LE(report.objects.gone.size(), 1U) << "two by seeds alone";
  expectNothingStale(copy);
  // A map of the same place in another frame.
  const fs::path elsewhere = folder.path() / "elsewhere";
  buildMap(scans(0, 1).posed({{0, T * scans(0, 1).file(0).T_map_sensor}}), *inputs, elsewhere, {}, silence());
  const ChangeReport merged = mergeMaps({{elsewhere}, {map, T, true}}, moved, {}, silence());
  EXPECT_LE(merged.objects.gone.size(), 1U) << "two by seeds alone";
  expectNothingStale(moved);
}

TEST_F(ThingsOfMaps, StayWhenAMapIsMergedWithWhatItWas) {
  const fs::path a = built(0, 2, "a"), old = folder.path() / "old";
  fs::copy_file(a, old);
  for (const std::size_t stop : {3U, 2U}) extendMap(a, scans(stop, stop + 1), {}, silence());
  const Names names = namesIn(a);
  std::vector<MapToMerge> maps{{old}, {a}};
  for (int round = 0; round < 3; ++round) {
    const fs::path target = folder.path() / ("merged" + std::to_string(round));
    mergeMaps(maps, target, {}, silence());
    EXPECT_EQ(canonicalText(target), canonicalText(a));
    EXPECT_EQ(namesIn(target), names);
    expectNothingStale(target);
    maps = round == 0 ? std::vector<MapToMerge>{{a}, {old}} : std::vector<MapToMerge>{{old}, {target}, {a}};
  }
}

TEST_F(ThingsOfMaps, OfMergedMapsGoOnFromAllOfThem) {
  const fs::path a = built(0, 2, "a"), b = built(1, 4, "b");  // both hold the second scan
  const Names of_a = namesIn(a), of_b = namesIn(b);
  ChangeReport one;
  for (const unsigned threads : {1U, 2U}) {
    const fs::path target = folder.path() / ("merged" + std::to_string(threads));
    const ChangeReport report =
        mergeMaps({{a}, {b}}, target, {.change = {.threads = threads}, .use = std::nullopt, .force = false}, silence());
    expectNothingStale(target);
    expectLineage(target, report.objects);
    if (threads == 1) one = report;
  }
  const Names merged = namesIn(folder.path() / "merged1");
  EXPECT_EQ(merged, namesIn(folder.path() / "merged2"));
  std::size_t from_a = 0, from_b = 0;
  for (const auto& [object, thing] : merged)
    for (const auto& [of_map, count] : {std::pair(&of_a, &from_a), std::pair(&of_b, &from_b)})
      *count += std::any_of(of_map->begin(), of_map->end(),
                            [&, &its_thing = thing](const auto& name) { return name.second == its_thing; });
  EXPECT_GT(from_a, 0U);
  EXPECT_GT(from_b, 0U);
  std::size_t lineage_of_b = 0;
  for (const auto* objects : {&one.objects.changed, &one.objects.joined, &one.objects.split})
    for (const DerivedObject& object : *objects)
      for (const ContentHash& from : object.from) lineage_of_b += of_b.contains(from) && !of_a.contains(from) ? 1 : 0;
  EXPECT_GT(lineage_of_b, 0U);
}

}  // namespace
}  // namespace cluxel::mapping
