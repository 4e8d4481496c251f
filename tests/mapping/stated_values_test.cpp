// SPDX-License-Identifier: Apache-2.0
// What may be stated about objects, wherever a statement comes from.
#include "mapping/statements/stated_values.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "cluxel/error.hpp"
#include "mapping/small_campus.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::mapping {
namespace {

using rdf::vocabulary::clx;
using testing::HasSubstr;

const rules::ClassCatalogue& classes() {
  static const rules::ClassCatalogue catalogue = classCatalogueOf(shippedInputs().ontology);
  return catalogue;
}

class NotesOnValues : public ProgressSink {
 public:
  void note(std::string_view text) override { all.append(text).append("\n"); }
  std::string all;
};

std::string faultOf(const Statement& statement) {
  try {
    requireStatable(statement, classes());
    return "";
  } catch (const Error& fault) {
    return fault.what();
  }
}

Statement ofClass(const std::string& iri) {
  return {StatementKind::Is, "", Term::iri(iri), {}, {}};
}
Statement fact(const std::string& property, const Term& value) {
  return {StatementKind::Fact, property, value, {}, {}};
}
Statement region(const std::vector<Eigen::Vector3d>& corners) {
  return {StatementKind::IgnoreRegion, "", {}, {}, {ContentHash(), corners}};
}

TEST(StatedValues, AreClassesOfObjects) {
  for (const char* local : {"Tree", "StreetSign", "Structure", "Ground"})
    EXPECT_EQ(faultOf(ofClass(clx(local))), "") << local;
  for (const char* local : {"TreeTrunk", "Cluxel", "Road", "Avenue", "Column", "Cloud"})
    EXPECT_THAT(faultOf(ofClass(clx(local))), HasSubstr("is no class of objects")) << local;
  EXPECT_THAT(faultOf(ofClass(clx("Object"))), HasSubstr("tells them apart"));
  EXPECT_THAT(faultOf(ofClass(clx("Unicorn"))), HasSubstr("knows no class"));
}

/// SPARQL rules may derive any class. That it is no object at all is another statement.
TEST(StatedValues, RuleOutEveryClassThatTellsObjectsApart) {
  for (const char* local : {"Tree", "TreeTrunk", "Avenue"})
    EXPECT_EQ(faultOf({StatementKind::IsNot, "", Term::iri(clx(local)), {}, {}}), "") << local;
  const std::string feature = std::string(rdf::vocabulary::kGeo) + "Feature";
  for (const std::string& any : {clx("Object"), clx("SpatialThing"), feature})
    EXPECT_NE(faultOf({StatementKind::IsNot, "", Term::iri(any), {}, {}}), "") << any;
  EXPECT_THAT(faultOf({StatementKind::IsNot, "", Term::iri(clx("Unicorn")), {}, {}}), HasSubstr("knows no class"));
}

TEST(StatedValues, AreNoClassesThatDoNotLeadToObject) {
  rules::ClassCatalogue own = classes();
  own.classes.push_back({"http://t.example/Auto", {}, {}});
  own.classes.push_back({"http://t.example/Lorry", {clx("Vehicle")}, {}});
  EXPECT_NO_THROW(requireStatable(ofClass("http://t.example/Lorry"), own));
  try {
    requireStatable(ofClass("http://t.example/Auto"), own);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("<http://t.example/Auto> is no class of objects: it is not below clx:Object"));
  }
  EXPECT_FALSE(isClassOfObjects("http://t.example/Auto", own));
}

TEST(StatedValues, AreNoFactsThatTheMapComputes) {
  EXPECT_EQ(faultOf(fact("http://example.org/owner", Term::literal("the city"))), "");
  EXPECT_THAT(faultOf(fact(clx("height"), Term::literal("3"))), HasSubstr("is computed by the map"));
  EXPECT_THAT(faultOf(fact("http://example.org/owner", Term::blank("b"))), HasSubstr("blank node"));
  EXPECT_THAT(faultOf(fact("http://example.org/owner", Term::literal("\xff"))), HasSubstr("not UTF-8"));
}

TEST(StatedValues, ThatAMapMayHaveAreKeptWithANote) {
  const auto noteOf = [](const Statement& statement) {
    NotesOnValues notes;
    requireStatableOrKept(statement, classes(), notes);
    return notes.all;
  };
  EXPECT_EQ(noteOf(ofClass(clx("Tree"))), "");
  EXPECT_EQ(noteOf(fact("http://example.org/owner", Term::literal("the city"))), "");
  EXPECT_THAT(noteOf(ofClass(clx("Unicorn"))), HasSubstr("has no effect"));
  EXPECT_THAT(noteOf(ofClass(clx("TreeTrunk"))), HasSubstr("has no effect: <" + clx("TreeTrunk") + "> is no class"));
  EXPECT_EQ(noteOf({StatementKind::IsNot, "", Term::iri(clx("TreeTrunk")), {}, {}}), "");
  EXPECT_THAT(noteOf({StatementKind::IsNot, "", Term::iri(clx("Object")), {}, {}}), HasSubstr("is kept"));
  EXPECT_THAT(noteOf(fact(clx("height"), Term::literal("3"))), HasSubstr("is computed by the map"));
  for (const Statement& faulty :
       {fact(clx("height"), Term::blank("b")), fact(clx("height"), Term::literal("\xff")), region({}),
        fact("http://example.org/owner", Term::blank("b")), fact(rdf::vocabulary::rdf("type"), Term::iri(clx("Tree"))),
        Statement{StatementKind::Is, "", Term::literal("Tree"), {}, {}}})
    EXPECT_THROW(noteOf(faulty), Error);
}

TEST(StatedValues, AreRegionsWithAnArea) {
  EXPECT_EQ(faultOf(region({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}})), "");
  EXPECT_EQ(faultOf(region({{0, 0, 0}, {1, 1, 0}, {1, 0, 0}})), "") << "in either direction";
  for (const auto& corners : std::vector<std::vector<Eigen::Vector3d>>{{{0, 0, 0}, {1, 1, 0}, {2, 2, 0}},
                                                                       {{0, 0, 0}, {2, 2, 0}, {2, 0, 0}, {0, 2, 0}},
                                                                       {{3, 3, 0}, {3, 3, 0}, {3, 3, 0}}})
    EXPECT_THAT(faultOf(region(corners)), HasSubstr("has no area"));
  for (const double far : {1e300, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()})
    EXPECT_THAT(faultOf(region({{far, 0, 0}, {1, 0, 0}, {1, 1, 0}})), HasSubstr("corner of the region"));
}

}  // namespace
}  // namespace cluxel::mapping
