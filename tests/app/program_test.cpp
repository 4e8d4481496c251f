// SPDX-License-Identifier: Apache-2.0
// The program as its users run it: exit codes, data on stdout, and messages of errors.
#include <fcntl.h>

#include <nlohmann/json.hpp>

#include "app/program_fixture.hpp"
#include "rdf/file/file_guards.hpp"
#include "rdf/holes.hpp"

namespace cluxel::app {

using namespace rdf;
namespace {

using Json = nlohmann::json;

TEST_F(Program, BuildsAMapAndTellsSoInJson) {
  ASSERT_EQ(built.code, 0) << built.err;
  const Json report = Json::parse(built.out);
  EXPECT_EQ(report.at("scans"), 2);
  EXPECT_GT(report.at("objects"), 0);
  EXPECT_EQ(Json::parse(simulated).at("scans"), 2);
  const Json info = Json::parse(run("info " + path("map.clx").string() + " --json").out);
  EXPECT_EQ(info.at("clouds"), 2);
  EXPECT_EQ(info.at("finished"), true);
  EXPECT_EQ(info.at("objects"), report.at("objects"));
  std::uintmax_t bytes = 0;
  const Json layers = Json::parse(run("info " + path("map.clx").string() + " --layers --json").out);
  for (const Json& layer : layers.at("layers")) bytes += layer.at("bytes").get<std::uintmax_t>();
  EXPECT_EQ(bytes, fs::file_size(path("map.clx"))) << "every byte belongs to a layer";
  EXPECT_GT(layers.at("disk_bytes"), bytes / 2);
  EXPECT_NE(run("info " + path("map.clx").string() + " --layers").out.find("layer scan_points"), std::string::npos);
  EXPECT_EQ(Json::parse(run("info " + path("campus").string() + " --json").out).at("scans").size(), 2U);
  const Json clouds = Json::parse(run("info " + path("map.clx").string() + " --clouds --json").out).at("cloud_list");
  ASSERT_FALSE(clouds.empty());
  EXPECT_EQ(clouds[0].at("T_map_sensor")[3], Json({0.0, 0.0, 0.0, 1.0}));
  for (const int axis : {0, 1, 2}) EXPECT_EQ(clouds[0].at("sensor")[axis], clouds[0].at("T_map_sensor")[axis][3]);
  EXPECT_NE(run("info " + path("map.clx").string() + " --clouds").out.find("sensor at "), std::string::npos);
}

/// A lock file that is a link is not written, so that the map is read from a copy in the temporary folder.
TEST_F(Program, TellsWhatTheNamedMapTakesOnTheDiskWhenItReadsACopy) {
  const fs::path map = path("read_from_a_copy.clx");
  fs::copy_file(path("map.clx"), map);
  fs::create_symlink(path("three.ttl"), map.string() + "-lock");
  {
    const Descriptor file(::open(map.c_str(), O_RDWR | O_CLOEXEC));  // room behind the end, which no copy has
    if (::fallocate(file.get(), FALLOC_FL_KEEP_SIZE, static_cast<off_t>(fs::file_size(map)), 8 << 20) != 0)
      GTEST_SKIP() << "the file system reserves no room";
  }
  const Outcome info = run("info " + map.string() + " --layers --json");
  ASSERT_EQ(info.code, 0) << info.err;
  EXPECT_EQ(Json::parse(info.out).at("disk_bytes"), diskBytes(map));
}

TEST_F(Program, AnswersWithExitCodeZeroAndData) {
  const Outcome rows = query("three.ttl", "SELECT ?o WHERE { ?s ?p ?o } ORDER BY ?o", "--format csv");
  EXPECT_EQ(rows.code, 0);
  EXPECT_EQ(rows.out, "o\r\n1\r\n2\r\n3\r\n");
  const Json json = Json::parse(query("three.ttl", "SELECT ?o WHERE { ?s ?p ?o }", "--json").out);
  EXPECT_EQ(json.at("results").at("bindings").size(), 3U);
}

TEST_F(Program, AnAskThatIsFalseIsExitCodeOneAndATrueOneZero) {
  EXPECT_EQ(query("three.ttl", "ASK { ?s ?p 4 }").code, 1);
  EXPECT_EQ(query("three.ttl", "ASK { ?s ?p 3 }").code, 0);
}

TEST_F(Program, AWrongCommandLineIsExitCodeTwo) {
  expectError(run("query --no-such-option"), 2, "");
  expectError(run(""), 2, "");
  expectError(run("no-such-command"), 2, "");
  expectError(run("query " + path("three.ttl").string()), 2, "-e TEXT");
  expectError(query("three.ttl", "ASK { }", "--param a=1"), 2, "a=1");
  expectError(query("three.ttl", "ASK { }", "--format docx"), 2, "docx");
  expectError(run("build " + path("campus").string() + " -o " + path("map.clx").string()), 2, "--force");
}

TEST_F(Program, NoRowsAreExitCodeThree) {
  EXPECT_EQ(query("three.ttl", "SELECT * WHERE { ?s ?p 4 }").code, 3);
}

TEST_F(Program, FaultyInputIsExitCodeFourAndNamesFileAndLine) {
  writeFile(path("broken.rq"), "SELECT *\nWHERE { ?s ?p }\n");
  expectError(run("query " + path("three.ttl").string() + " " + path("broken.rq").string()), 4, "broken.rq:2:");
  writeFile(path("broken.ttl"), "@prefix e: <https://e.org/> .\ne:a e:p ;\n");
  expectError(query("broken.ttl", "ASK { }"), 4, "broken.ttl:");
  writeFile(path("broken.pcd"), "VERSION .7\nFIELDS x y\nSIZE 4 four\n");
  expectError(run("info " + path("broken.pcd").string()), 4, "broken.pcd:");
  expectError(run("info " + path("absent.pcd").string()), 4, "absent.pcd");
  expectError(run("build " + path("absent.pcd").string() + " -o " + path("never.clx").string()), 4, "absent.pcd");
  EXPECT_FALSE(fs::exists(path("never.clx")));
  expectError(run("query " + path("three.ttl").string() + " no-such-question"), 4, "no-such-question");
}

TEST_F(Program, FaultyRulesAreExitCodeFourWithLineAndCaret) {
  writeFile(path("faulty.rules.yaml"), "apiVersion: cluxel.rules/v1\nordr: [clx:Tree]\n");
  const Outcome text = run("rules check " + path("faulty.rules.yaml").string());
  EXPECT_EQ(text.code, 4);
  EXPECT_NE((text.out + text.err).find("faulty.rules.yaml:2:"), std::string::npos) << text.out << text.err;
  const Outcome json = run("rules check --json " + path("faulty.rules.yaml").string());
  EXPECT_EQ(json.code, 4);
  EXPECT_GE(Json::parse(json.out).size(), 1U);
  EXPECT_EQ(Json::parse(json.out)[0].at("line"), 2);
}

TEST_F(Program, TheShippedRulesHaveNoFaults) {
  const Outcome check = run("rules check --json");
  EXPECT_EQ(check.code, 0);
  for (const Json& fault : Json::parse(check.out)) EXPECT_NE(fault.at("severity"), "error") << fault;
}

TEST_F(Program, WhatIsNoMapIsExitCodeFive) {
  writeFile(path("no-map.clx"), std::string(20'000, 'x'));
  expectError(query("no-map.clx", "ASK { }"), 5, "no-map.clx");
  expectError(run("export " + path("no-map.clx").string() + " --canonical"), 5, "no-map.clx");
}

TEST_F(Program, ASpentBudgetIsExitCodeSixWithoutHalfAnAnswer) {
  expectError(query("three.ttl", "SELECT * WHERE { ?s ?p ?o }", "--max-rows 2"), 6, "");
  expectError(query("map.clx", "SELECT (COUNT(*) AS ?n) WHERE { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i }", "--deadline 0.05"),
              6, "");
}

TEST_F(Program, ListsItsQuestions) {
  const Json tasks = Json::parse(run("tasks --json").out);
  ASSERT_GE(tasks.size(), 5U);
  for (const Json& task : tasks) EXPECT_NE(task.at("title"), "");
}

TEST_F(Program, HelpsWithEverySubcommand) {
  for (const char* name :
       {"", "info", "simulate", "register", "build", "query", "update", "load", "dump", "tasks", "explain", "rules",
        "rules check", "rules test", "train", "evaluate", "export", "compact", "doctor"}) {
    const Outcome help = run(std::string(name) + " --help");
    EXPECT_EQ(help.code, 0) << name;
    EXPECT_NE(help.out.find("--help"), std::string::npos) << name;
  }
  EXPECT_EQ(run("--version").out.substr(0, 7), "cluxel ");
}

/// The C library has other code for exp, log and sine there. On a processor without FMA both runs use the same code.
TEST_F(Program, AProcessorWithoutFusedMultiplyAddMakesTheSameMap) {
  const std::string other = path("without_fma.clx").string();
  ASSERT_EQ(setenv("GLIBC_TUNABLES", "glibc.cpu.hwcaps=-AVX2,-FMA,-AVX2_Usable,-FMA_Usable", 1), 0);
  const Outcome built_there = run("build " + path("campus").string() + " -o " + other);
  unsetenv("GLIBC_TUNABLES");
  ASSERT_EQ(built_there.code, 0) << built_there.err;
  const std::string expected = run("export --canonical " + path("map.clx").string()).out;
  EXPECT_GT(expected.size(), 1000U);
  EXPECT_EQ(run("export --canonical " + other).out, expected);
}

TEST_F(Program, InfoKnowsAMapByItsContentNotByItsName) {
  fs::copy_file(path("map.clx"), path("renamed.backup"));
  const Json info = Json::parse(run("info --json " + path("renamed.backup").string()).out);
  EXPECT_EQ(info.at("clouds"), 2);
  EXPECT_EQ(info.at("objects_by_class"),
            Json::parse(run("info --json " + path("map.clx").string()).out).at("objects_by_class"));
}

TEST_F(Program, InfoTellsOfScansWhatIsInThem) {
  const Json info = Json::parse(run("info --json " + path("campus").string()).out);
  EXPECT_EQ(info.at("points"), Json::parse(simulated).at("points"));
  std::uint64_t points = 0, labelled = 0;
  for (const Json& scan : info.at("scans")) {
    points += scan.at("points").get<std::uint64_t>();
    EXPECT_EQ(scan.at("has_pose"), true);
    EXPECT_EQ(scan.at("id").get<std::string>().size(), 32U);
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_LT(scan.at("extent_map_m").at("min")[axis], scan.at("extent_map_m").at("max")[axis]);
  }
  for (const auto& [label, count] : info.at("labels").items()) labelled += count.get<std::uint64_t>();
  EXPECT_EQ(points, info.at("points"));
  EXPECT_EQ(labelled, info.at("points"));
}

TEST_F(Program, InfoCountsPointsWithoutALabelApart) {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n";
  writeFile(path("labels.ply"), head + "property int label\nend_header\n1 2 3 -1\n4 5 6 7\n");
  EXPECT_NE(run("info " + path("labels.ply").string()).out.find("labels: 7:1 none:1\n"), std::string::npos);
  const Json labels = Json::parse(run("info --json " + path("labels.ply").string()).out).at("labels");
  EXPECT_EQ(labels, (Json{{"7", 1}, {"none", 1}}));
  writeFile(path("labels.txt"), "1 2 3 -1 1\n4 5 6 7 1\n");
  EXPECT_EQ(Json::parse(run("info --json " + path("labels.txt").string()).out).at("labels"), labels);
}

/// What `build` refuses later is no sound scan to `info`.
TEST_F(Program, InfoAndBuildHaveOneLimitOfCoordinates) {
  const std::string out = path("far.clx").string();
  const std::vector<std::pair<std::string, std::string>> far{
      {"20000000 0 0", ""}, {"0 0 20001", ""}, {"0 0 30000000", " --units mm"}, {"0 30000 0", " --up y"}};
  for (const auto& [point, options] : far) {
    writeFile(path("far.xyz"), point + "\n" + point + "\n");
    for (const std::string& command :
         {"info " + path("far.xyz").string(), "build " + path("far.xyz").string() + " -o " + out})
      expectError(run(command + options), 4, "point 0 lies outside the map's range");
  }
  writeFile(path("far.xyz"), "5400000000 400000000 19000000\n5400000001 400000000 19000000\n");  // UTM in millimetres
  EXPECT_EQ(run("info --units mm " + path("far.xyz").string()).code, 0);
}

TEST_F(Program, ANoteBeginsOnce) {
  const Outcome asked = run("ask " + path("map.clx").string() + " count_by_class --why");
  EXPECT_NE(asked.err.find("note: the task count_by_class gives no reasons"), std::string::npos) << asked.err;
  EXPECT_EQ(asked.err.find("note: note:"), std::string::npos);
}

TEST_F(Program, NotesOfAnAnswerAreToldInEveryForm) {
  const std::string closed = "ask " + path("map.clx").string() + " route from=0,0 to=12,3 width=3.5 ";
  const Json answer = Json::parse(run(closed + "--json").out);
  const Json& notes = answer.at("notes");
  ASSERT_GE(notes.size(), 2U);
  const std::string first = notes.at(0), second = notes.at(1);
  ASSERT_EQ(second.substr(0, 2), "  ") << "tables indent lists";
  const std::string told = "note: " + first + "\nnote: " + second.substr(2) + "\n";
  const Outcome csv = run(closed + "--format csv"), geojson = run(closed + "--geojson --local");
  EXPECT_EQ(csv.err.substr(0, told.size()), told);
  EXPECT_EQ(csv.out, "route,length,cost,climb,steepest,highestStep,narrowest\r\n");
  EXPECT_EQ(geojson.err, csv.err);
  EXPECT_EQ(Json::parse(geojson.out).at("notes"), notes);
  const Outcome table = run(closed), json = run(closed + "--json");
  EXPECT_NE(table.out.find(first + "\n" + second + "\n"), std::string::npos) << table.out;
  for (const Outcome& outcome : {csv, geojson, table, json}) EXPECT_EQ(outcome.code, 1);
  EXPECT_EQ(table.err + json.err, "") << "they are told once";
  const Outcome inventory = run("inventory " + path("map.clx").string() + " --format csv");
  EXPECT_EQ(inventory.err.substr(0, 6), "note: ") << inventory.err;
}

TEST_F(Program, DoctorFindsAByteThatChangedAndNamesNothingInAWholeMap) {
  const Json whole = Json::parse(run("doctor --json " + path("map.clx").string()).out);
  EXPECT_GT(whole.at("blocks"), 10);
  EXPECT_GT(whole.at("quads"), 1000);
  std::string bytes = readFile(path("map.clx"));
  std::size_t found = 0;
  for (const std::size_t part : {3U, 5U, 7U, 9U}) {  // somewhere in the scans' points and tiles
    std::string damaged = bytes;
    for (std::size_t i = 0; i < 64; ++i) damaged[damaged.size() * part / 10 + i * 131] ^= 0x55;
    writeFile(path("damaged.clx"), damaged);
    const Outcome check = run("doctor --json " + path("damaged.clx").string());
    ASSERT_TRUE(check.code == 0 || check.code == 1) << check.code << check.err;
    EXPECT_EQ(check.code == 1, !Json::parse(check.out).at("faults").empty());
    found += check.code == 1;
  }
  EXPECT_GE(found, 3U) << "of four damaged copies";
}

TEST_F(Program, CompactInPlaceKeepsTheMapAndLeavesNothingBeside) {
  fs::create_directory(path("compact"));
  const fs::path map = path("compact/map.clx");
  fs::copy_file(path("map.clx"), map);
  writeFile(path("compact/map.clx.compact"), "left by a run that was killed");
  const std::string before = run("export --canonical " + map.string()).out;
  const Outcome compacted = run("compact --json " + map.string());
  ASSERT_EQ(compacted.code, 0) << compacted.err;
  const Json report = Json::parse(compacted.out);
  EXPECT_LE(report.at("bytes_after"), report.at("bytes_before"));
  EXPECT_EQ(report.at("bytes_after"), fs::file_size(map));
  EXPECT_EQ(run("export --canonical " + map.string()).out, before);
  for (const auto& entry : fs::directory_iterator(path("compact"))) {
    const std::string name = entry.path().filename().string();
    EXPECT_TRUE(name == "map.clx" || name == "map.clx-lock") << name;
  }
  expectError(run("compact " + map.string() + " -o " + map.string()), 5, "is there already");
}

TEST_F(Program, DoctorAndExportAgreeThatTheMapIsWhole) {
  EXPECT_EQ(Json::parse(run("doctor --json " + path("map.clx").string()).out).at("faults").size(), 0U);
  const Outcome once = run("export --canonical " + path("map.clx").string());
  ASSERT_EQ(once.code, 0) << once.err;
  EXPECT_GT(once.out.size(), 1000U);
  ASSERT_EQ(run("compact " + path("map.clx").string() + " -o " + path("small.clx").string()).code, 0);
  EXPECT_EQ(run("export --canonical " + path("small.clx").string()).out, once.out);
}

TEST_F(Program, InfoAndEvaluateWriteFiguresBesideWhatTheyPrint) {
  const std::string map = path("map.clx").string(), truth = path("campus/truth").string();
  const std::string figures = path("figures.html").string();
  const Outcome plain = run("info " + map), drawn = run("info " + map + " --html " + figures);
  EXPECT_EQ(drawn.code, 0) << drawn.err;
  EXPECT_EQ(drawn.out, plain.out);
  const Json info = Json::parse(run("info " + map + " --json").out);
  const std::string page = readFile(figures);
  for (const auto& [name, heights] : info.at("heights_by_class").items()) {
    EXPECT_EQ(heights.at("objects"), info.at("objects_by_class").at(name));
    EXPECT_NE(page.find("<th scope=\"row\">" + name + "</th><td>" + heights.at("objects").dump() + "</td>"),
              std::string::npos)
        << name;
  }
  ASSERT_EQ(info.at("runs").size(), 1U);
  EXPECT_EQ(info.at("runs")[0].at("operation"), "build");
  EXPECT_EQ(info.at("runs")[0].at("scans"), info.at("clouds"));
  EXPECT_EQ(run("evaluate " + map + " --truth " + truth + " --html " + figures).code, 0);
  EXPECT_NE(readFile(figures).find("id=\"calibration\""), std::string::npos);
}

}  // namespace
}  // namespace cluxel::app
