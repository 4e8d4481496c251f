// SPDX-License-Identifier: Apache-2.0
// Tests of the shipped ontologies, of faults in edited ones, and of the closure against a naive implementation.
#include "rdf/ontology/ontology.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <set>

#include "rdf/vocabulary.hpp"
#include "test_paths.hpp"

namespace cluxel::rdf {
namespace {

using namespace vocabulary;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsSupersetOf;

std::vector<RdfSource> shipped() {
  const std::filesystem::path folder = test::sourceFolder() / "ontology";
  return {readRdfSource(folder / "core.ttl"), readRdfSource(folder / "outdoor.ttl")};
}

std::vector<Diagnostic> diagnosticsOf(const std::string& addition) {
  std::vector<RdfSource> sources = shipped();
  sources.push_back(
      {"@prefix clx: <https://w3id.org/cluxel/ontology#> .\n@prefix owl: <http://www.w3.org/2002/07/owl#> .\n"
       "@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .\n" +
           addition,
       "bench.ttl", RdfFormat::Turtle, "http://x/", Term::iri("")});
  try {
    ontologyViewOf(sources);
  } catch (const InputError& error) {
    return error.diagnostics();
  }
  return {};
}

TEST(Ontology, KnowsTheClassesThatRulesName) {
  const OntologyView view = ontologyViewOf(shipped());
  for (const char* name :
       {"Ground", "Building", "Tree", "Bush", "StreetLamp", "StreetSign", "UtilityPole", "Vehicle", "SmallObject"}) {
    const OntologyClass* entry = view.find(clx(name));
    ASSERT_NE(entry, nullptr) << name;
    EXPECT_TRUE(view.isA(clx(name), clx("Object")));
    EXPECT_TRUE(view.isA(clx(name), std::string(kGeo) + "Feature"));
    EXPECT_EQ(entry->color.size(), 7U);
    EXPECT_NE(entry->mobility, Mobility::Unknown);
    EXPECT_TRUE(entry->labels.size() >= 2) << name;
    EXPECT_FALSE(entry->comment.empty());
  }
  const OntologyClass& tree = *view.find(clx("Tree"));
  EXPECT_THAT(tree.parts, ElementsAre(clx("TreeTop"), clx("TreeTrunk")));
  EXPECT_EQ(tree.label("de"), "Baum");
  EXPECT_EQ(tree.label("fr"), "tree");
  EXPECT_EQ(view.find(clx("Vehicle"))->mobility, Mobility::Movable);
  EXPECT_FALSE(view.isA(clx("Tree"), clx("StreetFurniture")));
}

TEST(Ontology, GivesUsualPlacesTheMostProbableFirst) {
  const OntologyView view = ontologyViewOf(shipped());
  for (const OntologyClass& entry : view.classes) {
    double sum = 0;
    double last = 1;
    for (const UsualPlace& place : entry.places) {
      sum += place.probability;
      EXPECT_LE(place.probability, last);
      EXPECT_GT(place.within_m, 0);
      last = place.probability;
    }
    EXPECT_LE(sum, 1 + 1e-9) << entry.iri;
  }
  EXPECT_EQ(view.find(clx("StreetSign"))->places.front().near_class, clx("Crossing"));
}

TEST(Ontology, GivesAttributesAUnitAndAnEnglishText) {
  const OntologyView view = ontologyViewOf(shipped());
  std::map<std::string, OntologyProperty> properties;
  for (const OntologyProperty& property : view.properties) properties[property.iri] = property;
  for (const char* name : {"height", "horizontalExtent", "normalTilt", "pointCount", "minX", "z", "meanIntensity"}) {
    EXPECT_FALSE(properties[clx(name)].unit.empty()) << name;
    EXPECT_FALSE(properties[clx(name)].label.empty()) << name;
    EXPECT_FALSE(properties[clx(name)].comment.empty()) << name;
  }
  EXPECT_EQ(properties[clx("footprintArea")].unit, "m2");
}

TEST(Ontology, TakesAClassFromAFileOfItsOwn) {
  std::vector<RdfSource> sources = shipped();
  sources.push_back(
      {"@prefix clx: <https://w3id.org/cluxel/ontology#> . @prefix owl: <http://www.w3.org/2002/07/owl#> .\n"
       "@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .\n"
       "clx:Bench a owl:Class ; rdfs:subClassOf clx:StreetFurniture .",
       "bench.ttl", RdfFormat::Turtle, "http://x/", Term::iri("")});
  const OntologyView view = ontologyViewOf(sources);
  EXPECT_TRUE(view.isA(clx("Bench"), clx("Object")));
  EXPECT_EQ(view.find(clx("Bench"))->color, view.find(clx("StreetFurniture"))->color);
  EXPECT_EQ(view.find(clx("Bench"))->label(), "Bench");
}

TEST(Ontology, ShowsAllFaultsAtTheirPlaces) {
  const auto faults = diagnosticsOf(
      "clx:Bench a owl:Class ;\n  rdfs:subClassOf clx:Seat ;\n  clx:color \"red\" ;\n  clx:mayHavePart "
      "clx:TreeTronk .\n"
      "clx:Seat a owl:Class ; rdfs:subClassOf clx:Bench ; clx:mobility clx:Fixed .\n");
  std::vector<std::string> texts;
  for (const Diagnostic& fault : faults)
    texts.push_back(toString(fault.location) + ' ' + fault.message + ' ' + fault.hint);
  EXPECT_THAT(texts, IsSupersetOf({std::string("bench.ttl:6:14 Bench: a colour is written #rrggbb ")}));
  EXPECT_THAT(texts,
              Contains(HasSubstr("bench.ttl:7:23 Bench: there is no class TreeTronk did you mean 'TreeTrunk'?")));
  EXPECT_THAT(texts, Contains(HasSubstr("is its own superclass")));
  EXPECT_THAT(texts, Contains(HasSubstr("a mobility is clx:Static or clx:Movable")));
}

/// Applies the rules of the specifications to all pairs of quads until nothing changes.
std::set<QuadIds> naiveClosure(std::set<QuadIds> all, const std::map<std::string, TermId>& w, TermId literal) {
  const auto has = [&](TermId s, TermId p, TermId o) { return all.contains({s, p, o, 0}); };
  const auto reserved = [&](TermId p) {
    return p == w.at("type") || p == w.at("subClassOf") || p == w.at("subPropertyOf") || p == w.at("inverseOf");
  };
  for (std::size_t before = 0; before != all.size();) {
    before = all.size();
    std::set<QuadIds> next = all;
    for (const QuadIds& a : all) {
      for (const QuadIds& b : all) {
        const bool schema = a.p == w.at("subClassOf") || a.p == w.at("subPropertyOf");
        const bool transitive = has(a.p, w.at("type"), w.at("Transitive")) && !reserved(a.p);
        if (a.p == b.p && a.o == b.s && (schema || transitive) && !(schema && a.s == b.o))
          next.insert({a.s, a.p, b.o, 0});
        if (a.p == w.at("type") && b.p == w.at("subClassOf") && a.o == b.s) next.insert({a.s, a.p, b.o, 0});
        if (reserved(b.s) || (b.p != w.at("type") && reserved(b.o))) continue;
        if (b.p == w.at("subPropertyOf") && a.p == b.s) next.insert({a.s, b.o, a.o, 0});
        if (b.p == w.at("inverseOf") && a.p == b.s && a.o != literal) next.insert({a.o, b.o, a.s, 0});
        if (b.p == w.at("inverseOf") && a.p == b.o && a.o != literal) next.insert({a.o, b.s, a.s, 0});
        if (b.p == w.at("type") && b.o == w.at("Symmetric") && a.p == b.s && a.o != literal)
          next.insert({a.o, a.p, a.s, 0});
      }
    }
    all = std::move(next);
  }
  return all;
}

TEST(Closure, FindsWhatANaiveApplicationOfTheRulesFinds) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    std::mt19937 random(seed);
    const auto environment = Environment::temporary();
    WriteTransaction transaction = environment->write();
    QuadWriter writer(transaction);
    const std::map<std::string, TermId> words = {
        {"type", writer.intern(Term::iri(rdf("type")))},
        {"subClassOf", writer.intern(Term::iri(rdfs("subClassOf")))},
        {"subPropertyOf", writer.intern(Term::iri(rdfs("subPropertyOf")))},
        {"inverseOf", writer.intern(Term::iri(std::string(kOwl) + "inverseOf"))},
        {"Symmetric", writer.intern(Term::iri(std::string(kOwl) + "SymmetricProperty"))},
        {"Transitive", writer.intern(Term::iri(std::string(kOwl) + "TransitiveProperty"))}};
    const TermId literal = writer.intern(Term::literal("x"));
    std::vector<TermId> classes, properties, things;
    for (int i = 0; i < 5; ++i) {
      classes.push_back(writer.intern(Term::iri("c" + std::to_string(i))));
      properties.push_back(writer.intern(Term::iri("p" + std::to_string(i))));
      things.push_back(writer.intern(Term::iri("t" + std::to_string(i))));
    }
    const auto any = [&](const std::vector<TermId>& from) { return from[random() % from.size()]; };
    std::set<QuadIds> stated;
    for (int i = 0; i < 5; ++i) {
      stated.insert({any(classes), words.at("subClassOf"), any(classes), 0});
      if (i < 3) stated.insert({any(properties), words.at("subPropertyOf"), any(properties), 0});
      if (i < 2) stated.insert({any(properties), words.at("inverseOf"), any(properties), 0});
      stated.insert({any(things), words.at("type"), any(classes), 0});
      stated.insert({any(things), any(properties), i == 0 ? literal : any(things), 0});
      stated.insert({any(things), any(properties), any(things), 0});
    }
    stated.insert({any(properties), words.at("type"), words.at("Symmetric"), 0});
    stated.insert({any(properties), words.at("type"), words.at("Transitive"), 0});
    if (seed % 4 == 0) stated.insert({any(properties), words.at("subPropertyOf"), words.at("type"), 0});
    if (seed % 4 == 1) stated.insert({words.at("type"), words.at("inverseOf"), words.at("subClassOf"), 0});
    if (seed % 4 == 2) stated.insert({words.at("type"), words.at("type"), words.at("Transitive"), 0});
    for (const QuadIds& quad : stated) writer.add(quad);
    writer.flush();
    const TermId other_graph = things.front();
    writer.add(QuadIds{things[1], words.at("type"), classes[0], other_graph});  // outside the sources: no effect
    writer.flush();
    const std::vector<TermId> sources = {0};
    const QuadReader reader(transaction);
    const EntailedQuads inferred = closureOf(reader, 0, sources, ClosureLimits::of(reader));
    EXPECT_EQ(inferred.ignored.empty(), seed % 4 == 3);
    std::set<QuadIds> all = stated;
    for (const QuadIds& quad : inferred.quads) EXPECT_TRUE(all.insert(quad).second) << "was stated already";
    EXPECT_TRUE(all == naiveClosure(stated, words, literal)) << seed;
  }
}

TEST(Closure, MakesNoFactWhosePredicateIsNoIri) {
  const auto environment = Environment::temporary();
  WriteTransaction transaction = environment->write();
  QuadWriter writer(transaction);
  const Term p = Term::iri("http://x/p"), q = Term::iri("http://x/q"), blank = Term::blank("turned");
  const Term sub_property = Term::iri(rdfs("subPropertyOf")), observed = Term::iri(kGraphObserved);
  writer.add(Quad{p, sub_property, blank, observed});
  writer.add(Quad{blank, Term::iri(std::string(kOwl) + "inverseOf"), q, observed});
  writer.add(Quad{p, sub_property, Term::literal("nonsense"), observed});
  writer.add(Quad{Term::iri("http://x/a"), p, Term::iri("http://x/b"), observed});
  writer.add(Quad{Term::iri("http://x/c"), q, Term::iri("http://x/d"), observed});
  writer.flush();
  inferClosure(transaction);
  const QuadReader reader(transaction);
  std::set<std::string> inferred;
  QuadCursor cursor = reader.scan({.s = {}, .p = {}, .o = {}, .g = reader.idOf(Term::iri(kGraphInferred))});
  for (QuadIds quad; cursor.next(quad);)
    inferred.insert(toNTriples(reader.termOf(quad.s)) + toNTriples(reader.termOf(quad.p)) +
                    toNTriples(reader.termOf(quad.o)));
  EXPECT_THAT(inferred, ElementsAre("<http://x/b><http://x/q><http://x/a>")) << "through the blank node";
}

TEST(Closure, KeepsTheInferredGraphWhatFollowsFromTheOthers) {
  const auto environment = Environment::temporary();
  WriteTransaction transaction = environment->write();
  const Quad stated{Term::iri("http://x/tree"), Term::iri(rdf("type")), Term::iri(clx("Tree")),
                    Term::iri(kGraphObserved)};
  QuadWriter writer(transaction);
  loadOntology(shipped(), writer);
  writer.flush();
  EXPECT_GT(inferClosure(transaction).added, 0U);
  writer.add(stated);
  writer.flush();
  EXPECT_EQ(inferClosure(transaction).added, 4U);  // Plant, Object, SpatialThing, geo:Feature
  EXPECT_EQ(inferClosure(transaction).added, 0U);
  const auto quad = [&](const char* name) {
    const QuadReader reader(transaction);
    const auto id = [&](const std::string& iri) { return reader.idOf(Term::iri(iri)).value_or(0); };
    return QuadIds{id("http://x/tree"), id(rdf("type")), id(clx(name)), id(std::string(kGraphInferred))};
  };
  EXPECT_TRUE(QuadReader(transaction).contains(quad("Plant")));
  EXPECT_FALSE(QuadReader(transaction).contains(quad("Tree")));
  writer.add(quad("Vehicle"));  // as a rule would
  writer.flush();
  EXPECT_EQ(extendClosure(transaction).added, 0U) << "Object was inferred already";
  EXPECT_TRUE(QuadReader(transaction).contains(quad("Vehicle")));
  EXPECT_EQ(inferClosure(transaction).removed, 1U);
  EXPECT_FALSE(QuadReader(transaction).contains(quad("Vehicle")));
}

constexpr const char* kPrefixes =
    "@prefix clx: <https://w3id.org/cluxel/ontology#> . @prefix owl: <http://www.w3.org/2002/07/owl#> .\n"
    "@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> . @prefix : <http://x/> .\n"
    "@prefix rdf: <http://www.w3.org/1999/02/22-rdf-syntax-ns#> .\n";

/// The shipped ontology, and these statements in graph `operator`.
class Inference {
 public:
  explicit Inference(const std::string& statements)
      : environment_(Environment::temporary()), transaction_(environment_->write()) {
    const std::string text = kPrefixes + statements;
    QuadWriter writer(transaction_);
    loadOntology(shipped(), writer);
    loadRdf({text, "operator.ttl", RdfFormat::Turtle, "http://x/", Term::iri(kGraphOperator)}, writer);
    writer.flush();
  }
  EntailedQuads closure(const ClosureLimits& limits) const {
    const QuadReader reader(transaction_);
    const std::vector<TermId> sources = {*reader.idOf(Term::iri(kGraphOntology)),
                                         *reader.idOf(Term::iri(kGraphOperator))};
    return closureOf(reader, kNoTerm, sources, limits);
  }

 private:
  std::shared_ptr<Environment> environment_;
  WriteTransaction transaction_;
};

constexpr const char* kThings =
    ":a a clx:Tree ; clx:near :b . :b a clx:Bush ; clx:near :c . :c a clx:StreetLamp ; clx:standsOn :d . :d a "
    "clx:Ground .\n";

TEST(Closure, IgnoresAxiomsAboutThePropertiesByWhichItWorks) {
  const std::size_t plain = Inference(kThings).closure({10'000, 1'000'000}).quads.size();
  ASSERT_GT(plain, 0U);
  for (const char* axiom :
       {"rdfs:subClassOf owl:inverseOf rdf:type .", "rdf:type owl:inverseOf rdfs:subClassOf .",
        "rdf:type a owl:TransitiveProperty .", "rdf:type a owl:SymmetricProperty .",
        "rdfs:subClassOf a owl:SymmetricProperty .", "owl:inverseOf a owl:SymmetricProperty .",
        "rdfs:subPropertyOf a owl:SymmetricProperty .", "rdf:type rdfs:subPropertyOf rdfs:subClassOf .",
        "rdfs:subClassOf rdfs:subPropertyOf rdf:type .", "owl:inverseOf owl:inverseOf owl:inverseOf .",
        "owl:inverseOf rdfs:subPropertyOf rdfs:subPropertyOf .", "rdfs:subPropertyOf owl:inverseOf rdf:type .",
        "clx:near rdfs:subPropertyOf rdfs:subPropertyOf .", "clx:near rdfs:subPropertyOf rdfs:subClassOf .",
        "clx:near owl:inverseOf rdf:type .", "_:turned owl:inverseOf rdf:type . clx:near rdfs:subPropertyOf _:turned .",
        "rdf:type a :Kind . :Kind rdfs:subClassOf owl:SymmetricProperty ."}) {
    const EntailedQuads entailed = Inference(std::string(kThings) + axiom).closure({plain + 30, 100'000});
    EXPECT_LE(entailed.quads.size(), plain + 10) << axiom;
    EXPECT_FALSE(entailed.ignored.empty()) << axiom;
  }
}

TEST(Closure, TellsItsMemoryWhileItRunsAndEndsWhenThatIsRefused) {
  std::string chain = "clx:near a owl:TransitiveProperty .\n";
  for (int i = 0; i < 200; ++i) chain += ":t" + std::to_string(i) + " clx:near :t" + std::to_string(i + 1) + " .\n";
  const Inference inference(chain);
  std::size_t calls = 0, most = 0;
  const auto count = [&](std::size_t bytes) {
    ++calls;
    EXPECT_GE(bytes, most) << "it only grows";
    most = bytes;
  };
  inference.closure({50'000, 50'000'000, {count}});
  EXPECT_GT(calls, 5U);
  EXPECT_GT(most, 20'000U * sizeof(QuadIds)) << "it holds some 20,000 facts";
  struct Refused {};
  const auto refuse = [](std::size_t bytes) {
    if (bytes > 1'000'000) throw Refused();
  };
  EXPECT_THROW(inference.closure({50'000, 50'000'000, {refuse}}), Refused);
}

TEST(Closure, SaysThatSuperclassesAreTooManyWhenItEndsAtThem) {
  std::string chain;
  for (int i = 0; i < 200; ++i)
    chain += ":c" + std::to_string(i) + " rdfs:subClassOf :c" + std::to_string(i + 1) + " .\n";
  try {
    Inference(chain).closure({5'000, 50'000'000});
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("too many superclasses lie above each other"));
    EXPECT_THAT(error.what(), Not(HasSubstr("transitive")));
  }
}

TEST(Closure, EndsAtItsLimitsWithTheProperty) {
  std::string chain = "clx:near a owl:TransitiveProperty .\n";
  for (int i = 0; i < 200; ++i) chain += ":t" + std::to_string(i) + " clx:near :t" + std::to_string(i + 1) + " .\n";
  const Inference inference(chain);
  EXPECT_GT(inference.closure({50'000, 50'000'000}).quads.size(), 20'000U);
  for (const ClosureLimits& limits : {ClosureLimits{5'000, 50'000'000}, ClosureLimits{50'000, 20'000}}) {
    try {
      inference.closure(limits);
      FAIL() << "no error";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::BudgetExceeded);
      EXPECT_THAT(error.what(), HasSubstr("ontology#near>"));
    }
  }
}

}  // namespace
}  // namespace cluxel::rdf
