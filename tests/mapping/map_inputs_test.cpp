// SPDX-License-Identifier: Apache-2.0
// What people are told of the files that a map was built from.
#include "mapping/map_inputs.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "base/file_bytes.hpp"
#include "mapping/inference/infer_facts.hpp"
#include "mapping/inference/sparql_rules.hpp"
#include "mapping/small_campus.hpp"
#include "test_paths.hpp"

namespace cluxel::mapping {
namespace {

TEST(DescribedInputs, AreShortWithinTheDataHomeAndWholeElsewhere) {
  MapInputs inputs;
  inputs.ontology = {{"/home/ontology/core.ttl", ""}};
  inputs.rules = {{"/elsewhere/my.rules.yaml", ""}, {"/home/rules/outdoor.rules.yaml", ""}};
  inputs.model.name = "/home/models/oakland/model.json";
  EXPECT_EQ(describeFiles(inputs),
            "data home unknown; ontology /home/ontology/core.ttl; rules /elsewhere/my.rules.yaml, "
            "/home/rules/outdoor.rules.yaml; SPARQL rules none; model /home/models/oakland/model.json");
  inputs.home = "/home";
  EXPECT_EQ(describeFiles(inputs),
            "data home /home; ontology ontology/core.ttl; rules /elsewhere/my.rules.yaml, rules/outdoor.rules.yaml; "
            "SPARQL rules none; model models/oakland/model.json");
}

TEST(MapInputs, HaveSparqlRulesInTheOrderOfTheirFileNames) {
  const ScratchFolder folder;
  const auto write = [&](const std::string& name, const std::string& text) {
    std::filesystem::create_directories((folder.path() / name).parent_path());
    writeFile(folder.path() / name, text);
    return folder.path() / name;
  };
  std::vector<std::filesystem::path> files{write("b/10_first.rq", "ten"), write("a/20_second.rq", "twenty"),
                                           write("a/30_same.rq", "y"), write("b/30_same.rq", "x")};
  const DataHome home(test::sourceFolder());
  ContentHash hash;
  for (int order = 0; order < 4; ++order) {
    MapInputFiles given;
    given.sparql_rules = files;
    const MapInputs inputs = readMapInputs(given, home);
    std::string texts;
    for (const NamedText& rule : inputs.sparql_rules) texts += rule.text + " ";
    EXPECT_EQ(texts, "ten twenty x y ");
    if (order == 0) hash = inputs.hash();
    EXPECT_EQ(inputs.hash(), hash);
    std::rotate(files.begin(), files.begin() + 1, files.end());
  }
}

TEST(MapInputs, RefuseAFaultyOntologyWhenItIsRead) {
  const ScratchFolder folder;
  const std::filesystem::path shipped = test::sourceFolder() / "ontology", more = folder.path() / "bench.ttl";
  writeFile(more,
            "@prefix clx: <https://w3id.org/cluxel/ontology#> .\n"
            "clx:Bench a <http://www.w3.org/2002/07/owl#Class> ;\n"
            "  <http://www.w3.org/2000/01/rdf-schema#subClassOf> clx:StreetFurnitur .\n");
  MapInputFiles files;
  files.ontology = {shipped / "core.ttl", shipped / "outdoor.ttl", more};
  try {
    readMapInputs(files, DataHome(test::sourceFolder()));
    FAIL() << "the superclass is misspelt";
  } catch (const InputError& fault) {
    EXPECT_EQ(fault.diagnostics().front().location.line, 3U) << fault.what();
  }
}

class Notes : public ProgressSink {
 public:
  void note(std::string_view text) override { texts.emplace_back(text); }
  std::vector<std::string> texts;
};

TEST(MapInputs, WithAxiomsFromWhichNothingIsInferredAreNoted) {
  Notes notes;
  std::vector<NamedText> ontology = shippedInputs().ontology;
  noteUnusedAxioms(ontology, notes);
  EXPECT_TRUE(notes.texts.empty()) << notes.texts.front();
  ontology.push_back(
      {"own.ttl",
       "@prefix owl: <http://www.w3.org/2002/07/owl#> . @prefix my: <http://x/> .\n"
       "@prefix clx: <https://w3id.org/cluxel/ontology#> .\n"
       "my:Baum a owl:Class ; owl:equivalentClass clx:Tree ; owl:sameAs clx:Vehicle ; owl:disjointWith clx:Vehicle .\n"
       "my:Auto a owl:Class ; owl:equivalentClass clx:Vehicle ; owl:deprecated true .\n"
       "my:owner a owl:FunctionalProperty , owl:TransitiveProperty .\n"
       "[] a owl:AllDisjointClasses ; owl:members ( my:Baum my:Auto ) .\n"});
  noteUnusedAxioms(ontology, notes);
  ASSERT_EQ(notes.texts.size(), 4U);
  EXPECT_NE(notes.texts[0].find("from owl:FunctionalProperty (1 statement of the ontology)"), std::string::npos);
  EXPECT_NE(notes.texts[2].find("from owl:members (1 statement of the ontology); write owl:disjointWith"),
            std::string::npos)
      << notes.texts[2];
  EXPECT_NE(notes.texts[3].find("from owl:sameAs (1 statement"), std::string::npos);
  EXPECT_EQ(notes.texts[1],
            "warning: nothing is inferred from owl:equivalentClass (2 statements of the ontology); write "
            "rdfs:subClassOf for each class that is below another");
}

TEST(MapInputs, WithLabelsOfSeveralClassesAreNoted) {
  Notes notes;
  std::vector<NamedText> ontology = shippedInputs().ontology;
  noteSharedLabels(ontologyOf(ontology), notes);
  EXPECT_TRUE(notes.texts.empty()) << notes.texts.front();
  ontology.push_back(
      {"own.ttl",
       "@prefix owl: <http://www.w3.org/2002/07/owl#> . @prefix my: <http://x/> .\n"
       "@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .\n"
       "my:A a owl:Class ; rdfs:label \"Doppelt\"@en . my:B a owl:Class ; rdfs:label \"Doppelt\"@de .\n"});
  noteSharedLabels(ontologyOf(ontology), notes);
  ASSERT_EQ(notes.texts.size(), 1U);
  EXPECT_NE(notes.texts[0].find("warning: the label 'Doppelt' is that of 2 classes, <http://x/A>, <http://x/B>"),
            std::string::npos);
}

TEST(MapInputs, WithNamesThatTheOntologyLacksAreNoted) {
  Notes notes;
  MapInputs inputs = shippedInputs();
  noteUnknownNames(inputs.sparql_rules, ontologyOf(inputs.ontology), notes);
  EXPECT_TRUE(notes.texts.empty()) << notes.texts.front();
  inputs.sparql_rules = {{"my.rq",
                          "PREFIX clx: <https://w3id.org/cluxel/ontology#>\n"
                          "CONSTRUCT { ?t a clx:Treee } WHERE { ?t a clx:Tree }"}};
  noteUnknownNames(inputs.sparql_rules, ontologyOf(inputs.ontology), notes);
  ASSERT_EQ(notes.texts.size(), 1U);
  EXPECT_NE(notes.texts.front().find("my.rq:2:"), std::string::npos) << notes.texts.front();
  EXPECT_NE(notes.texts.front().find("knows no class clx:Treee; did you mean 'Tree'"), std::string::npos);
}

}  // namespace
}  // namespace cluxel::mapping
