// SPDX-License-Identifier: Apache-2.0
// One MapExtension gives what a program gives that reads the whole map for each extension, whatever happens in between.
#include <gtest/gtest.h>

#include "base/file_bytes.hpp"
#include "cluxel/error.hpp"
#include "mapping/change/map_change.hpp"
#include "mapping/change/map_compaction.hpp"
#include "mapping/change/map_update.hpp"
#include "mapping/small_campus.hpp"
#include "rdf/map_iris.hpp"

namespace cluxel::mapping {
namespace {

namespace fs = std::filesystem;

class MapExtensionTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    campus = new SmallCampus({.seed = 8, .stops = 4, .size_m = 45, .points_per_stop = 1500});
  }
  static void TearDownTestSuite() { delete campus; }

  MapExtensionTest() { buildMap(scan(0), shippedInputs(), map, {}, silence()); }

  static ScanSet scan(std::size_t number) { return scansOf({campus->files()[number]}); }

  /// The text of the map, and what the report says.
  static std::string outcome(const fs::path& file, const ChangeReport& report) {
    std::string text;
    for (const std::size_t count :
         {report.scans_added, report.scans_already_there, report.tiles_touched, report.tiles_changed, report.scans,
          report.tiles, report.cluxels, report.primitives, report.before.size(), report.after.size(),
          report.objects.unchanged, report.objects.added.size(), report.objects.gone.size(),
          report.objects.changed.size(), report.objects.split.size(), report.objects.joined.size()})
      text += std::to_string(count) + " ";
    return text + "\n" + canonicalText(file);
  }

  void expectAsByAnother(std::size_t number) {
    const fs::path copy = folder.path() / "copy.clx";
    fs::copy_file(map, copy, fs::copy_options::overwrite_existing);
    const std::string expected = outcome(copy, extendMap(copy, scan(number), {}, silence()));
    EXPECT_TRUE(outcome(map, extension.add(scan(number))) == expected) << "scan " << number;
  }

  ScratchFolder folder;
  fs::path map = folder.path() / "map.clx";
  MapExtension extension{map, {}, silence()};
  static inline SmallCampus* campus = nullptr;
};

TEST_F(MapExtensionTest, GoesOnFromItsLastCommit) {
  expectAsByAnother(1);
  expectAsByAnother(2);
  expectAsByAnother(2);  // is there
  expectAsByAnother(3);
  EXPECT_TRUE(canonicalText(map) == builtText(campus->files(), shippedInputs()));
}

TEST_F(MapExtensionTest, SeesWhatOthersChangeInBetween) {
  expectAsByAnother(1);
  const ScanId first = scan(0).load(0).id;
  retractScans(map, {first}, {}, silence());
  expectAsByAnother(2);
  std::string object;
  {
    const MapReader reader(map);
    for (const rules::SemanticObject& thing : reader.objects())
      if (thing.class_iri != vocabulary::clx("Ground")) object = rdf::iriOfObject(thing.id);
  }
  updateMap(map, "INSERT DATA { <" + object + "> a <" + vocabulary::clx("UtilityPole") + "> }", {}, silence());
  expectAsByAnother(3);
  compactMap(map);
  expectAsByAnother(0);
  EXPECT_NE(canonicalText(map), builtText(campus->files(), shippedInputs())) << "the statement had no effect";
}

TEST_F(MapExtensionTest, GoesOnAfterAScanThatCannotBeRead) {
  expectAsByAnother(1);
  const fs::path broken = folder.path() / "broken.pcd";
  const std::string bytes = readFile(campus->files()[2]);
  writeFile(broken, bytes.substr(0, bytes.size() / 2));
  EXPECT_THROW(extension.add(scansOf({broken})), InputError);
  expectAsByAnother(2);
}

TEST_F(MapExtensionTest, LetsOthersChangeTheMapWhileItRests) {
  extension.add(scan(1));
  EXPECT_NO_THROW(extendMap(map, scan(2), {}, silence()));
  expectAsByAnother(3);
  EXPECT_TRUE(canonicalText(map) == builtText(campus->files(), shippedInputs()));
}

}  // namespace
}  // namespace cluxel::mapping
