// SPDX-License-Identifier: Apache-2.0
// Labels of classes: which are kept, which is shown, how words are compared with them, and which classes share one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "rdf/ontology/class_labels.hpp"
#include "rdf/ontology/ontology.hpp"
#include "rdf/vocabulary.hpp"
#include "test_paths.hpp"

namespace cluxel::rdf {
namespace {

using testing::HasSubstr;
using vocabulary::clx;

std::vector<RdfSource> shippedOntology() {
  const std::filesystem::path folder = test::sourceFolder() / "ontology";
  return {readRdfSource(folder / "core.ttl"), readRdfSource(folder / "outdoor.ttl")};
}

/// The shipped ontology and one that gives labels to StreetSign, and the same to two classes of its own.
OntologyView withMoreLabels() {
  std::vector<RdfSource> sources = shippedOntology();
  sources.push_back(
      {"@prefix clx: <https://w3id.org/cluxel/ontology#> . @prefix owl: <http://www.w3.org/2002/07/owl#> .\n"
       "@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> . @prefix my: <http://x/> .\n"
       "@prefix skos: <http://www.w3.org/2004/02/skos/core#> .\n"
       "clx:StreetSign skos:prefLabel \"Zeichen\"@de ; rdfs:label \"Amtliches Schild\"@de, \"Schildchen\" ;\n"
       "  skos:altLabel \"Blech\"@de, \"panneau\"@fr ; rdfs:label <http://x/label> .\n"
       "my:A a owl:Class ; rdfs:subClassOf clx:Object ; skos:altLabel \"Doppelt\"@en .\n"
       "my:B a owl:Class ; rdfs:subClassOf clx:Object ; rdfs:label \"Doppelt\"@de .\n",
       "labels.ttl", RdfFormat::Turtle, "http://x/", Term::iri("")});
  return ontologyViewOf(sources);
}

TEST(ClassLabels, KeepsAllLabelsOfAClassAndShowsOneByAFixedRule) {
  const OntologyView view = withMoreLabels();
  const OntologyClass& sign = *view.find(clx("StreetSign"));
  for (const char* words :
       {"Straßenschild", "Zeichen", "Amtliches Schild", "Schildchen", "Blech", "panneau", "street sign"})
    EXPECT_TRUE(std::any_of(sign.labels.begin(), sign.labels.end(), [&](const ClassLabel& label) {
      return isCalled(label, words);
    })) << words;
  EXPECT_EQ(sign.label("de"), "Straßenschild") << "preferred; S comes before Z";
  EXPECT_EQ(sign.label("fr"), "street sign") << "an alternative label is not shown";
  EXPECT_EQ(sign.label("en"), "street sign");
  EXPECT_EQ(view.find("http://x/A")->label(), "A");
}

TEST(ClassLabels, WarnsOfLabelsThatClassesShare) {
  EXPECT_TRUE(sharedLabels(ontologyViewOf(shippedOntology())).empty());
  const auto warnings = sharedLabels(withMoreLabels());
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_EQ(warnings.front().severity, Severity::Warning);
  EXPECT_THAT(warnings.front().message,
              HasSubstr("the label 'Doppelt' is that of 2 classes, <http://x/A>, <http://x/B>"));
}

TEST(ClassLabels, AreComparedWithoutCaseAndInAnyFormOfUnicode) {
  const ClassLabel mirror{"fr", LabelKind::Preferred, "r\u00e9verb\u00e8re"};
  EXPECT_TRUE(isCalled(mirror, "re\u0301verbe\u0300re")) << "decomposed";
  EXPECT_TRUE(isCalled(mirror, "RE\u0301VERB\u00c8RE"));
  EXPECT_FALSE(isCalled(mirror, "reverbere"));
  const ClassLabel lamp{"tr", LabelKind::Preferred, "Sokak Lambas\u0131"};
  for (const char* words : {"Sokak Lambas\u0131", "SOKAK LAMBASI", "sokak-lambas\u0131"})
    EXPECT_TRUE(isCalled(lamp, words)) << words;
  EXPECT_FALSE(isCalled({"", LabelKind::Preferred, "Lambas\u0131"}, "LAMBASI")) << "of no language";
  EXPECT_TRUE(isCalled({"tr-TR", LabelKind::Plain, "\u0130stasyon"}, "istasyon"));
  EXPECT_TRUE(isCalled({"de", LabelKind::Plain, "Stra\u00dfe"}, "STRASSE"));
  EXPECT_FALSE(isCalled({"de", LabelKind::Plain, ""}, ""));
}

}  // namespace
}  // namespace cluxel::rdf
