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
  fs::create_symlink(copyTo("linked.clx"), path("link.pgm"));
  copyTo("site.yaml");
  for (const std::string& arguments : {
           "costmap " + map + " -o " + copyTo("other.pgm"),
           "costmap " + map + " -o " + path("site.pgm").string(),
           "costmap " + map + " -o " + path("link.pgm").string(),
           "search learn " + map + " -o " + copyTo("places.ttl"),
           "rules test --junit " + copyTo("report.xml"),
           "register " + campus + " --force -o " + copyTo("poses.yaml"),
           "export " + map + " --canonical -o " + copyTo("quads.nq"),
           "view " + map + " -o " + copyTo("page.html"),
           "info " + map + " --html " + copyTo("figures.html"),
           "state " + map + " --export " + copyTo("statements.ttl"),
           "rules doc outdoor.rules.yaml -o " + copyTo("rules.md"),
       }) {
    SCOPED_TRACE(arguments);
    expectError(run(arguments), 5, "is a map, which the output would replace");
  }
  for (const char* name : {"other.pgm", "site.yaml", "linked.clx", "places.ttl", "report.xml", "poses.yaml", "quads.nq",
                           "page.html", "figures.html", "statements.ttl", "rules.md"})
    EXPECT_EQ(readFile(path(name)), bytes) << name;
  EXPECT_FALSE(fs::exists(path("site.pgm"))) << "an image without its frame";
}

}  // namespace
}  // namespace cluxel::app
