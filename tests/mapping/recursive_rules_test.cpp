// SPDX-License-Identifier: Apache-2.0
// Rules that read what they derive follow a change to the facts of inference from scratch.
#include <algorithm>

#include "mapping/changing_store.hpp"
#include "mapping/inference/rule_shape.hpp"
#include "mapping/rules_of_shapes.hpp"

namespace cluxel::mapping {
namespace {

/// Each alone, and all in two orders: what one derives others read.
TEST(RecursiveRules, AreInferenceFromScratch) {
  std::vector<std::vector<NamedText>> sets{recursiveRules(), recursiveRules()};
  std::reverse(sets[1].begin(), sets[1].end());
  for (const NamedText& alone : recursiveRules()) sets.push_back({alone});
  unsigned seed = 70;
  for (const auto& rules : sets) {
    SCOPED_TRACE(rules.front().name);
    ChangingStore store(seed++, rules);
    expectFollowed(store);
    EXPECT_TRUE(store.sink.notes.empty()) << store.sink.notes.front();
  }
}

/// A store of a few facts about things of the vocabulary.
class FewFacts {
 public:
  explicit FewFacts(std::vector<NamedText> rules) : rules_(std::move(rules)), transaction_(environment_->write()) {}

  void add(const std::string& subject, const std::string& property, const std::string& object) {
    QuadWriter writer(transaction_);
    writer.add(Quad{term(subject), term(property), term(object), graph_});
    writer.flush();
  }
  void remove(const std::string& subject, const std::string& property, const std::string& object) {
    const QuadReader reader = this->reader();
    QuadWriter writer(transaction_);
    writer.remove(
        {*reader.idOf(term(subject)), *reader.idOf(term(property)), *reader.idOf(term(object)), *reader.idOf(graph_)});
    writer.flush();
  }
  void inferAnew() { mapping::inferAnew(transaction_, rules_, silence()); }
  bool inferChanges() { return mapping::inferChanges(transaction_, rules_, silence()).has_value(); }
  /// How many facts of the property are inferred.
  std::size_t count(const std::string& property) const {
    const QuadReader reader = this->reader();
    QuadCursor cursor = reader.scan({.s = {},
                                     .p = *reader.idOf(term(property)),
                                     .o = {},
                                     .g = *reader.idOf(Term::iri(vocabulary::kGraphInferred))});
    std::size_t count = 0;
    for (QuadIds quad; cursor.next(quad);) ++count;
    return count;
  }

 private:
  static Term term(const std::string& name) {
    return Term::iri(name.find(':') == std::string::npos ? vocabulary::clx(name) : name);
  }
  QuadReader reader() const { return QuadReader(static_cast<const ReadTransaction&>(transaction_)); }

  std::vector<NamedText> rules_;
  const Term graph_ = Term::iri(vocabulary::kGraphObserved);
  std::shared_ptr<Environment> environment_ = Environment::temporary();
  WriteTransaction transaction_;
};

/// Marks go along a ring and keep each other up, until the only one that is stated is withdrawn.
TEST(RecursiveRules, ARingOfDerivedFactsFallsWithItsOnlySupport) {
  FewFacts facts(
      {rule("mark.rq", "CONSTRUCT { ?b clx:is clx:Marked } WHERE { ?b clx:after ?a . ?a clx:is clx:Marked }")});
  for (int i = 0; i < 5; ++i) facts.add("t" + std::to_string((i + 1) % 5), "after", "t" + std::to_string(i));
  facts.add("t2", "is", "Marked");
  facts.inferAnew();
  EXPECT_EQ(facts.count("is"), 4U);
  facts.remove("t2", "is", "Marked");
  ASSERT_TRUE(facts.inferChanges()) << "inferred anew";
  EXPECT_EQ(facts.count("is"), 0U);
  facts.add("t2", "is", "Marked");
  ASSERT_TRUE(facts.inferChanges()) << "inferred anew";
  EXPECT_EQ(facts.count("is"), 4U);
}

/// The rule derives "a has b" from "a has c". The closure derives "a has c" from "a has b", because "has" is
/// transitive. So the two facts support each other, and only the seed supports both. The rule never reads "a has b"
/// itself.
TEST(RecursiveRules, ARingThroughTheClosureFallsWithItsOnlySupport) {
  FewFacts facts({rule("ring.rq",
                       "CONSTRUCT { ?x ?p ?y } WHERE { { ?k clx:seed ?x . ?k clx:to ?y BIND(clx:owns AS ?p) } UNION "
                       "{ ?k clx:loop ?x . ?k clx:back ?y . ?x clx:has clx:c BIND(clx:has AS ?p) } }")});
  facts.add("owns", vocabulary::rdfs("subPropertyOf"), "has");
  facts.add("has", vocabulary::rdf("type"), "http://www.w3.org/2002/07/owl#TransitiveProperty");
  facts.add("b", "has", "c");
  facts.add("k1", "seed", "a"), facts.add("k1", "to", "b");
  facts.add("k2", "loop", "a"), facts.add("k2", "back", "b");
  facts.inferAnew();
  EXPECT_EQ(facts.count("has"), 2U);
  facts.remove("k1", "seed", "a");
  ASSERT_TRUE(facts.inferChanges()) << "inferred anew";
  EXPECT_EQ(facts.count("owns"), 0U);
  EXPECT_EQ(facts.count("has"), 0U);
}

/// Nothing was derived that the rule reads, until a mark that others rest on is withdrawn and derived instead.
TEST(RecursiveRules, WhatIsDerivedInsteadOfStatedIsReadOn) {
  FewFacts facts({rule("mark.rq",
                       "CONSTRUCT { ?b clx:is clx:Marked ; clx:has clx:Mark } WHERE { ?b clx:after ?a . ?a clx:is "
                       "clx:Marked }")});
  for (const auto& [later, earlier] : {std::pair("t1", "t0"), {"t2", "t1"}}) facts.add(later, "after", earlier);
  for (const std::string thing : {"t0", "t1", "t2"}) facts.add(thing, "is", "Marked");
  facts.inferAnew();
  EXPECT_EQ(facts.count("has"), 2U);
  facts.remove("t1", "is", "Marked");
  ASSERT_TRUE(facts.inferChanges()) << "inferred anew";
  EXPECT_EQ(facts.count("is"), 1U);
  EXPECT_EQ(facts.count("has"), 2U);
  facts.remove("t2", "is", "Marked");
  ASSERT_TRUE(facts.inferChanges()) << "inferred anew";
  EXPECT_EQ(facts.count("is"), 2U);
  EXPECT_EQ(facts.count("has"), 2U);
}

TEST(RecursiveRules, ThatExcludeWhatTheyDeriveAreNamedAndInferredAnew) {
  ChangingStore store(1, {rule("reach.rq",
                               "CONSTRUCT { ?a clx:reaches ?c } WHERE { ?a clx:near ?c "
                               "FILTER NOT EXISTS { ?a clx:reaches ?c . ?a clx:minX 3 } }")});
  for (int step = 0; step < 10; ++step) {
    store.step();
    store.expectInferenceFromScratch(step);
  }
  EXPECT_EQ(store.followed(), 0U);
  ASSERT_FALSE(store.sink.notes.empty());
  EXPECT_NE(store.sink.notes.front().find("reach.rq: it reads what it derives"), std::string::npos)
      << store.sink.notes.front();
}

}  // namespace
}  // namespace cluxel::mapping
