// SPDX-License-Identifier: Apache-2.0
// A store in which facts are stated and withdrawn at random, and inference follows.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <memory>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "mapping/inference/infer_facts.hpp"
#include "mapping/inference/inference_record.hpp"
#include "mapping/small_campus.hpp"
#include "rdf/ontology/ontology.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::mapping {

class NoteSink : public ProgressSink {
 public:
  void note(std::string_view text) override { notes.emplace_back(text); }
  std::vector<std::string> notes;
};

inline Term thing(const std::string& name, std::size_t number) {
  return Term::iri("https://example.org/" + name + std::to_string(number));
}

/// Facts about a few trees, vehicles, walls and ways, enough for every shipped rule to find something.
class Universe {
 public:
  /// `with_statements`: also what operators stated of trees and barriers.
  explicit Universe(bool with_statements = false) {
    for (std::size_t i = 0; i < 9; ++i) addTree(i);
    for (std::size_t i = 0; i < 6; ++i) addVehicle(i);
    for (std::size_t i = 0; i < 3; ++i) addBarrier(i);
    for (std::size_t i = 0; i < 3; ++i) addBuilding(i);
    for (std::size_t i = 0; i < 6; ++i) addWay(i);
    if (with_statements) addStatements();
  }
  /// The graph of a fact; absent: any graph of stated facts will do.
  static std::optional<std::string_view> graphOf(const std::array<Term, 3>& fact) {
    const std::string property = fact[1].text.substr(fact[1].text.find('#') + 1);
    if (property == "statementKind" || property == "statedClass") return vocabulary::kGraphOperator;
    if (property == "statementEffect" || property == "appliesTo") return vocabulary::kGraphObserved;
    return std::nullopt;
  }
  const std::vector<std::array<Term, 3>>& facts() const { return facts_; }

 private:
  void add(const Term& subject, const std::string& property, const Term& object) {
    const bool is_full = property.find(':') != std::string::npos;
    facts_.push_back({subject, Term::iri(is_full ? property : vocabulary::clx(property)), object});
  }
  void number(const Term& subject, const std::string& property, double value) {
    add(subject, property, Term::literal(std::to_string(value), vocabulary::xsd("decimal")));
  }
  void type(const Term& subject, const std::string& kind) {
    add(subject, vocabulary::rdf("type"), Term::iri(vocabulary::clx(kind)));
  }
  void bounds(const Term& subject, double at) {
    for (const char* name : {"minX", "minY"}) number(subject, name, at);
    for (const char* name : {"maxX", "maxY"}) number(subject, name, at + 2);
  }
  void addTree(std::size_t i) {
    type(thing("tree", i), "Tree");
    bounds(thing("tree", i), static_cast<double>(i));
    number(thing("tree", i), "height", 5);  // inference has nothing to do with it
    for (const std::size_t other : {i + 1, i + 3})
      if (other < 9) add(thing("tree", i), "near", thing("tree", other));
  }
  void addVehicle(std::size_t i) {
    const Term vehicle = thing("vehicle", i), centroid = thing("centroid", i);
    const double x = 3.0 * static_cast<double>(i);
    type(vehicle, "Vehicle");
    number(vehicle, "x", x), number(vehicle, "y", 0), number(vehicle, "heading", 1.5707963);
    number(vehicle, "length", 4), number(vehicle, "width", 1.8);
    add(vehicle, std::string(vocabulary::kGeo) + "hasCentroid", centroid);
    add(centroid, std::string(vocabulary::kGeo) + "asWKT",
        Term::literal("POINT (" + std::to_string(x) + " 0)", std::string(vocabulary::kGeo) + "wktLiteral"));
    bounds(vehicle, x);
  }
  void addBarrier(std::size_t i) {
    const Term barrier = thing("barrier", i);
    type(barrier, "Barrier");
    number(barrier, "porosity", i == 0 ? 0.01 : 0.3), number(barrier, "rayCount", 100), number(barrier, "width", 0.4);
  }
  void addBuilding(std::size_t i) {
    const Term building = thing("building", i), facade = thing("facade", i), wall = thing("wall", i);
    type(building, "Building"), type(facade, "Facade"), type(wall, "VerticalPlane");
    add(building, "hasPart", facade), add(facade, "hasPrimitive", wall);
    if (i > 0) add(building, "hasPart", thing("building", i - 1));
    add(wall, "touchesGround", thing("ground", 0)), add(wall, "touchesGround", thing("ground", 1));
    number(wall, "length", 3);
    bounds(wall, 5), bounds(building, 4);
  }
  void addWay(std::size_t i) {
    const Term way = thing("way", i);
    type(way, "Way"), type(thing("junction", i % 2), "Junction");
    number(way, "width", i < 3 ? 5 : 1.5), number(way, "lowerBeside", i == 4 ? 0.8 : 0),
        number(way, "higherBeside", 0.1);
    number(way, "length", 10);
    add(way, "connects", thing("junction", i % 2)), add(way, "connects", thing("junction", 2));
  }
  void addStatement(const Term& about, const std::string& kind, const std::string& stated_class) {
    const Term statement = thing("statement", statements_++);
    add(statement, "statementKind", Term::literal(kind));
    add(statement, "statedClass", Term::iri(vocabulary::clx(stated_class)));
    add(statement, "statementEffect", Term::literal("applied"));
    add(statement, "appliesTo", about);
  }
  void addStatements() {
    for (std::size_t i = 0; i < 9; ++i) addStatement(thing("tree", i), "is not", i % 2 == 0 ? "Avenue" : "Place");
    for (std::size_t i = 0; i < 3; ++i) addStatement(thing("barrier", i), "is", i == 0 ? "Fence" : "Wall");
    for (std::size_t i = 0; i < 3; ++i) addStatement(thing("barrier", i), "is not", i == 1 ? "Fence" : "Barrier");
  }

  std::vector<std::array<Term, 3>> facts_;
  std::size_t statements_ = 0;
};

struct Inferred {
  std::vector<QuadIds> quads;
  InferenceRecord record;
};

/// A store in which facts are stated and withdrawn at random, and graph inferred follows.
class ChangingStore {
 public:
  ChangingStore(unsigned seed, std::vector<NamedText> rules, bool with_statements = false)
      : random_(seed), rules_(std::move(rules)), universe_(with_statements) {
    WriteTransaction transaction = environment_->write();
    QuadWriter writer(transaction);
    loadOntology(ontologySources(shippedInputs().ontology), writer);
    for (const auto& fact : universe_.facts())
      if (below(5) > 0)
        writer.add(Quad{fact[0], fact[1], fact[2],
                        Term::iri(std::string(Universe::graphOf(fact).value_or(vocabulary::kGraphObserved)))});
    writer.flush();
    inferAll(transaction, rules_, silence());
    transaction.commit();
  }

  void step() {
    WriteTransaction transaction = environment_->write();
    QuadWriter writer(transaction);
    const QuadReader reader(static_cast<const ReadTransaction&>(transaction));
    for (std::size_t left = 1 + below(5); left > 0; --left) toggle(reader, writer);
    writer.flush();
    followed_ += inferChanges(transaction, rules_, sink) ? 1 : (inferAnew(transaction, rules_, sink), 0);
    transaction.commit();
  }

  void expectInferenceFromScratch(int step) {
    WriteTransaction transaction = environment_->write();
    const Inferred by_change = inferred(transaction);
    inferAnew(transaction, rules_, silence());
    const Inferred anew = inferred(transaction);
    const auto followed = textOf(transaction, by_change.quads), whole = textOf(transaction, anew.quads);
    ASSERT_EQ(butNotIn(whole, followed), "") << "missing, step " << step;
    ASSERT_EQ(butNotIn(followed, whole), "") << "too many, step " << step;
    ASSERT_EQ(by_change.record.late, anew.record.late) << "step " << step;
    ASSERT_EQ(by_change.record.outputs, anew.record.outputs) << "step " << step;
    ASSERT_EQ(by_change.record.excluded, anew.record.excluded) << "step " << step;
    excluded_ = anew.record.excluded.size();
  }
  std::size_t followed() const { return followed_; }
  /// Types that statements ruled out when the last comparison was made.
  std::size_t excluded() const { return excluded_; }
  Environment& environment() { return *environment_; }
  NoteSink sink;

 private:
  std::size_t below(std::size_t end) { return random_() % end; }

  /// States or withdraws a fact of the universe, or one that was inferred some time.
  void toggle(const QuadReader& reader, QuadWriter& writer) {
    const bool is_inferred = below(6) == 0;
    if (is_inferred) rememberInferred(reader);
    const auto& facts = is_inferred || (below(6) == 0 && !inferred_.empty()) ? inferred_ : universe_.facts();
    if (facts.empty()) return;
    const auto& fact = facts[below(facts.size())];
    const std::string_view any =
        below(4) == 0 || &facts == &inferred_ ? vocabulary::kGraphOperator : vocabulary::kGraphObserved;
    const Term graph = Term::iri(std::string(Universe::graphOf(fact).value_or(any)));
    const QuadIds quad{writer.intern(fact[0]), writer.intern(fact[1]), writer.intern(fact[2]), writer.intern(graph)};
    reader.contains(quad) ? writer.remove(quad) : writer.add(quad);
    writer.flush();
  }
  void rememberInferred(const QuadReader& reader) {
    const auto graph = reader.idOf(Term::iri(vocabulary::kGraphInferred));
    QuadCursor cursor = reader.scan({.s = {}, .p = {}, .o = {}, .g = *graph});
    std::vector<QuadIds> quads;
    const auto axioms = SchemaWords(reader);
    const bool with_derivations = below(10) == 0;
    for (QuadIds quad; cursor.next(quad);) {
      const bool is_derivation = reader.viewOf(quad.s).text.find("/derivation/") != std::string_view::npos;
      if (!axioms.isAxiom(quad.p, quad.o) && (with_derivations || !is_derivation)) quads.push_back(quad);
    }
    if (quads.empty()) return;
    const QuadIds quad = quads[below(quads.size())];
    inferred_.push_back({reader.termOf(quad.s), reader.termOf(quad.p), reader.termOf(quad.o)});
  }

  Inferred inferred(WriteTransaction& transaction) {
    const QuadReader reader(static_cast<const ReadTransaction&>(transaction));
    Inferred found;
    QuadCursor cursor =
        reader.scan({.s = {}, .p = {}, .o = {}, .g = *reader.idOf(Term::iri(vocabulary::kGraphInferred))});
    for (QuadIds quad; cursor.next(quad);) found.quads.push_back(quad);
    const auto record = storedInferenceRecord(transaction, rules_, sumWithout(transaction, kNoGraph));
    EXPECT_TRUE(record) << "the record does not fit the store";
    if (record) found.record = *record;
    return found;
  }
  static std::set<std::string> textOf(const WriteTransaction& transaction, const std::vector<QuadIds>& quads) {
    const QuadReader reader(static_cast<const ReadTransaction&>(transaction));
    std::set<std::string> texts;
    for (const QuadIds& quad : quads)
      texts.insert(toNTriples(reader.termOf(quad.s)) + " " + toNTriples(reader.termOf(quad.p)) + " " +
                   toNTriples(reader.termOf(quad.o)));
    return texts;
  }

  static std::string butNotIn(const std::set<std::string>& some, const std::set<std::string>& others) {
    std::string text;
    for (const std::string& line : some)
      if (!others.contains(line)) text += line + "\n";
    return text;
  }

  std::mt19937 random_;
  std::vector<NamedText> rules_;
  Universe universe_;
  std::shared_ptr<Environment> environment_ = Environment::temporary();
  std::vector<std::array<Term, 3>> inferred_;
  std::size_t followed_ = 0, excluded_ = 0;
};

inline int stepsOf(int few, int many) {
  return std::getenv("CLUXEL_LONG_TESTS") != nullptr ? many : few;
}

/// Compares after each of many changes, of which at least a quarter must not be inferred anew.
inline void expectFollowed(ChangingStore& store) {
  const int steps = stepsOf(40, 600);
  for (int step = 0; step < steps && !testing::Test::HasFatalFailure(); ++step) {
    store.step();
    store.expectInferenceFromScratch(step);
  }
  EXPECT_GT(store.followed(), static_cast<std::size_t>(steps) / 4) << testing::PrintToString(store.sink.notes);
}

}  // namespace cluxel::mapping
