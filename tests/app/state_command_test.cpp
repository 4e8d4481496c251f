// SPDX-License-Identifier: Apache-2.0
// `cluxel state`: what it takes, and what it refuses with nothing lost.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "app/program_fixture.hpp"
#include "base/file_bytes.hpp"

namespace cluxel::app {
namespace {

using testing::HasSubstr;
using testing::Not;

class StateCommand : public Program {
 protected:
  void SetUp() override { fs::copy_file(path("map.clx"), map(), fs::copy_options::overwrite_existing); }

  static fs::path map() { return path("stated.clx"); }
  static Outcome state(const std::string& arguments) { return run("state " + map().string() + " " + arguments); }
  /// The id of an object of the class.
  static std::string one(const std::string& local) {
    const Outcome found = query(
        "stated.clx",
        "PREFIX clx: <https://w3id.org/cluxel/ontology#> SELECT ?x { ?x a clx:" + local + " } ORDER BY ?x LIMIT 1",
        "--format csv");
    const std::size_t at = found.out.rfind("object/");
    return at == std::string::npos ? "" : found.out.substr(at + 7, 32);
  }
  static std::size_t listed() { return nlohmann::json::parse(state("--list --json").out).at("statements").size(); }
};

TEST_F(StateCommand, TakesAClassANameAndARemark) {
  const std::string tree = one("Tree");
  ASSERT_EQ(tree.size(), 32u);
  const Outcome stated = state("--object " + tree + " --is clx:StreetLamp --label \"north gate\" --note seen");
  EXPECT_EQ(stated.code, 0) << stated.err;
  const Outcome why_not = run("explain " + map().string() + " " + one("StreetLamp") + " --why-not StreetLamp");
  EXPECT_THAT(why_not.out, HasSubstr("is clx:StreetLamp"));
  EXPECT_THAT(why_not.out, HasSubstr("without the statement the rules decide"));
  EXPECT_EQ(listed(), 3u);
}

TEST_F(StateCommand, UpdateAndLoadReportWhatStateReports) {
  const std::string tree = one("Tree"), object = "<https://w3id.org/cluxel/map/object/" + tree + ">";
  const std::string sign = object + " a <https://w3id.org/cluxel/ontology#StreetSign>";
  const std::string update = "update " + map().string() + " -e 'INSERT DATA { " + sign + " }' --dry-run";
  const fs::path file = path("sign.ttl");
  writeFile(file, sign + " .\n");
  const std::string load = "load " + map().string() + " " + file.string() + " --dry-run";
  const auto json = [](const Outcome& outcome) { return nlohmann::json::parse(outcome.out); };
  const nlohmann::json stated = json(state("--object " + tree + " --is StreetSign --dry-run --json"));
  EXPECT_EQ(stated.at("objects").at("changed").size(), 1u);
  EXPECT_EQ(json(run(update + " --json")).at("change"), stated);
  EXPECT_EQ(json(run(load + " --json")).at("change"), stated);
  EXPECT_EQ(json(run(update + " --json")).at("inserted"), 1) << "the dry run before it wrote nothing";
  for (const std::string& command : {update, load}) {
    const Outcome told = run(command);
    EXPECT_THAT(told.out, HasSubstr("(dry run, nothing written)"));
    EXPECT_THAT(told.out, HasSubstr("decided anew"));
    EXPECT_THAT(told.out, HasSubstr("1 changed: 1 StreetSign"));
  }
  EXPECT_EQ(listed(), 0u);
}

TEST_F(StateCommand, ANewLabelReplacesTheEarlierOneAndNotesAreAdded) {
  const std::string tree = "--object " + one("Tree");
  ASSERT_EQ(state(tree + " --label north --note seen").code, 0);
  const Outcome again = state(tree + " --label south --note felled");
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_THAT(again.err, HasSubstr("replaces the statement"));
  const auto valuesOf = [&](const std::string& property) {
    return query("stated.clx", "SELECT ?v { ?x a clx:Object ; " + property + " ?v } ORDER BY ?v", "--format csv").out;
  };
  EXPECT_EQ(valuesOf("rdfs:label"), "v\r\nsouth\r\n");
  EXPECT_EQ(valuesOf("rdfs:comment"), "v\r\nfelled\r\nseen\r\n");
  EXPECT_THAT(state(tree + " --label south").err, HasSubstr("was made already"));
  EXPECT_EQ(state(tree + " --label north").code, 0) << "a label that was withdrawn";
  EXPECT_EQ(valuesOf("rdfs:label"), "v\r\nnorth\r\n");
  EXPECT_EQ(listed(), 3u);
  expectError(state(tree + " --label east --label west"), 2, "state: --label is given 2 times; give it once");
}

TEST_F(StateCommand, StatementsThatCanBothBeTrueStandTogether) {
  const auto stated = [] { return "--object " + one("Object ; clx:rule \"operator\""); };
  ASSERT_EQ(state("--object " + one("Tree") + " --is Barrier").code, 0);
  for (const char* derived : {"Fence", "Wall"}) {
    const Outcome outcome = state(stated() + " --is-not " + derived);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, Not(HasSubstr("replaces")));
  }
  EXPECT_EQ(listed(), 3u);
  EXPECT_EQ(one("Barrier ; clx:rule \"operator\"").size(), 32u) << "it is the barrier that was stated";
  EXPECT_THAT(state(stated() + " --is Fence").err, HasSubstr("replaces the statement"));
  const std::string list = state("--list").out;
  EXPECT_THAT(list, HasSubstr("is clx:Fence"));
  EXPECT_THAT(list, HasSubstr("is not clx:Wall"));
  EXPECT_THAT(list, Not(HasSubstr("is clx:Barrier")));
  EXPECT_THAT(list, Not(HasSubstr("is not clx:Fence")));
  EXPECT_EQ(listed(), 2u) << "a barrier is no fence by itself, and a fence that is none cannot be";
}

TEST_F(StateCommand, TellsWhichDerivedClassesAStatementRulesOut) {
  const fs::path own = path("own.rq");
  writeFile(own,
            "PREFIX clx: <https://w3id.org/cluxel/ontology#>\n"
            "CONSTRUCT { ?b a clx:Fence } WHERE { ?b a clx:Barrier }\n");
  ASSERT_EQ(run("rules apply " + map().string() + " --sparql-rules " + own.string()).code, 0);
  ASSERT_EQ(state("--object " + one("Tree") + " --is Barrier").code, 0);
  const std::string fence = one("Fence ; clx:rule \"operator\""), said = "before, SPARQL rule own.rq said of it";
  EXPECT_THAT(state("--object " + fence + " --is-not Wall").err, Not(HasSubstr(said))) << "it stays a fence";
  const Outcome stated = state("--object " + fence + " --is-not Fence");
  ASSERT_EQ(stated.code, 0) << stated.err;
  EXPECT_THAT(stated.err, HasSubstr(said + " Fence"));
  const std::string why_not = "explain " + map().string() + " " + fence + " --why-not Fence";
  EXPECT_THAT(run(why_not).out, HasSubstr("rules out that a SPARQL rule says clx:Fence"));
  const nlohmann::json json = nlohmann::json::parse(run(why_not + " --json").out);
  EXPECT_FALSE(json.at("is_of_class").get<bool>());
  ASSERT_EQ(json.at("ruled_out_by").size(), 1u);
  EXPECT_THAT(state("--list").out, HasSubstr(json.at("ruled_out_by")[0].get<std::string>().substr(0, 8)));
}

TEST_F(StateCommand, ALabelDoesNotControlTheTerminal) {
  const std::string tree = one("Tree");
  const Outcome stated = state("--object " + tree + " --label \"$(printf 'a\\033[31mred\\007\\302\\233')\"");
  ASSERT_EQ(stated.code, 0) << stated.err;
  for (const std::string& shown :
       {stated.out, stated.err, state("--list").out, run("explain " + map().string() + " " + tree).out})
    EXPECT_EQ(shown.find_first_of("\033\007"), std::string::npos) << shown;
  EXPECT_THAT(state("--list").out, HasSubstr("a\\u001B[31mred\\u0007\\u009B"));
}

/// A class of another namespace is called Tree too: names mean that of the vocabulary, and counts keep them apart.
TEST_F(StateCommand, TakesTheClassOfTheVocabularyBeforeANamesake) {
  const fs::path own = path("town.ttl");
  writeFile(own,
            "@prefix clx: <https://w3id.org/cluxel/ontology#> . @prefix my: <http://t.example/o#> .\n"
            "@prefix owl: <http://www.w3.org/2002/07/owl#> . @prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .\n"
            "my:Tree a owl:Class ; rdfs:subClassOf clx:Plant . my:Car a owl:Class ; rdfs:subClassOf clx:Vehicle .\n"
            "<http://t.example/p/Car> a owl:Class ; rdfs:subClassOf clx:Vehicle .\n");
  const Outcome applied = run("rules apply " + map().string() + " --ontology core.ttl outdoor.ttl " + own.string());
  ASSERT_EQ(applied.code, 0) << applied.err;
  const auto trees = [] {
    const nlohmann::json by_class =
        nlohmann::json::parse(run("info " + map().string() + " --json").out)["objects_by_class"];
    return std::pair(by_class.value("Tree", 0), by_class.value("http://t.example/o#Tree", 0));
  };
  const auto before = trees();
  const std::string tree = "--object " + one("Tree");
  EXPECT_THAT(state(tree + " --is-not Tree").out, HasSubstr("is not clx:Tree"));
  const Outcome town = state("--object " + one("Tree") + " --is my:Tree");
  EXPECT_EQ(town.code, 0) << town.err;
  EXPECT_THAT(town.out, HasSubstr("1 changed: 1 http://t.example/o#Tree"));
  EXPECT_EQ(trees(), std::pair(before.first - 2, 1));
  expectError(state("--object " + one("Tree") + " --is Car"), 3, "'Car' names 2 classes of the map's ontology");
}

TEST_F(StateCommand, TellsWhichObjectAStatementIsAbout) {
  const std::string tree = one("Tree"), other = path("other.clx").string(), merged = path("merged.clx").string();
  fs::copy_file(map(), other, fs::copy_options::overwrite_existing);
  ASSERT_EQ(state("--object " + tree + " --is clx:StreetLamp").code, 0);
  ASSERT_EQ(run("state " + other + " --object " + tree + " --is clx:StreetSign").code, 0);
  const Outcome report = run("merge " + map().string() + " " + other + " -o " + merged + " --json");
  ASSERT_EQ(report.code, 0) << report.err;
  const std::string list = run("state " + merged + " --list").out;
  EXPECT_THAT(list, HasSubstr("  applied to object/"));
  EXPECT_THAT(list, HasSubstr("  overruled, about object/"));
  for (const auto& statement : nlohmann::json::parse(report.out).at("statements"))
    EXPECT_THAT(statement.at("object").get<std::string>(), HasSubstr("https://w3id.org/cluxel/map/object/"));
}

TEST_F(StateCommand, AFaultyFileOfStatementsIsNamedWithItsFault) {
  ASSERT_EQ(state("--object " + one("Tree") + " --is clx:StreetLamp").code, 0);
  const fs::path file = path("edited.nq");
  ASSERT_EQ(state("--export " + file.string()).code, 0);
  std::string text = readFile(file);
  text.replace(text.find("ontology#StreetLamp"), 19, "ontology#StreetSign");
  writeFile(file, text);
  const Outcome refused =
      run("build " + path("campus").string() + " -o " + path("edited.clx").string() + " --statements " + file.string());
  expectError(refused, 4, file.string());
  EXPECT_THAT(refused.err, HasSubstr("was edited"));
  EXPECT_FALSE(fs::exists(path("edited.clx")));
}

TEST_F(StateCommand, ABuildTakesNoQuadsOfOtherGraphsAsStatements) {
  ASSERT_EQ(state("--object " + one("Tree") + " --is clx:StreetLamp").code, 0);
  const fs::path all = path("all.nq");
  ASSERT_EQ(run("export " + map().string() + " -o " + all.string()).code, 0);
  expectError(
      run("build " + path("campus").string() + " -o " + path("taken.clx").string() + " --statements " + all.string()),
      4, "but --statements takes those of graph");
  EXPECT_FALSE(fs::exists(path("taken.clx")));
}

TEST_F(StateCommand, AnUpdateMakesTheGroundNothingElse) {
  const std::string insert = " { <https://w3id.org/cluxel/map/object/" + one("Ground") + "> ";
  expectError(run("update " + map().string() + " -e 'INSERT DATA" + insert + "a clx:Building }'"), 4,
              "is one object over all of the map");
  EXPECT_EQ(run("update " + map().string() + " -e 'INSERT DATA" + insert + "rdfs:label \"yard\" }'").code, 0);
}

TEST_F(StateCommand, RefusesWhatCannotBeMeant) {
  const std::string tree = "--object " + one("Tree");
  expectError(state(tree + " --is clx:TreeTrunk"), 2, "is no class of objects");
  expectError(state(tree + " --is clx:Object"), 2, "tells them apart");
  expectError(state(tree + " --is clx:Unicorn"), 3, "has no class");
  expectError(state(tree + " --label \"\""), 2, "the text is empty");
  expectError(state(tree + " --note \"\xff\""), 2, "the text is not UTF-8");
  expectError(state("--ignore-region 0,0,1,1,2,2"), 2, "has no area");
  expectError(state("--ignore-region nan,0,1,1"), 2, "--ignore-region: write a number that is finite, not nan");
  EXPECT_EQ(listed(), 0u);
}

TEST_F(StateCommand, OfARemovedObjectItIsToldWhyItIsGone) {
  const std::string tree = one("Tree");
  const std::string found = query("stated.clx",
                                  "SELECT ?p { <https://w3id.org/cluxel/map/object/" + tree +
                                      "> clx:hasPart?/clx:hasPrimitive ?p } ORDER BY ?p LIMIT 1",
                                  "--format csv")
                                .out;
  const std::string primitive = found.substr(found.rfind("primitive/"), 42);
  ASSERT_EQ(state("--object " + tree + " --is-not Tree").code, 0);
  expectError(run("explain " + map().string() + " " + tree.substr(0, 8)), 3, "was removed by an operator statement");
  EXPECT_NE(run("explain " + map().string() + " " + primitive).out.find("an operator statement removed the object"),
            std::string::npos);
}

TEST_F(StateCommand, RefusesToTakeAllGroundAway) {
  const std::string ground = "--object " + one("Ground");
  for (const char* statement : {" --remove", " --is-not clx:Ground", " --is clx:Building"})
    expectError(state(ground + statement), 2, "is all clx:Ground of the map");
  EXPECT_EQ(state(ground + " --label yard").code, 0);
  expectError(state("--object " + one("Tree") + " --is clx:Ground"), 2, "is one object over all of the map");
}

TEST_F(StateCommand, DoesNotMakeAndWithdrawTheSameStatement) {
  const std::string tree = one("Tree");
  ASSERT_EQ(state("--object " + tree + " --is clx:StreetLamp").code, 0);
  const std::string id = nlohmann::json::parse(state("--list --json").out).at("statements")[0].at("id");
  expectError(state("--object " + one("StreetLamp") + " --is clx:StreetLamp --withdraw " + id), 2, "do one of them");
  EXPECT_EQ(listed(), 1u);
}

}  // namespace
}  // namespace cluxel::app
