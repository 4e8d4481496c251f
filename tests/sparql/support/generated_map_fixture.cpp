// SPDX-License-Identifier: Apache-2.0
// All literals are in canonical form, so that engines that store numbers by value show the same text.
#include "sparql/support/generated_map_fixture.hpp"

#include <random>

#include "rdf/vocabulary.hpp"

namespace cluxel::test {

using namespace rdf;

namespace {

using vocabulary::clx;
using vocabulary::xsd;

Term graph(std::string_view iri) {
  return Term::iri(iri);
}
Term object(int number) {
  return Term::iri(kMadeObject + std::to_string(number));
}

class MapMaker {
 public:
  MapMaker(std::uint32_t seed, int objects) : random_(seed), objects_(objects) {}

  std::vector<Quad> make() {
    addOntology();
    for (int i = 0; i < objects_; ++i) addObject(i);
    return std::move(quads_);
  }

 private:
  int upTo(int limit) { return static_cast<int>(random_() % static_cast<std::uint32_t>(limit)); }
  bool chance(int percent) { return upTo(100) < percent; }
  void add(const Term& subject, const std::string& predicate, const Term& value, std::string_view graph_iri) {
    quads_.push_back({subject, Term::iri(predicate), value, graph(graph_iri)});
    if (!graph_iri.empty() && chance(70)) quads_.push_back({subject, Term::iri(predicate), value, graph("")});
  }
  void addOntology();
  void addObject(int number);
  void addMeasures(const Term& subject);
  void addNames(const Term& subject, int number);
  void addCentroid(const Term& subject, int number);

  std::mt19937 random_;
  int objects_;
  std::vector<Quad> quads_;
};

void MapMaker::addOntology() {
  const auto subclass = [this](const char* lower, const char* upper) {
    add(Term::iri(clx(lower)), vocabulary::rdfs("subClassOf"), Term::iri(clx(upper)), vocabulary::kGraphOntology);
    add(Term::iri(clx(lower)), vocabulary::rdfs("label"), Term::langLiteral(lower, "en"), vocabulary::kGraphOntology);
  };
  subclass("Tree", "Plant");
  subclass("Bush", "Plant");
  subclass("Plant", "Static");
  subclass("StreetSign", "Furniture");
  subclass("Lamp", "Furniture");
  subclass("Furniture", "Static");
  subclass("Car", "Movable");
  add(Term::iri(clx("Tree")), vocabulary::rdfs("label"), Term::langLiteral("Baum", "de"), vocabulary::kGraphOntology);
}

void MapMaker::addObject(int number) {
  static const std::vector<std::string> classes{"Tree", "Tree", "Bush", "StreetSign", "Lamp", "Car"};
  const Term subject = object(number);
  const Term type = Term::iri(clx(classes[static_cast<std::size_t>(upTo(6))]));
  add(subject, vocabulary::rdf("type"), type, vocabulary::kGraphObserved);
  if (chance(40)) add(subject, vocabulary::rdf("type"), type, vocabulary::kGraphInferred);
  if (chance(60)) add(subject, vocabulary::rdf("type"), Term::iri(clx("Static")), vocabulary::kGraphInferred);
  if (chance(50)) add(subject, vocabulary::rdf("type"), type, "");
  addMeasures(subject);
  addNames(subject, number);
  for (int n = upTo(3); n > 0; --n) add(subject, clx("near"), object(upTo(objects_)), vocabulary::kGraphObserved);
  if (chance(30)) add(subject, clx("near"), object(upTo(objects_)), "");
  if (chance(40)) {
    const Term part = Term::iri(std::string(kMadeObject) + std::to_string(number) + "/part");
    add(subject, clx("hasPart"), part, vocabulary::kGraphObserved);
    add(part, vocabulary::rdf("type"), Term::iri(clx("TreeTrunk")), vocabulary::kGraphObserved);
    add(part, clx("height"), Term::integer(upTo(9)), vocabulary::kGraphObserved);
  }
  if (chance(50)) addCentroid(subject, number);
  if (chance(30))
    add(subject, clx("builtAt"),
        Term::literal("2024-05-0" + std::to_string(1 + upTo(9)) + "T12:30:00Z", xsd("dateTime")),
        vocabulary::kGraphHistory);
}

void MapMaker::addMeasures(const Term& subject) {
  static const std::vector<std::string> doubles{"1.0E0", "2.5E0", "1.25E1", "-5.0E-1", "0.0E0", "7.0E0"};
  static const std::vector<std::string> decimals{"0.5", "2.5", "-1.25", "3.75", "10.125"};
  if (chance(80))
    add(subject, clx("height"), Term::literal(doubles[static_cast<std::size_t>(upTo(6))], xsd("double")),
        vocabulary::kGraphObserved);
  if (chance(60))
    add(subject, clx("width"), Term::literal(decimals[static_cast<std::size_t>(upTo(5))], xsd("decimal")),
        vocabulary::kGraphObserved);
  if (chance(80)) add(subject, clx("pointCount"), Term::integer(upTo(12) - 2), vocabulary::kGraphObserved);
  if (chance(30)) add(subject, clx("pointCount"), Term::integer(upTo(12)), "");
  if (chance(30)) add(subject, clx("seen"), Term::boolean(chance(50)), vocabulary::kGraphObserved);
}

void MapMaker::addNames(const Term& subject, int number) {
  static const std::vector<std::string> words{"oak", "Eiche", "lamp post", "caf\u00e9", "", "a.b", "Tree", "\u6728"};
  const std::string& word = words[static_cast<std::size_t>(upTo(8))];
  if (chance(50)) add(subject, clx("label"), Term::literal(word), vocabulary::kGraphObserved);
  if (chance(40))
    add(subject, clx("label"), Term::langLiteral(word, chance(50) ? "de" : "en-gb"), vocabulary::kGraphObserved);
  if (chance(30))
    add(subject, clx("note"), Term::literal(word + " " + std::to_string(number % 5)), vocabulary::kGraphOperator);
  if (chance(10)) add(subject, clx("note"), Term::literal("42", clx("serial")), vocabulary::kGraphOperator);
}

void MapMaker::addCentroid(const Term& subject, int number) {
  const Term node = Term::blank("c" + std::to_string(number));
  add(subject, clx("centroid"), node, vocabulary::kGraphObserved);
  add(node, clx("x"), Term::integer(upTo(20)), vocabulary::kGraphObserved);
  add(node, clx("y"), Term::literal(std::to_string(upTo(20)) + ".5", xsd("decimal")), vocabulary::kGraphObserved);
}

}  // namespace

std::vector<std::string> madeGraphs() {
  return {"",
          std::string(vocabulary::kGraphOntology),
          std::string(vocabulary::kGraphObserved),
          std::string(vocabulary::kGraphInferred),
          std::string(vocabulary::kGraphOperator),
          std::string(vocabulary::kGraphHistory)};
}

std::vector<Quad> madeMap(std::uint32_t seed, int objects) {
  return MapMaker(seed, objects).make();
}

}  // namespace cluxel::test
