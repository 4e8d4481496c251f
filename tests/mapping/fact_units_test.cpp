// SPDX-License-Identifier: Apache-2.0
// Facts that follow from what they followed from are kept, and the graph is that of all facts written anew.
#include "mapping/facts/fact_units.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

#include "mapping/facts/fact_sink.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::mapping {
namespace {

constexpr std::string_view kGraph = rdf::vocabulary::kGraphObserved;

/// A unit's facts: numbers by the name of a subject.
using Numbers = std::map<std::string, double>;

ContentHash hashOf(const std::string& text) {
  return ContentHasher().addText(text).finish();
}

ContentHash causeOf(const Numbers& numbers) {
  ContentHasher hasher;
  for (const auto& [subject, number] : numbers) hasher.addText(subject).add(number);
  return hasher.finish();
}

class FactUnits : public testing::Test {
 protected:
  /// Makes the graph hold the facts of the units, of `others`, and of subjects of units; returns the names of the units
  /// whose facts had to be computed.
  std::set<std::string> write(const std::map<std::string, Numbers>& units, const Numbers& others = {},
                              const std::map<std::string, std::string>& added_to = {}) {
    std::set<std::string> computed;
    rdf::QuadWriter writer(transaction_);
    const rdf::TermId graph = writer.intern(Term::iri(kGraph));
    FactSink facts(writer, graph, storedFactUnits(transaction_, reader(), graph));
    for (const auto& [unit, subject] : added_to) facts.addToUnit(hashOf(unit));
    for (const auto& [unit, numbers] : units) {
      if (!facts.beginUnit(hashOf(unit), causeOf(numbers))) continue;
      computed.insert(unit);
      for (const auto& [subject, number] : numbers) facts.number(facts.iri("urn:" + subject), "height", number);
      facts.endUnit();
    }
    for (const auto& [subject, number] : others) facts.number(facts.iri("urn:" + subject), "height", number);
    for (const auto& [unit, subject] : added_to) facts.text(facts.iri("urn:" + subject), "label", unit);
    writer.flush();
    const std::vector<FactUnit> made = facts.writeTo(reader());
    writer.flush();
    storeFactUnits(transaction_, made, reader(), graph);
    return computed;
  }

  std::set<std::string> graph() const {
    std::set<std::string> lines;
    const rdf::QuadReader quads = reader();
    rdf::QuadCursor cursor = quads.scan({.s = {}, .p = {}, .o = {}, .g = quads.idOf(Term::iri(kGraph))});
    for (rdf::QuadIds quad; cursor.next(quad);)
      lines.insert(quads.termOf(quad.s).text + " " + quads.termOf(quad.o).text);
    return lines;
  }
  rdf::QuadReader reader() const { return rdf::QuadReader(static_cast<const rdf::ReadTransaction&>(transaction_)); }

  using Names = std::set<std::string>;
  std::shared_ptr<rdf::Environment> environment_ = rdf::Environment::temporary();
  rdf::WriteTransaction transaction_ = environment_->write();
};

TEST_F(FactUnits, AreComputedAgainOnlyWhereTheirCauseChanged) {
  EXPECT_EQ(write({{"a", {{"a", 1}, {"a/box", 2}}}, {"b", {{"b", 3}}}, {"c", {{"c", 4}}}}, {{"map", 5}}),
            (Names{"a", "b", "c"}));
  EXPECT_EQ(write({{"a", {{"a", 1}, {"a/box", 2}}}, {"b", {{"b", 3}}}, {"c", {{"c", 4}}}}, {{"map", 5}}), Names{});
  EXPECT_EQ(graph(), (Names{"urn:a 1.0", "urn:a/box 2.0", "urn:b 3.0", "urn:c 4.0", "urn:map 5.0"}));
  EXPECT_EQ(write({{"a", {{"a", 1}}}, {"c", {{"c", 4}}}, {"d", {{"d", 6}}}}, {{"origin", 7}}), (Names{"a", "d"}))
      << "a has lost a subject, b is gone";
  EXPECT_EQ(graph(), (Names{"urn:a 1.0", "urn:c 4.0", "urn:d 6.0", "urn:origin 7.0"}));
}

TEST_F(FactUnits, ThatOtherFactsAddToAreAlwaysComputed) {
  write({{"a", {{"a", 1}}}, {"b", {{"b", 2}}}});
  EXPECT_EQ(write({{"a", {{"a", 1}}}, {"b", {{"b", 2}}}}, {}, {{"a", "a"}}), Names{"a"});
  EXPECT_EQ(graph(), (Names{"urn:a 1.0", "urn:a a", "urn:b 2.0"}));
  EXPECT_EQ(write({{"a", {{"a", 1}}}, {"b", {{"b", 2}}}}), Names{"a"}) << "what was added is taken away";
  EXPECT_EQ(graph(), (Names{"urn:a 1.0", "urn:b 2.0"}));
}

TEST_F(FactUnits, OfAGraphThatOthersHaveChangedAreNotBelieved) {
  write({{"a", {{"a", 1}}}});
  rdf::QuadWriter writer(transaction_);
  writer.add(Quad{Term::iri("urn:x"), Term::iri("urn:p"), Term::literal("y"), Term::iri(kGraph)});
  writer.flush();
  EXPECT_EQ(write({{"a", {{"a", 1}}}}), Names{"a"});
  EXPECT_EQ(graph(), Names{"urn:a 1.0"});
}

TEST_F(FactUnits, GiveTheGraphOfAllFactsAfterRandomChanges) {
  std::mt19937 random(3);
  std::size_t kept = 0;
  for (int round = 0; round < 60; ++round) {
    std::map<std::string, Numbers> units;
    std::map<std::string, std::string> added_to;
    Names expected{"urn:map " + std::to_string(round % 3) + ".0"};
    for (int u = 0; u < 12; ++u) {
      const std::string name = "u" + std::to_string(u);
      if (random() % 4 == 0) continue;
      for (unsigned part = 0; part < 1 + random() % 3; ++part) {
        const auto number = random() % 2;
        units[name][name + "/" + std::to_string(part)] = static_cast<double>(number);
        expected.insert("urn:" + name + "/" + std::to_string(part) + " " + std::to_string(number) + ".0");
      }
      if (random() % 5 != 0) continue;
      added_to[name] = name + "/0";
      expected.insert("urn:" + name + "/0 " + name);
    }
    kept += units.size() - write(units, {{"map", round % 3}}, added_to).size();
    ASSERT_EQ(graph(), expected) << "round " << round;
  }
  EXPECT_GT(kept, 20U);
}

}  // namespace
}  // namespace cluxel::mapping
