// SPDX-License-Identifier: Apache-2.0
// Faults of ontology files that would otherwise change answers without a word.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rdf/ontology/ontology.hpp"
#include "test_paths.hpp"

namespace cluxel::rdf {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::vector<RdfSource> withAddition(const std::string& addition) {
  const std::filesystem::path folder = test::sourceFolder() / "ontology";
  return {readRdfSource(folder / "core.ttl"),
          readRdfSource(folder / "outdoor.ttl"),
          {"@prefix clx: <https://w3id.org/cluxel/ontology#> . @prefix owl: <http://www.w3.org/2002/07/owl#> .\n"
           "@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> . @prefix my: <http://x/my#> .\n" +
               addition,
           "more.ttl", RdfFormat::Turtle, "http://x/", Term::iri("")}};
}

/// The faults of the shipped ontology with more statements, from line 3 on; "" without any.
std::string foundFaults(const std::string& addition) {
  try {
    checkOntology(withAddition(addition));
  } catch (const InputError& error) {
    return format(error.diagnostics());
  }
  return "";
}

TEST(OntologyCheck, FindsNoFaultInTheShippedOntology) {
  EXPECT_EQ(foundFaults(""), "");
}

TEST(OntologyCheck, SaysThatAnOntologyIsTurtle) {
  const auto faultsOfText = [](const std::string& text) {
    const std::vector<RdfSource> sources{{text, "own.rdf", RdfFormat::Turtle, "http://x/", Term::iri("")}};
    try {
      checkOntology(sources);
    } catch (const InputError& error) {
      return format(error.diagnostics());
    }
    return std::string();
  };
  for (const char* text : {"<?xml version=\"1.0\"?>\n<rdf:RDF/>", "\xEF\xBB\xBF\n <rdf:RDF/>", "<!-- a --><rdf:RDF/>",
                           "<!DOCTYPE rdf:RDF>"})
    EXPECT_THAT(faultsOfText(text), HasSubstr("own.rdf:1:1: error: this is XML, but an ontology is read as Turtle"));
  EXPECT_THAT(faultsOfText("{\"@id\":\"http://x/A\"}"), HasSubstr("this is JSON or TriG, but"));
  for (const char* text : {"<http://x/A> a <http://x/B> .", "[] a <http://x/B> ."}) EXPECT_EQ(faultsOfText(text), "");
}

/// my:C0 below clx:Tree, and each further class below the one before.
std::string chainOf(int classes) {
  std::string text = "my:C0 a owl:Class ; rdfs:subClassOf clx:Tree .\n";
  for (int i = 1; i < classes; ++i)
    text += "my:C" + std::to_string(i) + " a owl:Class ; rdfs:subClassOf my:C" + std::to_string(i - 1) + " .\n";
  return text;
}

TEST(OntologyCheck, RefusesALongChainOfSuperclassesAndTellsItsLength) {
  EXPECT_EQ(foundFaults(chainOf(490)), "");
  EXPECT_THAT(foundFaults(chainOf(5000)), AllOf(HasSubstr("more.ttl:5002:"), HasSubstr("C4999: it has a chain of 500"),
                                                HasSubstr("superclasses above each other"),
                                                HasSubstr("write at most 500"), Not(HasSubstr("cycle"))));
}

TEST(OntologyCheck, StillFindsACycleBelowALongChain) {
  EXPECT_THAT(foundFaults(chainOf(3) +
                          "my:X a owl:Class ; rdfs:subClassOf my:C2 , my:Y .\n"
                          "my:Y a owl:Class ; rdfs:subClassOf my:X .\nmy:Z a owl:Class ; rdfs:subClassOf my:X .\n"),
              AllOf(HasSubstr("X is below Y and above it"), HasSubstr("Y is below X and above it"),
                    Not(HasSubstr("Z: the class is its own"))));
}

TEST(OntologyCheck, RefusesASuperclassThatIsDefinedNowhere) {
  EXPECT_THAT(foundFaults("clx:Bench a owl:Class ;\n  rdfs:subClassOf clx:StreetFurnitur .\n"),
              AllOf(HasSubstr("more.ttl:4:23: error: Bench: there is no class StreetFurnitur"),
                    HasSubstr("did you mean 'StreetFurniture'?")));
  EXPECT_THAT(foundFaults("my:Seat a owl:Class ; rdfs:subClassOf clx:Object . my:Bench a owl:Class ; "
                          "rdfs:subClassOf my:Saet ."),
              AllOf(HasSubstr("there is no class Saet"), HasSubstr("did you mean 'Seat'?")));
  EXPECT_THAT(foundFaults("clx:Bench a owl:Class ; rdfs:subClassOf \"Object\" ."),
              HasSubstr("subClassOf has a text or number where a class is wanted"));
  EXPECT_THAT(foundFaults("clx:Bench a owl:Class ; rdfs:subClassOf clx:Seat . clx:Seat rdfs:subClassOf clx:Object ."),
              HasSubstr("Seat is not declared as a class"));
}

TEST(OntologyCheck, TakesSuperclassesOfOtherVocabularies) {
  EXPECT_EQ(foundFaults("clx:Bench a owl:Class ; rdfs:subClassOf clx:StreetFurniture, <https://schema.org/Product>,\n"
                        "  <http://www.w3.org/ns/sosa/Platform>, [ a owl:Restriction ] .\n"
                        "<http://www.w3.org/ns/sosa/Platform> a owl:Class ; rdfs:subClassOf "
                        "<http://www.w3.org/ns/sosa/Thing> ."),
            "");
}

TEST(OntologyCheck, TakesSuperclassesBesideADeclaredClassOfAnotherVocabulary) {
  EXPECT_EQ(foundFaults("<http://dbpedia.org/ontology/Tree> a owl:Class .\n"
                        "clx:Lime a owl:Class ; rdfs:subClassOf clx:Tree, <http://dbpedia.org/ontology/Plant> ."),
            "");
  EXPECT_EQ(foundFaults("<urn:a:Seat> a owl:Class ; rdfs:subClassOf clx:Object, <urn:b:Plant> ."), "");
  EXPECT_THAT(foundFaults("<urn:a:Seat> a owl:Class ; rdfs:subClassOf clx:Object, <urn:a:Chair> ."),
              HasSubstr("there is no class urn:a:Chair"));
}

TEST(OntologyCheck, ShowsWholeNamesThatDifferInTheNamespaceAlone) {
  EXPECT_THAT(foundFaults("my:Seat a owl:Class ; rdfs:subClassOf my:Plant, clx:Object ."),
              AllOf(HasSubstr("Seat: there is no class <http://x/my#Plant>"),
                    HasSubstr("did you mean <https://w3id.org/cluxel/ontology#Plant>?")));
  EXPECT_THAT(foundFaults("my:Seat a owl:Class ; rdfs:subClassOf my:Plnt, clx:Object ."),
              AllOf(HasSubstr("Seat: there is no class Plnt"), Not(HasSubstr("did you mean"))));
}

TEST(OntologyCheck, RefusesPropertiesThatTheVocabularyLacks) {
  EXPECT_THAT(foundFaults("clx:P a clx:UsualPlace ; clx:usualFor clx:Bush ; clx:nearClas clx:Tree ; clx:within 1.0 ;\n"
                          "  clx:nearClass clx:Tree ; clx:probabilty 0.001 ; my:note \"mine\" ."),
              AllOf(HasSubstr("more.ttl:3:54: error: P: there is no property nearClas"),
                    HasSubstr("did you mean 'nearClass'?"), HasSubstr("did you mean 'probability'?"),
                    HasSubstr("P: the usual place has no clx:probability"), Not(HasSubstr("no property note"))));
}

TEST(OntologyCheck, RefusesUsualPlacesThatTellTooLittle) {
  const std::string place = "clx:P a clx:UsualPlace ; clx:usualFor clx:Ground ; clx:nearClass clx:Tree ; ";
  EXPECT_EQ(foundFaults(place + "clx:within 15.0 ; clx:probability 0.4 ."), "");
  EXPECT_THAT(foundFaults(place + "clx:probability 0.4 ; clx:within -15.0 ."),
              AllOf(HasSubstr("more.ttl:3:"), HasSubstr("P: clx:within is '-15.0'"), HasSubstr("above 0 [m]")));
  EXPECT_THAT(foundFaults(place + "clx:within \"near\" ; clx:probability 0.4 ."), HasSubstr("clx:within is 'near'"));
  EXPECT_THAT(foundFaults(place + "clx:within 15.0 ."), HasSubstr("P: the usual place has no clx:probability"));
  EXPECT_THAT(foundFaults(place + "clx:probability 0.4 ."), HasSubstr("P: the usual place has no clx:within"));
  EXPECT_THAT(foundFaults("clx:P a clx:UsualPlace ; clx:within 1.0 ; clx:probability 0.4 ."),
              AllOf(HasSubstr("has no clx:usualFor"), HasSubstr("has no clx:nearClass")));
  EXPECT_THAT(
      foundFaults("clx:P clx:usualFor clx:Ground ; clx:nearClass [ a owl:Class ] ; clx:within 1.0 ; "
                  "clx:probability 0.4 ."),
      AllOf(HasSubstr("P: nearClass has something unnamed where a class is wanted"), Not(HasSubstr("did you mean"))));
}

TEST(OntologyCheck, RefusesTwoValuesWhereOneIsMeant) {
  const std::string place = "clx:P clx:usualFor clx:Ground ; clx:nearClass clx:Tree ; ";
  EXPECT_THAT(foundFaults(place + "clx:within 15.0 ; clx:probability 0.4, 0.5 ."),
              HasSubstr("P: it has more than one clx:probability"));
  EXPECT_THAT(foundFaults(place + "clx:within 15.0, 16.0 ; clx:probability 0.4 ."),
              HasSubstr("P: it has more than one clx:within"));
  EXPECT_THAT(foundFaults("clx:Tree clx:mobility clx:Movable ."), HasSubstr("Tree: it has more than one clx:mobility"));
  EXPECT_THAT(foundFaults("clx:Tree clx:color \"#123456\" ."), HasSubstr("Tree: it has more than one clx:color"));
  EXPECT_EQ(foundFaults("clx:Tree clx:mobility clx:Static ."), "") << "said again";
}

TEST(OntologyCheck, RefusesPlacesOfAClassThatAreTooProbableTogether) {
  const std::string one =
      "clx:P clx:usualFor clx:Ground ; clx:nearClass clx:Tree ; clx:within 5.0 ;"
      " clx:probability 0.7 .\n";
  const std::string other =
      "clx:Q clx:usualFor clx:Ground ; clx:nearClass clx:Bush ; clx:within 5.0 ;"
      " clx:probability ";
  EXPECT_EQ(foundFaults(one + other + "0.3 ."), "");
  EXPECT_THAT(
      foundFaults(one + other + "0.5 ."),
      AllOf(HasSubstr("more.ttl:4:"), HasSubstr("Q: the probabilities of the usual places of Ground sum to 1.2"),
            HasSubstr("they sum to at most 1")));
}

TEST(OntologyCheck, LeavesTheOntologiesOfEarlierMapsReadable) {
  const OntologyView view =
      ontologyViewOf(withAddition("clx:Bench a owl:Class ; rdfs:subClassOf clx:Objekt .\n"
                                  "clx:P clx:usualFor clx:Bench ; clx:nearClass clx:Tree ."));
  EXPECT_NE(view.find("https://w3id.org/cluxel/ontology#Bench"), nullptr);
}

}  // namespace
}  // namespace cluxel::rdf
