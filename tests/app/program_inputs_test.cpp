// SPDX-License-Identifier: Apache-2.0
// Where the program takes its data from, and what it says of maps that are empty, unfinished, or may not be written.
#include <fstream>

#include "app/serve_fixture.hpp"

namespace cluxel::app {
namespace {

/// A working directory with folders of the names that the data home has, full of what would be noticed.
fs::path decoyFolder() {
  const fs::path folder = Program::path("decoy");
  fs::create_directory(folder);
  for (const char* name : {"ontology", "rules", "queries", "models", "labels", "models/oakland"})
    fs::create_directory(folder / name);
  for (const char* name : {"ontology/core.ttl", "ontology/mine.ttl", "rules/outdoor.rules.yaml",
                           "rules/outdoor.rules-test.yaml", "rules/20_avenues.rq", "rules/mine.rq",
                           "queries/street_signs.rq", "models/oakland/model.json", "labels/campus.yaml"})
    writeFile(folder / name, "somebody's draft\n");
  return folder;
}

/// Runs the program in a folder, without --home: it finds the checkout that it was built in.
Outcome runIn(const fs::path& folder, const std::string& arguments) {
  const std::string out = Program::path("stdout").string(), err = Program::path("stderr").string();
  const std::string command = "cd " + folder.string() + " && env -u CLUXEL_HOME " +
                              (test::buildFolder() / "cluxel").string() + " --threads 1 " + arguments + " > " + out +
                              " 2> " + err;
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, readFile(out), readFile(err)};
}

TEST_F(Program, FoldersOfTheWorkingDirectoryAreNotDataFolders) {
  const fs::path decoy = decoyFolder();
  const std::string map = path("map.clx").string();
  const std::vector<std::string> commands{
      "build " + path("campus").string() + " -o " + path("decoy.clx").string() + " --force --json",
      "query " + map + " street_signs.rq --json",
      "tasks --json",
      "rules check",
      "rules test",
      "evaluate " + map + " --truth campus --json",
      "export " + map + " --canonical"};
  for (const std::string& command : commands) {
    const Outcome usual = run(command), there = runIn(decoy, command);
    EXPECT_LT(usual.code, 4) << command << usual.err;
    EXPECT_EQ(there.code, usual.code) << command << there.err;
    EXPECT_EQ(there.out, usual.out) << command;
  }
  EXPECT_EQ(run("export " + path("decoy.clx").string() + " --canonical").out,
            run("export " + map + " --canonical").out);
}

TEST_F(Program, AFolderOfRulesOrOntologyIsAnsweredWithHowToNameItsFiles) {
  const std::string home = test::sourceFolder().string(), rules = home + "/rules", ontology = home + "/ontology";
  const std::string map = path("map.clx").string(), fresh = path("of_folder.clx").string();
  const std::string building = "build " + path("campus").string() + " -o " + fresh;
  const std::string other = rules + " " + rules + "/outdoor.rules.yaml";
  for (const auto& [command, files] : std::vector<std::pair<std::string, std::string>>{
           {building + " --ontology " + ontology, ontology + "/*.ttl"},
           {building + " --rules " + rules, rules + "/*.rules.yaml"},
           {building + " --sparql-rules " + rules, rules + "/*.rq"},
           {"rules apply " + map + " --ontology " + ontology, ontology + "/*.ttl"},
           {"rules apply " + map + " --rules " + rules, rules + "/*.rules.yaml"},
           {"rules apply " + map + " --sparql-rules " + rules, rules + "/*.rq"},
           {"rules check --ontology " + ontology, ontology + "/*.ttl"},
           {"rules test " + rules, rules + "/*.rules-test.yaml"},
           {"rules doc " + rules, rules + "/*.rules.yaml"},
           {"rules try " + map + " " + rules, rules + "/*.rules.yaml"},
           {"rules diff " + map + " " + other, rules + "/*.rules.yaml"}}) {
    SCOPED_TRACE(command);
    expectError(run(command), 4, ": error: is a folder, a file was expected\n  hint: name its files: " + files);
    EXPECT_FALSE(fs::exists(fresh));
  }
}

TEST_F(Program, BuildAndInfoNameTheDataHomeAndTheFiles) {
  const std::string home = test::sourceFolder().string();
  const Outcome again = run("build " + path("campus").string() + " -o " + path("named.clx").string());
  EXPECT_NE(again.err.find("data home " + home), std::string::npos) << again.err;
  EXPECT_NE(again.err.find("rules/outdoor.rules.yaml"), std::string::npos) << again.err;
  const std::string text = run("info " + path("named.clx").string()).out;
  EXPECT_NE(text.find("built with data home " + home + "; ontology ontology/core.ttl"), std::string::npos) << text;
  EXPECT_NE(text.find("model models/oakland/model.json"), std::string::npos) << text;
  const std::string json = run("info --json " + path("named.clx").string()).out;
  EXPECT_NE(json.find("\"home\": \"" + home), std::string::npos) << json;
  EXPECT_NE(json.find(home + "/rules/20_avenues.rq"), std::string::npos) << json;
}

TEST_F(Program, BuildAndInfoNameTheCoordinateSystem) {
  const fs::path manifest = path("georeferenced.yaml"), map = path("georeferenced.clx");
  std::ofstream(manifest) << "map_origin: [456000, 5412000, 0]\ncrs: EPSG:25832\nscans:\n  - "
                          << path("campus/scan_000.pcd").string() << "\n";
  const Outcome build = run("build " + manifest.string() + " -o " + map.string());
  ASSERT_EQ(build.code, 0) << build.err;
  EXPECT_NE(build.err.find("coordinate system of the map: EPSG:25832"), std::string::npos) << build.err;
  EXPECT_NE(run("info " + map.string()).out.find("coordinate system: EPSG:25832"), std::string::npos);
  EXPECT_NE(run("info --json " + map.string()).out.find("\"crs\": \"EPSG:25832\""), std::string::npos);
}

/// The first scan is committed before the second one is found to be cut.
fs::path unfinishedMap() {
  const fs::path scans = Program::path("cut_campus"), map = Program::path("cut_campus.clx");
  if (fs::exists(map)) return map;
  fs::copy(Program::path("campus"), scans);
  fs::path last;
  for (const auto& entry : fs::directory_iterator(scans))
    if (entry.path().extension() == ".pcd" && entry.path() > last) last = entry.path();
  fs::resize_file(last, fs::file_size(last) - 100);
  return map;
}

TEST_F(Program, AnswersFromAnUnfinishedMapComeWithANote) {
  const std::string map = unfinishedMap().string();
  const Outcome build = run("build " + path("cut_campus").string() + " -o " + map + " --batch-points 1");
  ASSERT_EQ(build.code, 4) << build.err;
  ASSERT_TRUE(fs::exists(map));
  for (const std::string& command :
       {"query " + map + " -e 'SELECT * { ?s a ?c } LIMIT 1'", "export " + map + " --canonical",
        "explain " + map + " 0", "evaluate " + map + " --truth campus", "dump " + map}) {
    const Outcome told = run(command), silent = run(command + " --allow-unfinished");
    EXPECT_EQ(told.code, 0) << command << told.err;
    EXPECT_NE(told.err.find("the build of this map is unfinished"), std::string::npos) << command << told.err;
    EXPECT_EQ(silent.err.find("unfinished"), std::string::npos) << command << silent.err;
    EXPECT_EQ(told.out, silent.out) << command;
  }
  EXPECT_EQ(run("export " + path("map.clx").string() + " --canonical").err, "") << "a finished map";
  EXPECT_EQ(run("dump " + path("map.clx").string()).err, "") << "a finished map";

  const std::string serve = program() + "serve --port 0 --quiet finished=" + path("map.clx").string() + " cut=" + map;
  for (const bool is_allowed : {false, true}) {
    const Served served(serve + (is_allowed ? " --allow-unfinished" : ""), path("serve.log"));
    EXPECT_EQ(readFile(path("serve.log")).find("cut_campus.clx: warning: the build of this map is unfinished") ==
                  std::string::npos,
              is_allowed);
    EXPECT_EQ(readFile(path("serve.log")).find(path("map.clx").string()), std::string::npos);
    for (const char* resource : {"/objects", "/sparql?query=ASK%7B%7D", "/questions/objects", ""}) {
      SCOPED_TRACE(resource);
      const Reply cut = served.get(std::string("/maps/cut") + resource);
      EXPECT_EQ(cut.status, 200) << cut.head;
      EXPECT_EQ(cut.header("Cluxel-Warning").find("the build of this map is unfinished") == std::string::npos,
                is_allowed);
      EXPECT_EQ(served.get(std::string("/maps/finished") + resource).header("Cluxel-Warning"), "");
    }
  }
}

TEST_F(Program, ThatAMapIsUnfinishedIsToldBeforeFaultsOfTheOtherArguments) {
  const std::string map = path("cut_again.clx").string();
  unfinishedMap();  // makes the cut campus
  ASSERT_EQ(run("build " + path("cut_campus").string() + " -o " + map + " --batch-points 1").code, 4);
  for (const std::string& arguments :
       {"extend " + map + " absent-input", "repose " + map + " absent-input", "retract " + map + " scan_999.pcd",
        "state " + map + " --object nn --label x", "rules apply " + map + " --rules absent-input"}) {
    SCOPED_TRACE(arguments);
    expectError(run(arguments), 2, "its build is unfinished");
  }
}

TEST_F(Program, AnEmptyFileIsNoMapInEveryCommandThatNeedsOne) {
  const std::string empty = path("empty.clx").string(), map = path("map.clx").string();
  const std::string campus = path("campus").string(), fresh = path("never.clx").string();
  writeFile(empty, "");
  for (const std::string& arguments : std::vector<std::string>{"info " + empty,
                                                               "query " + empty + " -e 'ASK {}'",
                                                               "update " + empty + " -e 'CLEAR ALL'",
                                                               "explain " + empty + " 1234",
                                                               "state " + empty + " --list",
                                                               "state " + empty + " --object 1234 --label x",
                                                               "extend " + empty + " " + campus,
                                                               "retract " + empty + " scan_000.pcd",
                                                               "repose " + empty + " " + campus,
                                                               "merge " + empty + " " + map + " -o " + fresh,
                                                               "merge " + map + " " + empty + " -o " + fresh,
                                                               "rules apply " + empty + " --model campus",
                                                               "rules try " + empty + " outdoor.rules.yaml",
                                                               "evaluate " + empty + " --truth " + campus + "/truth",
                                                               "export " + empty + " --canonical",
                                                               "dump " + empty,
                                                               "view " + empty + " -o " + fresh,
                                                               "compact " + empty,
                                                               "compact " + empty + " -o " + fresh,
                                                               "doctor " + empty}) {
    SCOPED_TRACE(arguments);
    expectError(run(arguments), 5, "empty.clx: is empty, a map was expected");
    EXPECT_EQ(fs::file_size(empty), 0U);
    EXPECT_FALSE(fs::exists(fresh));
  }
}

TEST_F(Program, TheUpAxisThatIsStatedIsDoubtedWhereTheGroundTellsOtherwise) {
  const std::string scan = path("campus/scan_000.pcd").string();
  const Outcome stated = run("info " + scan + " --up y");
  EXPECT_NE(stated.err.find("z must point up; leave --up y out\n"), std::string::npos) << stated.err;
  EXPECT_EQ(run("info " + scan).err.find("--up"), std::string::npos);
}

/// A name that is too long is one of many reasons for which the system does not let the program look at a file.
TEST_F(Program, WhatTheSystemRefusesToLookAtIsToldLikeWhatIsNotThere) {
  const std::string refused = path(std::string(300, 'x')).string(), fresh = path("of_refused.clx").string();
  const std::string map = path("map.clx").string(), campus = path("campus").string();
  const std::vector<std::pair<std::string, int>> cases{{"info " + refused, 4},
                                                       {"build " + refused + " -o " + fresh, 4},
                                                       {"build " + campus + " -o " + refused, 5},
                                                       {"extend " + refused + " " + campus, 5},
                                                       {"extend " + map + " " + refused, 4},
                                                       {"retract " + refused + " 0000", 5},
                                                       {"watch " + campus + " --idle 0.1 -o " + refused, 5},
                                                       {"compact " + refused, 5},
                                                       {"compact " + map + " -o " + refused, 5},
                                                       {"doctor " + refused, 5},
                                                       {"query " + refused + " objects", 5},
                                                       {"evaluate " + map + " --truth " + refused, 4},
                                                       {"rules check " + refused, 4},
                                                       {"rules fit " + refused + " --truth campus", 5},
                                                       {"simulate " + refused, 5},
                                                       {"register " + campus + " -o " + refused + ".yaml", 5},
                                                       {"export " + map + " -o " + refused + ".ply", 5}};
  for (const auto& [arguments, code] : cases) {
    SCOPED_TRACE(arguments);
    const Outcome outcome = run(arguments);
    expectError(outcome, code, "xxx");
    EXPECT_EQ(outcome.err.find("filesystem error"), std::string::npos) << outcome.err;
  }
}

TEST_F(Program, ALabelMapServesSeveralMapsAndEachDoubtAboutItIsNotedOnce) {
  const std::string map = path("map.clx").string(), labels = path("own_class.yaml").string();
  writeFile(labels, "counts_as: {Bsh: Bush}\nlabels:\n  30: {name: bush, object: Bush}\n");
  const Outcome outcome = run("evaluate " + map + " " + map + " --truth " + labels);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const std::string doubt = "counts_as: the ontology of the map has no class 'Bsh'";
  const std::size_t first = outcome.err.find(doubt);
  ASSERT_NE(first, std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.err.find(doubt, first + 1), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("in earlier maps, too"), std::string::npos) << "the map is given twice\n" << outcome.err;
  EXPECT_EQ(run("evaluate " + map + " --truth " + labels).err.find("in earlier maps"), std::string::npos);
}

TEST_F(Program, ARecallIsAskedOfAClassInEveryWayOfWritingIt) {
  const std::string map = path("map.clx").string(), labels = path("own_class.yaml").string();
  writeFile(labels, "labels:\n  30: {name: bush, object: Bush}\n");
  for (const char* written : {"Bush", "bush", "clx:Bush", "BUSH"})
    EXPECT_EQ(run("evaluate " + map + " --truth " + labels + " --min-recall " + written + "=0").code, 0) << written;
  expectError(run("evaluate " + map + " --truth " + labels + " --min-recall Unicorn=0"), 2, "Unicorn");
  expectError(run("evaluate " + map + " --truth " + labels + " --min-recall Barrier=0"), 2, "no class 'Barrier'");
}

TEST_F(Program, AnEmptyFileIsFilledByWhatMakesMapsAndStores) {
  const std::string store = path("filled_store.clx").string(), map = path("filled.clx").string();
  for (const std::string& file : {store, map}) writeFile(file, "");
  expectError(run("load " + store + " " + path("absent.ttl").string()), 4, "absent.ttl");
  EXPECT_EQ(fs::file_size(store), 0U) << "after an error a store is as it was";
  EXPECT_EQ(run("load " + store + " " + path("three.ttl").string()).code, 0);
  EXPECT_EQ(query("filled_store.clx", "ASK { ?s ?p 3 }").out, "yes\n");
  EXPECT_EQ(run("build " + path("campus").string() + " -o " + map).code, 0);
}

}  // namespace
}  // namespace cluxel::app
