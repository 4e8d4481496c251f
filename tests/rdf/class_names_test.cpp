// SPDX-License-Identifier: Apache-2.0
// Short names of classes that tell them apart.
#include "rdf/ontology/class_names.hpp"

#include <gtest/gtest.h>

#include "rdf/io/rdf_io.hpp"
#include "rdf/ontology/ontology.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::rdf {
namespace {

using Names = std::vector<std::string>;
using vocabulary::clx;

const std::string kTown = "http://t.example/town#", kStore = "http://t.example/store/";

TEST(ClassNames, AreLocalNamesWhereTheseMeanTheClass) {
  const ClassNames names({clx("Tree"), kTown + "Tree", kTown + "Kiosk", kTown + "Car", kStore + "Car", kStore});
  EXPECT_EQ(names.nameOf(clx("Tree")), "Tree");
  EXPECT_EQ(names.nameOf(kTown + "Kiosk"), "Kiosk");
  for (const std::string& iri : {kTown + "Tree", kTown + "Car", kStore + "Car", kStore})
    EXPECT_EQ(names.nameOf(iri), iri);
  EXPECT_EQ(names.nameOf(kStore + "Kiosk"), kStore + "Kiosk") << "one that was not added";
  EXPECT_EQ(names.nameOf(kStore + "Shelf"), "Shelf");
  EXPECT_EQ(names.meantBy("Tree"), (Names{clx("Tree")}));
  EXPECT_EQ(names.meantBy("Car"), (Names{kStore + "Car", kTown + "Car"}));
  EXPECT_EQ(names.withLocalName("Tree"), (Names{kTown + "Tree", clx("Tree")}));
  EXPECT_TRUE(names.meantBy("Shelf").empty());
}

TEST(ClassNames, AreThoseThatTheOntologyDeclares) {
  const auto environment = Environment::temporary();
  WriteTransaction transaction = environment->write();
  QuadWriter writer(transaction);
  const std::vector<RdfSource> sources{
      {"@prefix owl: <http://www.w3.org/2002/07/owl#> . @prefix clx: <https://w3id.org/cluxel/ontology#> .\n"
       "@prefix my: <http://t.example/town#> . my:Tree a owl:Class . clx:Tree a owl:Class .\n",
       "o.ttl", RdfFormat::Turtle, "http://x/", Term::iri("")}};
  loadOntology(sources, writer);
  writer.flush();
  EXPECT_EQ(classNamesOf(QuadReader(transaction)).all(), (Names{"Tree", "http://t.example/town#Tree"}));
}

TEST(Prefixes, OfASourceAreGivenInTheirOrder) {
  using Prefixes = std::vector<std::pair<std::string, std::string>>;
  EXPECT_EQ(prefixesIn({"@prefix b: <http://b/> .\n@prefix : <http://own/> .\nPREFIX a: <http://a#>\na:x a b:y .\n",
                        "p.ttl", RdfFormat::Turtle, "http://x/", Term::iri("")}),
            (Prefixes{{"b", "http://b/"}, {"", "http://own/"}, {"a", "http://a#"}}));
}

}  // namespace
}  // namespace cluxel::rdf
