// SPDX-License-Identifier: Apache-2.0
// What `update` and `load` tell of the objects they change: the same as what `state` tells of the same statement.
#include <gtest/gtest.h>

#include "base/file_bytes.hpp"
#include "mapping/change/map_update.hpp"
#include "mapping/change/rdf_loading.hpp"
#include "mapping/change/statement_change.hpp"
#include "mapping/small_campus.hpp"
#include "rdf/map_iris.hpp"

namespace cluxel::mapping {
namespace {

namespace fs = std::filesystem;

std::string textOf(const ChangeReport& report) {
  std::string text;
  const auto add = [&](const std::string& name, const auto& objects) {
    text += name + ":";
    for (const auto& object : objects) text += " " + object.hex();
  };
  const auto addDerived = [&](const std::string& name, const std::vector<DerivedObject>& objects) {
    for (const DerivedObject& object : objects) {
      text += name + " " + object.id.hex();
      add(" from", object.from);
    }
  };
  add("added", report.objects.added), add("gone", report.objects.gone);
  addDerived("changed", report.objects.changed), addDerived("split", report.objects.split);
  addDerived("joined", report.objects.joined);
  for (const StatementOutcome& outcome : report.statements) text += " statement " + outcome.statement.id().hex();
  for (const std::size_t count : {report.objects.unchanged, report.objects.redecided.size(), report.tiles_decided,
                                  report.local_commits, report.scans, report.tiles, report.object_count})
    text += " " + std::to_string(count);
  return text;
}

class UpdateReports : public testing::Test {
 protected:
  UpdateReports() : campus_({.seed = 8, .stops = 1, .size_m = 45, .points_per_stop = 2000}) {
    buildMap(scansOf(campus_.files()), shippedInputs(), built_, {}, silence());
    const MapReader reader(built_);
    for (const SemanticObject& object : reader.objects())
      if (object.class_iri == vocabulary::clx("Tree")) {
        quad_ = "<" + iriOfObject(object.id) + "> <" + vocabulary::rdf("type") + "> <" + vocabulary::clx("StreetSign") +
                ">";
        statement_ = {StatementKind::Is,
                      "",
                      Term::iri(vocabulary::clx("StreetSign")),
                      anchorOf(reader.stagesWithPoints(), object),
                      {}};
      }
  }
  fs::path copy(const std::string& name) const {
    fs::copy_file(built_, folder_.path() / name, fs::copy_options::overwrite_existing);
    return folder_.path() / name;
  }
  std::string update() const { return "INSERT DATA { " + quad_ + " }"; }

  SmallCampus campus_;
  ScratchFolder folder_;
  fs::path built_ = folder_.path() / "built.clx";
  std::string quad_;
  Statement statement_;
};

TEST_F(UpdateReports, TellOfObjectsWhatStateTells) {
  const fs::path stated = copy("stated.clx"), updated = copy("updated.clx"), loaded = copy("loaded.clx");
  const ChangeReport expected = changeStatements(stated, {{statement_}, {}, "anna"}, {}, silence());
  ASSERT_EQ(expected.objects.changed.size(), 1U);
  EXPECT_GT(expected.tiles_decided, 0U);

  const MapUpdateReport report = updateMap(updated, update(), {}, silence());
  EXPECT_TRUE(report.is_map);
  EXPECT_TRUE(report.change.has_changes);
  EXPECT_EQ(textOf(report.change), textOf(expected));
  EXPECT_TRUE(canonicalText(updated) == canonicalText(stated));

  const fs::path file = folder_.path() / "sign.nt";
  writeFile(file, quad_ + " .\n");
  EXPECT_EQ(textOf(loadRdfFiles(loaded, {file}, {}, silence()).change), textOf(expected));
}

TEST_F(UpdateReports, OfADryRunAreThoseOfTheChangeAndNothingIsWritten) {
  const fs::path map = copy("map.clx"), file = folder_.path() / "sign.nt", none = folder_.path() / "none.clx";
  writeFile(file, quad_ + " .\n");
  const std::string before = readFile(map);
  const MapUpdateReport dry = updateMap(map, update(), {}, silence(), {.dry_run = true});
  const RdfLoadReport dry_load = loadRdfFiles(map, {file}, {.dry_run = true}, silence());
  EXPECT_TRUE(readFile(map) == before);
  const MapUpdateReport real = updateMap(map, update(), {}, silence());
  EXPECT_EQ(dry.inserted, real.inserted);
  EXPECT_EQ(dry_load.added, 1U);
  EXPECT_EQ(textOf(dry.change), textOf(real.change));
  EXPECT_EQ(textOf(dry_load.change), textOf(real.change));

  EXPECT_EQ(loadRdfFiles(none, {file}, {.dry_run = true}, silence()).added, 1U);
  EXPECT_FALSE(fs::exists(none)) << "a dry run makes no store";
  EXPECT_THROW(loadRdfFiles(folder_.path() / "no" / "store.clx", {file}, {.dry_run = true}, silence()), Error);
  writeFile(none, "");
  const auto written = fs::last_write_time(none);
  EXPECT_EQ(loadRdfFiles(none, {file}, {.dry_run = true}, silence()).added, 1U);
  EXPECT_EQ(fs::last_write_time(none), written) << "nor fills one, which others may load into meanwhile";
  EXPECT_EQ(fs::file_size(none), 0U);
}

TEST_F(UpdateReports, OfAFactThatIsAboutNoObjectNameNone) {
  const fs::path map = copy("map.clx");
  const MapUpdateReport report = updateMap(map, "INSERT DATA { <http://x/a> <http://x/b> 1 }", {}, silence());
  EXPECT_TRUE(report.change.has_changes);
  EXPECT_TRUE(report.change.objects.isEmpty());
  EXPECT_EQ(report.change.tiles_decided, 0U);
  EXPECT_EQ(report.change.objects.unchanged, MapReader(map).summary().objects);
  const ChangeReport again = updateMap(map, "INSERT DATA { <http://x/a> <http://x/b> 1 }", {}, silence()).change;
  EXPECT_FALSE(again.has_changes);
  EXPECT_EQ(again.objects.unchanged, report.change.objects.unchanged);
}

}  // namespace
}  // namespace cluxel::mapping
