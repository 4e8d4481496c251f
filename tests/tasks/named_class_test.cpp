// SPDX-License-Identifier: Apache-2.0
// Which class a name means, when several may be meant.
#include "tasks/named_class.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cluxel/error.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::tasks {
namespace {

using rdf::vocabulary::clx;
using testing::AllOf;
using testing::HasSubstr;

const std::string kTown = "http://t.example/town#", kStore = "http://t.example/store/";

rdf::OntologyView viewOf(const std::vector<std::pair<std::string, std::multimap<std::string, std::string>>>& classes) {
  rdf::OntologyView view;
  for (const auto& [iri, labels] : classes) {
    rdf::OntologyClass& known = view.classes.emplace_back();
    known.iri = iri;
    for (const auto& [language, text] : labels) known.labels.push_back({language, rdf::LabelKind::Alternative, text});
  }
  std::sort(view.classes.begin(), view.classes.end(), [](const auto& a, const auto& b) { return a.iri < b.iri; });
  return view;
}

/// A town and a store have classes whose local names occur elsewhere.
rdf::OntologyView twoVocabularies() {
  return viewOf({{clx("Tree"), {{"en", "tree"}, {"de", "Baum"}}},
                 {clx("StreetSign"), {{"en", "street sign"}, {"de", "Straßenschild"}}},
                 {clx("Bench"), {{"en", "bench"}, {"de", "Bank"}}},
                 {kTown + "Tree", {{"en", "town tree"}, {"de", "Baum"}}},
                 {kTown + "Kiosk", {}},
                 {kTown + "Branch", {{"de", "Bank"}}},
                 {kTown + "Car", {}},
                 {kStore + "Car", {}},
                 {kStore, {}}});
}

Namespaces prefixes() {
  return {{"town", kTown}, {"store", kStore}, {"both", kTown}, {"both", kStore}};
}

std::string named(const std::string& written) {
  return classNamed(twoVocabularies(), written, prefixes);
}

std::string faultOf(const std::string& written) {
  try {
    return "it is " + named(written);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::NotFound);
    return error.what();
  }
}

TEST(NamedClass, IsALocalNameAnIriOrALabel) {
  const std::string sign = clx("StreetSign");
  for (const std::string& written :
       {std::string("StreetSign"), std::string("clx:StreetSign"), "<" + sign + ">", sign, std::string("Street sign"),
        std::string("street-sign "), std::string("Straßenschild")})
    EXPECT_EQ(named(written), sign) << written;
  EXPECT_THAT(faultOf("Schild"), HasSubstr("no class 'Schild'"));
  EXPECT_THAT(faultOf(""), HasSubstr("no class ''"));
  EXPECT_THAT(faultOf("Treee"), HasSubstr("did you mean 'Tree'"));
}

TEST(NamedClass, OfAMobilityIsNoneWhereAClassHasTheWordAsALabel) {
  const rdf::OntologyView without = twoVocabularies();
  const rdf::OntologyView with = viewOf({{kTown + "Fixed", {{"en", "static"}}}});
  for (const std::string& written : {std::string("static"), std::string("STATIC"), std::string("Static")}) {
    EXPECT_EQ(mobilityNamed(without, written), rdf::Mobility::Static) << written;
    EXPECT_EQ(mobilityNamed(with, written), std::nullopt) << written;
    EXPECT_EQ(classNamed(with, written), kTown + "Fixed") << written;
  }
  for (const std::string& written : {std::string("clx:Static"), clx("Static"), "<" + clx("Static") + ">"})
    EXPECT_EQ(mobilityNamed(with, written), rdf::Mobility::Static) << written;
  EXPECT_EQ(mobilityNamed(with, "movable"), rdf::Mobility::Movable);
  EXPECT_EQ(mobilityNamed(with, "mobile"), std::nullopt);
}

TEST(NamedClass, IsALabelWhateverTheCaseOfItsLetters) {
  const rdf::OntologyView view = viewOf(
      {{clx("Building"), {{"de", "Gebäude"}}}, {clx("StreetSign"), {{"de", "Straßenschild"}}}, {kTown + "Ёлка", {}}});
  for (const char* written : {"Gebäude", "gebäude", "GEBÄUDE"}) EXPECT_EQ(classNamed(view, written), clx("Building"));
  EXPECT_EQ(classNamed(view, "STRASSENSCHILD"), clx("StreetSign"));
  EXPECT_EQ(classNamed(view, "ёлКА"), kTown + "Ёлка");
}

TEST(NamedClass, IsAnyOfItsLabelsInAnyFormOfUnicode) {
  const rdf::OntologyView view = viewOf(
      {{clx("StreetLamp"), {{"fr", "r\u00e9verb\u00e8re"}, {"fr", "lampadaire"}, {"tr", "Sokak Lambas\u0131"}}}});
  for (const char* written : {"re\u0301verbe\u0300re", "lampadaire", "SOKAK LAMBASI", "Sokak Lambas\u0131"})
    EXPECT_EQ(classNamed(view, written), clx("StreetLamp")) << written;
}

TEST(NamedClass, OfTheVocabularyHasTheFirstRightToALocalName) {
  EXPECT_EQ(named("Tree"), clx("Tree"));
  EXPECT_EQ(named(kTown + "Tree"), kTown + "Tree");
  EXPECT_EQ(named("town tree"), kTown + "Tree");
  EXPECT_EQ(named("Kiosk"), kTown + "Kiosk") << "the only class that is called so";
}

TEST(NamedClass, IsTheOneWithTheLabelThenTheOneOfTheVocabulary) {
  EXPECT_EQ(named("tree"), clx("Tree")) << "its label; the town's Tree is called so in another case only";
  EXPECT_EQ(named("TREE"), clx("Tree"));
  EXPECT_EQ(named("kiosk"), kTown + "Kiosk");
  const rdf::OntologyView without_labels = viewOf({{clx("Pole"), {}}, {kTown + "Pole", {}}, {kStore + "pole", {}}});
  EXPECT_EQ(classNamed(without_labels, "POLE"), clx("Pole"));
  const rdf::OntologyView two_cases = viewOf({{kStore + "A", {{"en", "pole"}}}, {kTown + "B", {{"en", "Pole"}}}});
  EXPECT_EQ(classNamed(two_cases, "pole"), kStore + "A");
  EXPECT_EQ(classNamed(two_cases, "Pole"), kTown + "B");
  EXPECT_THROW(classNamed(two_cases, "POLE"), Error);
}

TEST(NamedClass, OfALocalNameAsItIsWrittenIsMeantBeforeALabel) {
  const rdf::OntologyView view = viewOf({{clx("Tree"), {{"en", "tree"}}}, {kTown + "tree", {}}});
  EXPECT_EQ(classNamed(view, "tree"), kTown + "tree") << "as lists and counts call it";
  EXPECT_EQ(classNamed(view, "Tree"), clx("Tree"));
}

TEST(NamedClass, IsRefusedWithItsIrisWhenSeveralAreMeant) {
  EXPECT_THAT(faultOf("Car"), AllOf(HasSubstr("'Car' names 2 classes"), HasSubstr("<" + kTown + "Car>"),
                                    HasSubstr("<" + kStore + "Car>")));
  EXPECT_THAT(faultOf("Bank"), AllOf(HasSubstr("'Bank' names 2 classes"), HasSubstr("<" + clx("Bench") + ">"),
                                     HasSubstr("<" + kTown + "Branch>")));
  EXPECT_THAT(faultOf("both:Car"), HasSubstr("names 2 classes"));
}

TEST(NamedClass, TakesThePrefixesOfTheMap) {
  EXPECT_EQ(named("town:Tree"), kTown + "Tree");
  EXPECT_EQ(named("both:Kiosk"), kTown + "Kiosk");
  EXPECT_EQ(named("clx:Tree"), clx("Tree"));
  EXPECT_THAT(faultOf("clx:Kiosk"), HasSubstr("no class 'clx:Kiosk'"));
  EXPECT_THAT(faultOf("village:Tree"), HasSubstr("no class 'village:Tree'"));
  EXPECT_THROW(classNamed(twoVocabularies(), "town:Tree"), Error) << "without prefixes";
}

}  // namespace
}  // namespace cluxel::tasks
