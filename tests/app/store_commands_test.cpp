// SPDX-License-Identifier: Apache-2.0
// Tests of stores that no build has made: load, dump, info, export, doctor, compact, update; and of prefixes and
// budgets.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "app/program_fixture.hpp"

namespace cluxel::app {
namespace {

using testing::HasSubstr;

class StoreCommands : public Program {
 protected:
  static void SetUpTestSuite() {
    Program::SetUpTestSuite();
    writeFile(path("two.nq"),
              "<http://x/a> <http://x/p> \"1\" <http://x/g> .\n<http://x/b> <http://x/p> _:n <http://x/h> .\n");
    writeFile(path("named.trig"), "@prefix e: <http://x/> .\ne:g { e:c e:p 3 } e:d e:p 4 .\n");
  }
  static std::string in(const std::string& name) { return path(name).string(); }
};

TEST_F(StoreCommands, LoadKeepsNamedGraphsAndDumpGivesThemBack) {
  const Outcome loaded = run("load " + in("s.clx") + " " + in("two.nq") + " " + in("named.trig") + " " +
                             in("three.ttl") + " --graph http://x/t --json");
  ASSERT_EQ(loaded.code, 0) << loaded.err;
  EXPECT_EQ(loaded.out, "{\n  \"statements\": 7,\n  \"added\": 7\n}\n");
  const Outcome graphs =
      query("s.clx", "SELECT ?g (COUNT(*) AS ?n) { GRAPH ?g { ?s ?p ?o } } GROUP BY ?g ORDER BY ?g", "--format csv");
  EXPECT_EQ(graphs.out, "g,n\r\nhttp://x/g,2\r\nhttp://x/h,1\r\nhttp://x/t,4\r\n") << graphs.err;
  const Outcome dumped = run("dump " + in("s.clx"));
  EXPECT_THAT(dumped.out, HasSubstr("<http://x/a> <http://x/p> \"1\" <http://x/g> .\n"));
  const Outcome one = run("dump " + in("s.clx") + " --graph http://x/g");
  EXPECT_THAT(one.out, HasSubstr("<http://x/a> <http://x/p> \"1\" .\n"));
  EXPECT_EQ(std::count(one.out.begin(), one.out.end(), '\n'), 2);
  ASSERT_EQ(run("load " + in("unnamed.clx") + " " + in("three.ttl")).code, 0);
  const Outcome unnamed = run("dump " + in("unnamed.clx") + " --graph ''");
  EXPECT_EQ(unnamed.out, run("dump " + in("unnamed.clx")).out) << unnamed.err;
  EXPECT_THAT(unnamed.out, HasSubstr(" .\n"));
  expectError(run("dump " + in("s.clx") + " --graph ''"), 3, "no quads in the unnamed graph");
  expectError(run("dump " + in("s.clx") + " --graph http://x/none"), 3, "no quads in graph <http://x/none>");
  writeFile(path("again.nq"), dumped.out);
  ASSERT_EQ(run("load " + in("t.clx") + " " + in("again.nq")).code, 0);
  EXPECT_EQ(run("export --canonical " + in("t.clx")).out.size(), run("export --canonical " + in("s.clx")).out.size());
  EXPECT_THAT(run("load " + in("s.clx") + " " + in("two.nq") + " --graph http://x/t --json").out,
              HasSubstr("\"added\": 0"))
      << "a file's blank nodes have the same labels in the same place";
}

TEST_F(StoreCommands, WorkWithoutScans) {
  ASSERT_EQ(run("load " + in("w.clx") + " " + in("two.nq")).code, 0);
  const Outcome info = run("info " + in("w.clx"));
  EXPECT_EQ(info.code, 0) << info.err;
  EXPECT_THAT(info.out, HasSubstr("store without scans, 2 quads, 2 graphs"));
  EXPECT_THAT(info.out, HasSubstr("<http://x/h>"));
  EXPECT_THAT(run("info --json " + in("w.clx")).out, HasSubstr("\"http://x/g\": 1"));
  for (const char* format : {"turtle", "nquads", "canonical"}) {
    const Outcome exported = run("export " + in("w.clx") + " --format " + format);
    EXPECT_EQ(exported.code, 0) << exported.err;
    EXPECT_THAT(exported.out, HasSubstr("http://x/a"));
  }
  expectError(run("export " + in("w.clx") + " --format ply"), 5, "holds no map");
  EXPECT_EQ(run("doctor " + in("w.clx")).code, 0);
  EXPECT_EQ(run("compact " + in("w.clx")).code, 0);
  const std::string change =
      " -e 'INSERT DATA { <http://x/n> <http://x/p> 1 GRAPH <http://x/g> { <http://x/n> <http://x/p> 2 } }'";
  expectError(run("update " + in("w.clx") + change), 4, "may not be written");
  EXPECT_THAT(run("update " + in("w.clx") + " --strict" + change).out, HasSubstr("2 inserted"));
}

TEST_F(StoreCommands, OfAStoreThatNoBuildHasMadeEveryCommandOfMapsSaysThatItIsNoMap) {
  ASSERT_EQ(run("load " + in("s.clx") + " " + in("two.nq")).code, 0);
  const std::string store = in("s.clx"), campus = in("campus");
  for (const std::string& arguments : std::vector<std::string>{
           "extend " + store + " " + campus, "retract " + store + " 0000", "repose " + store + " " + campus,
           "merge " + store + " " + in("map.clx") + " -o " + in("m.clx"),
           "watch " + campus + " --interval 0.1 -o " + store, "rules apply " + store,
           "rules try " + store + " outdoor.rules.yaml", "state " + store + " --object 1234 --is Tree",
           "state " + store + " --list", "changes " + store, "explain " + store + " 1234",
           "evaluate " + store + " --truth campus", "route " + store + " 0,0 1,1"}) {
    SCOPED_TRACE(arguments);
    expectError(run(arguments), 5, "holds no map");
  }
}

TEST_F(StoreCommands, LoadLeavesNothingAfterAFault) {
  writeFile(path("faulty.nt"), "<http://x/a> <http://x/p> \"1\" .\n<http://x/a> <http://x/p> .\n");
  expectError(run("load " + in("none.clx") + " " + in("two.nq") + " " + in("faulty.nt")), 4, "faulty.nt:2");
  EXPECT_FALSE(fs::exists(path("none.clx")));
}

TEST_F(StoreCommands, LoadIntoAMapWritesOperatorStatementsOnly) {
  fs::copy_file(path("map.clx"), path("own.clx"));
  writeFile(path("seen.ttl"), "@prefix clx: <https://w3id.org/cluxel/ontology#> .\n<http://x/oak> a clx:Tree .\n");
  ASSERT_EQ(run("load " + in("own.clx") + " " + in("seen.ttl")).code, 0);
  EXPECT_EQ(
      query("own.clx", "ASK { GRAPH <https://w3id.org/cluxel/graph/inferred> { <http://x/oak> a clx:Plant } }").code,
      0);
  expectError(run("load " + in("own.clx") + " " + in("two.nq")), 4, "graph/operator> may be written");
  expectError(run("update " + in("own.clx") + " --strict -e 'CLEAR ALL'"), 2, "only the operator");
}

TEST_F(StoreCommands, KnowThePrefixesOfAMap) {
  for (const char* name :
       {"clx:x", "geo:x", "geof:x", "sosa:x", "prov:x", "rdf:x", "rdfs:x", "owl:x", "xsd:x", "skos:x"}) {
    const std::string text = std::string("ASK { ?s ?p ?o FILTER(?s != ") + name + ") }";
    EXPECT_EQ(query("three.ttl", text).code, 0) << name;
    expectError(query("three.ttl", text, "--no-prefixes"), 4, "is not declared");
  }
  EXPECT_THAT(query("three.ttl", "PREFIX clx: <https://e.org/> SELECT ?o { clx:b ?p ?o }", "--format csv").out,
              HasSubstr("2"));
  fs::copy_file(path("map.clx"), path("prefixes.clx"));
  const std::string note = " -e 'INSERT DATA { clx:me rdfs:label \"me\" }'";
  EXPECT_EQ(run("update " + in("prefixes.clx") + note).code, 0);
  expectError(run("update " + in("prefixes.clx") + " --no-prefixes" + note), 4, "is not declared");
}

TEST_F(StoreCommands, ExplainAsJson) {
  const Outcome explained = query("three.ttl", "SELECT ?o { ?s ?p ?o }", "--explain --json");
  const auto plan = nlohmann::json::parse(explained.err);
  EXPECT_TRUE(plan.contains("operator") && plan.contains("inputs"));
  EXPECT_EQ(plan["actual"], 3);
}

TEST_F(StoreCommands, HaveBudgetsForUpdates) {
  std::string many;
  for (int i = 0; i < 1000; ++i)
    many += "<http://x/" + std::to_string(i) + "> <http://x/p> \"" + std::to_string(i) + "\" .\n";
  writeFile(path("many.nt"), many);
  ASSERT_EQ(run("load " + in("b.clx") + " " + in("many.nt")).code, 0);
  const std::string cross = " -e 'INSERT { ?a <http://x/q> ?d } WHERE { ?a <http://x/p> ?b . ?c <http://x/p> ?d }'";
  expectError(run("update " + in("b.clx") + " --max-memory 20" + cross), 6, "budget of memory");
  expectError(run("update " + in("b.clx") + " --deadline 0.05" + cross), 6, "budget of time");
  EXPECT_THAT(run("info " + in("b.clx")).out, HasSubstr("1000 quads")) << "nothing was changed";
}

TEST_F(StoreCommands, CheckTheSyntaxOnly) {
  EXPECT_EQ(run("update " + in("none2.clx") + " --check -e 'CLEAR ALL'").code, 0);
  expectError(run("update " + in("none2.clx") + " --check -e 'CLEAR EVERYTHING'"), 4, "CLEAR EVERYTHING");
  EXPECT_EQ(run("query " + in("none2.clx") + " --check -e 'ASK { SERVICE <http://x/> { ?s ?p ?o } }'").code, 0);
}

}  // namespace
}  // namespace cluxel::app
