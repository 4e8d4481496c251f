// SPDX-License-Identifier: Apache-2.0
// What every class of the shipped ontologies must say.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "rdf/ontology/ontology.hpp"
#include "rdf/scratch_folder.hpp"
#include "rdf/vocabulary.hpp"
#include "test_paths.hpp"

namespace cluxel::rdf {
namespace {

std::vector<RdfSource> shippedOntologies() {
  const auto folder = test::sourceFolder() / "ontology";
  return {readRdfSource(folder / "core.ttl"), readRdfSource(folder / "outdoor.ttl")};
}

bool isBelow(const OntologyView& view, const OntologyClass& known, const char* name) {
  const std::string ancestor = vocabulary::clx(name);
  return known.iri != ancestor && view.isA(known.iri, ancestor);
}

bool hasLabel(const OntologyClass& known, const char* language) {
  return std::any_of(known.labels.begin(), known.labels.end(),
                     [&](const ClassLabel& label) { return label.language == language; });
}

TEST(OntologyCompleteness, EveryClassHasLabelsACommentAndAParent) {
  for (const OntologyClass& known : ontologyViewOf(shippedOntologies()).classes) {
    if (!known.iri.starts_with(vocabulary::kClx)) continue;
    SCOPED_TRACE(known.iri);
    EXPECT_TRUE(hasLabel(known, "en") && hasLabel(known, "de"));
    EXPECT_GE(known.comment.size(), 10U);
    EXPECT_FALSE(known.superclasses.empty());
  }
}

TEST(OntologyCompleteness, ThingsHaveMobilityAndColour) {
  const OntologyView view = ontologyViewOf(shippedOntologies());
  std::size_t things = 0;
  for (const OntologyClass& known : view.classes) {
    if (!isBelow(view, known, "Object") && !isBelow(view, known, "Part") && !isBelow(view, known, "Place")) continue;
    SCOPED_TRACE(known.iri);
    ++things;
    EXPECT_NE(known.mobility, Mobility::Unknown);
    EXPECT_EQ(known.color.size(), 7U);
  }
  EXPECT_GT(things, 30U);
}

TEST(OntologyCompleteness, EveryPartBelongsToAClassAndPartsAreParts) {
  const OntologyView view = ontologyViewOf(shippedOntologies());
  std::set<std::string> used;
  for (const OntologyClass& known : view.classes)
    for (const std::string& part : known.parts) {
      EXPECT_TRUE(view.isA(part, vocabulary::clx("Part"))) << known.iri << " " << part;
      used.insert(part);
    }
  for (const OntologyClass& known : view.classes)
    EXPECT_TRUE(!isBelow(view, known, "Part") || used.contains(known.iri)) << known.iri;
}

TEST(OntologyCompleteness, WhatCanBeSearchedForHasUsualPlaces) {
  const OntologyView view = ontologyViewOf(shippedOntologies());
  const std::set<std::string> families{vocabulary::clx("Structure"), vocabulary::clx("Plant"),
                                       vocabulary::clx("StreetFurniture")};
  for (const OntologyClass& known : view.classes) {
    if (!isBelow(view, known, "Object") || view.isA(known.iri, vocabulary::clx("Surface"))) continue;
    if (families.contains(known.iri)) continue;  // its classes have places of their own
    double sum = 0;
    for (const UsualPlace& place : known.places) sum += place.probability;
    EXPECT_GT(sum, 0) << known.iri;
    EXPECT_LE(sum, 1) << known.iri;
  }
}

/// The objects of a predicate, by subject.
std::set<std::string> aligned(const OntologyView& view) {
  std::set<std::string> found;
  const auto environment = Environment::temporary();
  {
    WriteTransaction transaction = environment->write();
    QuadWriter writer(transaction);
    for (const RdfSource& source : shippedOntologies()) loadOntology({&source, 1}, writer);
    writer.flush();
    transaction.commit();
  }
  const QuadReader reader(environment->read());
  for (const OntologyClass& known : view.classes)
    for (const std::string& predicate :
         {std::string(vocabulary::kSkos) + "closeMatch", std::string(vocabulary::kSkos) + "exactMatch",
          std::string(vocabulary::kOwl) + "equivalentClass", std::string(vocabulary::kRdfs) + "seeAlso"}) {
      QuadPattern pattern;
      pattern.s = reader.idOf(Term::iri(known.iri));
      pattern.p = reader.idOf(Term::iri(predicate));
      QuadIds quad;
      if (pattern.s && pattern.p && reader.scan(pattern).next(quad)) found.insert(known.iri);
    }
  return found;
}

TEST(OntologyCompleteness, ThingsAndPlacesAreAlignedWithOpenStreetMapAndLayersWithStandards) {
  const OntologyView view = ontologyViewOf(shippedOntologies());
  const std::set<std::string> found = aligned(view);
  for (const OntologyClass& known : view.classes) {
    const bool is_thing = isBelow(view, known, "Object") || isBelow(view, known, "Place");
    EXPECT_TRUE(!is_thing || found.contains(known.iri)) << known.iri;
    if (!known.iri.starts_with(vocabulary::kClx)) continue;
    bool reaches_a_standard = false;
    for (const std::string& ancestor : known.ancestors)
      reaches_a_standard = reaches_a_standard || !ancestor.starts_with(vocabulary::kClx);
    EXPECT_TRUE(reaches_a_standard) << known.iri << " is under no class of GeoSPARQL, SOSA, PROV or SKOS";
  }
}

}  // namespace
}  // namespace cluxel::rdf
