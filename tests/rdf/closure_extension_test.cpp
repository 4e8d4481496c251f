// SPDX-License-Identifier: Apache-2.0
// Extending a closure by what was added gives the closure of everything; the closure of many facts is right.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "rdf/ontology/ontology.hpp"
#include "rdf/store/quad_store.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::rdf {

namespace {

using namespace vocabulary;

std::string owlName(std::string_view local) {
  return std::string(kOwl).append(local);
}

class RandomFacts {
 public:
  explicit RandomFacts(unsigned seed) : random_(seed) {}

  Quad fact(std::string_view graph) {
    if (below(4) == 0) return quad(thing(), rdf("type"), kind(), graph);
    return quad(thing(), property(), thing(), graph);
  }

  Quad axiom(std::string_view graph) {
    switch (below(6)) {
      case 0:
        return quad(kind(), rdfs("subClassOf"), kind(), graph);
      case 1:
        return quad(property(), owlName("inverseOf"), property(), graph);
      case 2:
        return quad(property(), rdf("type"), owlName("SymmetricProperty"), graph);
      case 3:
        return quad(property(), rdf("type"), owlName("TransitiveProperty"), graph);
      case 4:  // a kind that makes properties symmetric
        return quad(kind(), rdfs("subClassOf"), owlName("SymmetricProperty"), graph);
      default:
        return quad(property(), rdfs("subPropertyOf"), property(), graph);
    }
  }
  /// A property that is said to be of a kind of things.
  Quad kindOfProperty(std::string_view graph) { return quad(property(), rdf("type"), kind(), graph); }
  std::size_t below(std::size_t end) { return random_() % end; }

 private:
  static Quad quad(const std::string& s, const std::string& p, const std::string& o, std::string_view graph) {
    return {Term::iri(s), Term::iri(p), Term::iri(o), Term::iri(std::string(graph))};
  }
  std::string thing() { return "http://x/t" + std::to_string(below(25)); }
  std::string property() { return "http://x/p" + std::to_string(below(6)); }
  std::string kind() { return "http://x/k" + std::to_string(below(6)); }

  std::mt19937 random_;
};

std::vector<QuadIds> addTo(WriteTransaction& transaction, const std::vector<Quad>& quads) {
  std::vector<QuadIds> added;
  QuadWriter writer(transaction);
  for (const Quad& quad : quads) {
    added.push_back({writer.intern(quad.subject), writer.intern(quad.predicate), writer.intern(quad.object),
                     writer.intern(quad.graph)});
    writer.add(added.back());
  }
  writer.flush();
  return added;
}

std::vector<std::string> inferredBy(WriteTransaction& transaction) {
  const QuadReader reader(transaction);
  std::vector<std::string> facts;
  QuadCursor cursor =
      reader.scan({.s = {}, .p = {}, .o = {}, .g = *reader.idOf(Term::iri(std::string(kGraphInferred)))});
  for (QuadIds quad; cursor.next(quad);)
    facts.push_back(reader.termOf(quad.s).text + " " + reader.termOf(quad.p).text + " " + reader.termOf(quad.o).text);
  std::sort(facts.begin(), facts.end());
  return facts;
}

/// `new_axioms`: whether axioms are among what is added later.
void expectSameExtension(unsigned seed, bool new_axioms) {
  RandomFacts facts(seed);
  std::vector<Quad> stated;
  for (int i = 0; i < 8; ++i) stated.push_back(facts.axiom(kGraphOntology));
  for (int i = 0; i < 60; ++i) stated.push_back(facts.fact(kGraphObserved));
  const auto told = Environment::temporary(), untold = Environment::temporary();
  WriteTransaction with = told->write(), without = untold->write();
  for (WriteTransaction* transaction : {&with, &without}) {
    addTo(*transaction, stated);
    inferClosure(*transaction);
  }
  for (int step = 0; step < 4; ++step) {
    std::vector<Quad> more;
    for (std::size_t i = 0; i < 1 + facts.below(6); ++i) more.push_back(facts.fact(kGraphInferred));
    if (new_axioms) more.push_back(facts.axiom(kGraphInferred));
    if (new_axioms && step == 2) more.push_back(facts.kindOfProperty(kGraphInferred));
    const std::vector<QuadIds> fresh = addTo(with, more);
    addTo(without, more);
    extendClosure(with, fresh);
    extendClosure(without);
    ASSERT_EQ(inferredBy(with), inferredBy(without)) << "seed " << seed << ", step " << step;
  }
}

TEST(ClosureExtension, ByFactsIsTheWholeClosure) {
  for (unsigned seed = 0; seed < 60; ++seed) expectSameExtension(seed, false);
}

TEST(ClosureExtension, ByAxiomsIsTheWholeClosure) {
  for (unsigned seed = 100; seed < 160; ++seed) expectSameExtension(seed, true);
}

using Fact = std::array<std::string, 3>;

/// So many facts that a property is read as a whole to find those that are stated. Some are stated already, some in a
/// graph that does not count, some have numbers.
TEST(Closure, OfManyFactsHasEachOnceAndNoneThatIsStated) {
  constexpr int kThings = 6000;
  std::mt19937 random(7);
  const auto thing = [&] { return "http://x/t" + std::to_string(random() % kThings); };
  const auto with = [](const std::string& s, const std::string& p, const Term& o, std::string_view graph) {
    return Quad{Term::iri(s), Term::iri(p), o, Term::iri(std::string(graph))};
  };
  const auto number = [&] { return Term::literal(std::to_string(random() % 500), std::string(kXsd) + "integer"); };
  std::vector<Quad> stated{
      with("http://x/k0", rdfs("subClassOf"), Term::iri("http://x/k1"), kGraphOntology),
      with("http://x/k1", rdfs("subClassOf"), Term::iri("http://x/k2"), kGraphOntology),
      with("http://x/inside", owlName("inverseOf"), Term::iri("http://x/around"), kGraphOntology),
      with("http://x/width", rdfs("subPropertyOf"), Term::iri("http://x/size"), kGraphOntology),
  };
  std::set<Fact> all, expected;
  const auto state = [&](const std::string& s, const std::string& p, const Term& o) {
    const bool counts = random() % 8 != 0;
    stated.push_back(with(s, p, o, counts ? kGraphObserved : std::string_view("http://x/elsewhere")));
    if (counts) all.insert({s, p, o.text});
  };
  for (int i = 0; i < kThings; ++i) {
    state(thing(), rdf("type"), Term::iri("http://x/k" + std::to_string(random() % 3)));
    state(thing(), "http://x/inside", Term::iri(thing()));
    state(thing(), "http://x/around", Term::iri(thing()));
    state(thing(), "http://x/width", number());
    state(thing(), "http://x/size", number());
  }
  for (const auto& [s, p, o] : all) {
    const auto derive = [&](const Fact& fact) {
      if (!all.contains(fact)) expected.insert(fact);
    };
    if (o == "http://x/k0") derive({s, p, "http://x/k1"});
    if (o == "http://x/k0" || o == "http://x/k1") derive({s, p, "http://x/k2"});
    if (p == "http://x/inside") derive({o, "http://x/around", s});
    if (p == "http://x/around") derive({o, "http://x/inside", s});
    if (p == "http://x/width") derive({s, "http://x/size", o});
  }
  expected.insert({"http://x/k0", rdfs("subClassOf"), "http://x/k2"});
  const auto environment = Environment::temporary();
  WriteTransaction transaction = environment->write();
  addTo(transaction, stated);
  const QuadReader reader(transaction);
  const std::vector<TermId> sources{*reader.idOf(Term::iri(std::string(kGraphObserved))),
                                    *reader.idOf(Term::iri(std::string(kGraphOntology)))};
  const EntailedQuads found = closureOf(reader, kNoTerm, sources, ClosureLimits::of(reader));
  std::set<Fact> facts;
  for (const QuadIds& quad : found.quads)
    EXPECT_TRUE(
        facts.insert({reader.termOf(quad.s).text, reader.termOf(quad.p).text, reader.termOf(quad.o).text}).second);
  EXPECT_GT(facts.size(), 15'000U);
  EXPECT_TRUE(facts == expected);
}

}  // namespace
}  // namespace cluxel::rdf
