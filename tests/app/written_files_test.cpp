// SPDX-License-Identifier: Apache-2.0
// Files that commands write.
#include "app/program_fixture.hpp"

namespace cluxel::app {
namespace {

TEST_F(Program, NoOutputReplacesAMap) {
  const std::string map = path("map.clx").string(), campus = path("campus").string();
  const std::string bytes = readFile(map);
  const auto copyTo = [&](const std::string& name) {
    writeFile(path(name), bytes);
    return path(name).string();
  };
  fs::create_symlink(copyTo("of_a_map_linked.clx"), path("of_a_map_link.pgm"));
  copyTo("of_a_map_site.yaml");
  for (const std::string& arguments : {
           "costmap " + map + " -o " + copyTo("of_a_map_other.pgm"),
           "costmap " + map + " -o " + path("of_a_map_site.pgm").string(),
           "costmap " + map + " -o " + path("of_a_map_link.pgm").string(),
           "search learn " + map + " -o " + copyTo("of_a_map_places.ttl"),
           "rules test --junit " + copyTo("of_a_map_report.xml"),
           "register " + campus + " --force -o " + copyTo("of_a_map_poses.yaml"),
           "export " + map + " --canonical -o " + copyTo("of_a_map_quads.nq"),
           "view " + map + " -o " + copyTo("of_a_map_page.html"),
           "info " + map + " --html " + copyTo("of_a_map_figures.html"),
           "state " + map + " --export " + copyTo("of_a_map_statements.ttl"),
           "dump " + map + " -o " + copyTo("of_a_map_dump.nq"),
           "rules try " + map + " outdoor.rules.yaml --ply " + copyTo("of_a_map_changes.ply"),
           "serve " + map + " --port 0 --log " + copyTo("of_a_map_log.txt"),
           "rules doc outdoor.rules.yaml -o " + copyTo("of_a_map_rules.md"),
       }) {
    SCOPED_TRACE(arguments);
    expectError(run(arguments), 5, "is a map, which the output would replace");
  }
  for (const char* name :
       {"of_a_map_other.pgm", "of_a_map_site.yaml", "of_a_map_linked.clx", "of_a_map_places.ttl", "of_a_map_report.xml",
        "of_a_map_poses.yaml", "of_a_map_quads.nq", "of_a_map_page.html", "of_a_map_figures.html",
        "of_a_map_statements.ttl", "of_a_map_rules.md", "of_a_map_log.txt", "of_a_map_dump.nq", "of_a_map_changes.ply"})
    EXPECT_EQ(readFile(path(name)), bytes) << name;
  EXPECT_FALSE(fs::exists(path("of_a_map_site.pgm"))) << "an image without its frame";
}

TEST_F(Program, AnExportDoesNotReplaceAMap) {
  const std::string map = path("map.clx").string(), before = readFile(map);
  expectError(run("export " + map + " --format ply -o " + map), 5, "is a map");
  expectError(run("export " + map + " --canonical -o " + map), 5, "name another file");
  EXPECT_TRUE(readFile(map) == before);
  EXPECT_EQ(run("export " + map + " -o " + path("again.ply").string()).code, 0);
  EXPECT_EQ(run("export " + map + " -o " + path("again.ply").string()).code, 0) << "another export may be replaced";
}

TEST_F(Program, AReportDoesNotReplaceTheTestsThatItStandsBefore) {
  const fs::path tests = path("mine.rules-test.yaml");
  writeFile(tests, "apiVersion: cluxel.rules.test/v1\n");
  expectError(run("rules test --junit " + tests.string()), 2, "name it *.xml");
  EXPECT_EQ(readFile(tests), "apiVersion: cluxel.rules.test/v1\n");
}

TEST_F(Program, FiguresAreOfMapsAndReplaceNone) {
  const std::string own = path("map.clx").string();
  expectError(run("info " + path("campus").string() + " --html " + path("f.html").string()), 2, "--html needs a map");
  expectError(run("info " + own + " --html " + own), 5, "name another file");
  EXPECT_EQ(run("info " + own).code, 0) << "the map is as it was";
}

}  // namespace
}  // namespace cluxel::app
