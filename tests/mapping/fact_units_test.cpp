// SPDX-License-Identifier: Apache-2.0
// Facts that follow from what they followed from are kept, and the graph is that of all facts written anew.
#include "mapping/facts/fact_units.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <random>
#include <set>

#include "mapping/facts/fact_sink.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::mapping {
namespace {

constexpr std::string_view kGraph = rdf::vocabulary::kGraphObserved;
using Names = std::set<std::string>;

/// What the facts of a resource say.
struct Resource {
  std::map<std::string, double> heights;  ///< by subject
  Names near;                             ///< of the first subject
  bool operator==(const Resource&) const = default;
};
using Resources = std::map<std::string, Resource>;

struct World {
  Resources resources;
  std::map<std::string, double> others;         ///< heights by subject
  std::map<std::string, std::string> added_to;  ///< labels by resource, given outside of its units
};

ContentHash hashOf(const std::string& text) {
  return ContentHasher().addText(text).finish();
}

ContentHash causeOf(const std::map<std::string, double>& heights) {
  ContentHasher hasher;
  for (const auto& [subject, number] : heights) hasher.addText(subject).add(number);
  return hasher.finish();
}

ContentHash causeOf(const Names& names) {
  ContentHasher hasher;
  for (const std::string& name : names) hasher.addText(name);
  return hasher.finish();
}

class FactUnits : public testing::Test {
 protected:
  /// Gives the units of a resource; returns the names of those that had to be computed: "a", "a near".
  static Names give(const std::string& name, const Resource& resource, FactSink& facts) {
    Names computed;
    if (facts.beginUnit({hashOf(name), Facet::Self}, causeOf(resource.heights))) {
      computed.insert(name);
      for (const auto& [subject, number] : resource.heights)
        facts.number(facts.iri("urn:" + subject), "height", number);
      facts.endUnit();
    }
    if (resource.near.empty()) {
      facts.removeUnit({hashOf(name), Facet::Relations});
    } else if (facts.beginUnit({hashOf(name), Facet::Relations}, causeOf(resource.near))) {
      computed.insert(name + " near");
      for (const std::string& other : resource.near)
        facts.link(facts.iri("urn:" + name), "near", facts.iri("urn:" + other));
      facts.endUnit();
    }
    return computed;
  }

  static void giveOthers(const World& world, FactSink& facts) {
    for (const auto& [subject, number] : world.others) facts.number(facts.iri("urn:" + subject), "height", number);
    for (const auto& [name, label] : world.added_to) facts.text(facts.iri("urn:" + name), "label", label);
  }

  /// Makes the graph hold the facts of a world; returns the units that had to be computed.
  Names write(const World& world) {
    FactSink facts(transaction_, kGraph);
    for (const auto& [name, label] : world.added_to) facts.addToUnits(hashOf(name));
    Names computed;
    for (const auto& [name, resource] : world.resources) computed.merge(give(name, resource, facts));
    giveOthers(world, facts);
    change_ = facts.finish();
    return computed;
  }

  /// The same after a change of some resources and of nothing else but the others.
  Names writeSome(const World& world, const Names& changed, bool with_others) {
    FactSink facts(transaction_, kGraph, FactsOf::SomeUnits);
    Names asked = changed, computed;
    if (with_others) {
      for (const auto& [name, label] : world.added_to) facts.addToUnits(hashOf(name)), asked.insert(name);
      for (const std::string& name : once_added_to_) asked.insert(name);
      facts.replaceOthers();
      giveOthers(world, facts);
    }
    for (const std::string& name : asked) {
      if (const auto found = world.resources.find(name); found != world.resources.end()) {
        computed.merge(give(name, found->second, facts));
        continue;
      }
      for (const Facet facet : {Facet::Self, Facet::Relations}) facts.removeUnit({hashOf(name), facet});
    }
    change_ = facts.finish();
    return computed;
  }

  Names graph() const {
    Names lines;
    const rdf::QuadReader quads = reader();
    for (const rdf::QuadIds& quad : quadsOfGraph()) {
      const std::string property = quads.termOf(quad.p).text;
      lines.insert(quads.termOf(quad.s).text + " " + property.substr(property.rfind('#') + 1) + " " +
                   quads.termOf(quad.o).text);
    }
    return lines;
  }
  std::vector<rdf::QuadIds> quadsOfGraph() const {
    std::vector<rdf::QuadIds> all;
    const rdf::QuadReader quads = reader();
    const auto id = quads.idOf(Term::iri(kGraph));
    if (!id) return all;
    rdf::QuadCursor cursor = quads.scan({.s = {}, .p = {}, .o = {}, .g = *id});
    for (rdf::QuadIds quad; cursor.next(quad);) all.push_back(quad);
    std::sort(all.begin(), all.end());
    return all;
  }
  rdf::QuadReader reader() const { return rdf::QuadReader(static_cast<const rdf::ReadTransaction&>(transaction_)); }

  std::shared_ptr<rdf::Environment> environment_ = rdf::Environment::temporary();
  rdf::WriteTransaction transaction_ = environment_->write();
  FactChange change_;
  Names once_added_to_;
};

Names linesOf(const World& world) {
  Names lines;
  const auto addHeights = [&](const std::map<std::string, double>& heights) {
    for (const auto& [subject, number] : heights) lines.insert("urn:" + subject + " height " + decimalText(number, 3));
  };
  for (const auto& [name, resource] : world.resources) {
    addHeights(resource.heights);
    for (const std::string& other : resource.near) lines.insert("urn:" + name + " near urn:" + other);
  }
  addHeights(world.others);
  for (const auto& [name, label] : world.added_to) lines.insert("urn:" + name + " label " + label);
  return lines;
}

TEST_F(FactUnits, AreComputedAgainOnlyWhereTheirCauseChanged) {
  World world{
      {{"a", {{{"a", 1}, {"a/box", 2}}, {"b"}}}, {"b", {{{"b", 3}}, {}}}, {"c", {{{"c", 4}}, {}}}}, {{"map", 5}}, {}};
  EXPECT_EQ(write(world), (Names{"a", "a near", "b", "c"}));
  EXPECT_EQ(write(world), Names{});
  EXPECT_EQ(graph(), linesOf(world));
  world.resources["a"].heights = {{"a", 1}};
  world.resources.erase("b");
  world.resources["d"] = {{{"d", 6}}, {}};
  world.others = {{"origin", 7}};
  EXPECT_EQ(write(world), (Names{"a", "d"})) << "a has lost a subject, b is gone";
  EXPECT_EQ(graph(), linesOf(world));
}

TEST_F(FactUnits, OfRelationsChangeApartFromOthersOfTheirSubject) {
  World world{{{"a", {{{"a", 1}}, {"b", "c"}}}, {"b", {{{"b", 3}}, {"a"}}}}, {}, {}};
  write(world);
  world.resources["a"].near = {"c"};
  EXPECT_EQ(write(world), Names{"a near"});
  EXPECT_EQ(graph(), linesOf(world));
  EXPECT_EQ(change_.removed.size(), 1U);
  EXPECT_TRUE(change_.added.empty());
  world.resources["a"].heights["a"] = 2;
  world.resources["b"].near.clear();
  EXPECT_EQ(write(world), Names{"a"});
  EXPECT_EQ(graph(), linesOf(world));
}

TEST_F(FactUnits, ThatOtherFactsAddToAreAlwaysComputed) {
  World world{{{"a", {{{"a", 1}}, {}}}, {"b", {{{"b", 2}}, {}}}}, {}, {}};
  write(world);
  world.added_to["a"] = "a";
  EXPECT_EQ(write(world), Names{"a"});
  EXPECT_EQ(graph(), linesOf(world));
  world.added_to.clear();
  EXPECT_EQ(write(world), Names{"a"}) << "what was added is taken away";
  EXPECT_EQ(graph(), linesOf(world));
}

TEST_F(FactUnits, OfAGraphThatOthersHaveChangedAreNotBelieved) {
  const World world{{{"a", {{{"a", 1}}, {"b"}}}}, {}, {}};
  write(world);
  rdf::QuadWriter writer(transaction_);
  writer.add(Quad{Term::iri("urn:x"), Term::iri("urn:p"), Term::literal("y"), Term::iri(kGraph)});
  writer.flush();
  EXPECT_THROW(FactSink(transaction_, kGraph, FactsOf::SomeUnits), std::logic_error);
  EXPECT_EQ(write(world), (Names{"a", "a near"}));
  EXPECT_EQ(graph(), linesOf(world));
}

TEST_F(FactUnits, ThatAreNotAskedStayWhenSomeAreReplaced) {
  EXPECT_THROW(FactSink(transaction_, kGraph, FactsOf::SomeUnits), std::logic_error) << "there are none yet";
  World world{{{"a", {{{"a", 1}}, {"b"}}}, {"b", {{{"b", 2}}, {"a"}}}}, {{"map", 5}}, {}};
  write(world);
  world.resources.erase("a");
  world.resources["b"].near.clear();
  EXPECT_EQ(writeSome(world, {"a", "b"}, false), Names{});
  EXPECT_EQ(graph(), linesOf(world));
  FactSink facts(transaction_, kGraph, FactsOf::SomeUnits);
  facts.number(facts.iri("urn:map"), "height", 6);
  EXPECT_THROW(facts.finish(), std::logic_error) << "others were not asked for";
}

class RandomFacts : public FactUnits {
 protected:
  /// Changes a resource at random.
  void change(const std::string& name) {
    Resource resource;
    for (unsigned part = 0; part < 1 + random_() % 3; ++part)
      resource.heights[part == 0 ? name : name + "/" + std::to_string(part)] = static_cast<double>(random_() % 2);
    for (unsigned i = 0; i < random_() % 3; ++i) resource.near.insert("u" + std::to_string(random_() % 4));
    if (random_() % 4 == 0)
      world_.resources.erase(name);
    else
      world_.resources[name] = resource;
  }
  void changeOthers() {
    for (const auto& [name, label] : world_.added_to) once_added_to_.insert(name);
    world_.others = {{"map", random_() % 3}, {"cloud " + std::to_string(random_() % 3), 1}};
    world_.added_to.clear();
    for (const auto& [name, resource] : world_.resources)
      if (random_() % 5 == 0) world_.added_to[name] = name;
  }

  std::mt19937 random_{3};
  World world_;
};

TEST_F(RandomFacts, GiveTheGraphOfAllFactsAndTheirChange) {
  std::size_t kept = 0;
  for (int round = 0; round < 200; ++round) {
    const std::vector<rdf::QuadIds> before = quadsOfGraph();
    const bool is_whole = round == 0 || random_() % 4 == 0, with_others = is_whole || random_() % 2 == 0;
    Names changed;
    for (unsigned i = 0; i < random_() % 6; ++i) {
      const std::string name = "u" + std::to_string(random_() % 12);
      if (!with_others && world_.added_to.contains(name)) continue;
      change(name);
      changed.insert(name);
    }
    if (with_others) changeOthers();
    const std::size_t units = 2 * world_.resources.size();
    kept += units - (is_whole ? write(world_) : writeSome(world_, changed, with_others)).size();
    once_added_to_.clear();
    const std::vector<rdf::QuadIds> after = quadsOfGraph();
    ASSERT_EQ(graph(), linesOf(world_)) << "round " << round;
    FactChange expected;
    std::set_difference(before.begin(), before.end(), after.begin(), after.end(), std::back_inserter(expected.removed));
    std::set_difference(after.begin(), after.end(), before.begin(), before.end(), std::back_inserter(expected.added));
    ASSERT_EQ(change_.added, expected.added) << "round " << round;
    ASSERT_EQ(change_.removed, expected.removed) << "round " << round;
  }
  EXPECT_GT(kept, 200U);
}

}  // namespace
}  // namespace cluxel::mapping
