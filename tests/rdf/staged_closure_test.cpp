// SPDX-License-Identifier: Apache-2.0
// Following changes through a closure gives the stages that closures from scratch give.
#include "rdf/ontology/staged_closure.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>
#include <string>

#include "rdf/ontology/ontology.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::rdf {

namespace {

using namespace vocabulary;

const std::string kOwlName(kOwl);
constexpr Stage kStages = 3;

/// Things, properties and kinds, with axioms that make some properties transitive, symmetric or inverse.
class SmallWorld {
 public:
  explicit SmallWorld(unsigned seed)
      : random_(seed), environment_(Environment::temporary()), write_(environment_->write()) {
    QuadWriter writer(write_);
    observed_ = writer.intern(Term::iri(kGraphObserved));
    inferred_ = writer.intern(Term::iri(kGraphInferred));
    ontology_ = writer.intern(Term::iri(kGraphOntology));
    type_ = writer.intern(Term::iri(vocabulary::rdf("type")));
    for (const char* name : {"SymmetricProperty", "TransitiveProperty"}) writer.intern(Term::iri(kOwlName + name));
    for (int i = 0; i < 5; ++i) {
      properties_.push_back(writer.intern(Term::iri("http://x/p" + std::to_string(i))));
      kinds_.push_back(writer.intern(Term::iri("http://x/k" + std::to_string(i))));
    }
    for (int i = 0; i < 9; ++i) things_.push_back(writer.intern(Term::iri("http://x/t" + std::to_string(i))));
    things_.push_back(writer.intern(Term::literal("a text")));
    for (int i = 0; i < 7; ++i) writer.add(axiom(writer));
    writer.flush();
  }

  Triple fact() {
    const TermId subject = things_[below(things_.size() - 1)];
    if (below(4) == 0) return {subject, type_, kinds_[below(kinds_.size())]};
    return {subject, properties_[below(properties_.size())], things_[below(things_.size())]};
  }
  std::size_t below(std::size_t end) { return random_() % end; }

  /// States facts or withdraws them, gives bases to others or takes them away, and follows the change.
  void change() {
    const QuadReader reader(static_cast<const ReadTransaction&>(write_));
    const SchemaWords words(reader);
    ClosureBounds bounds(reader, ClosureLimits::of(reader));
    const std::vector<TermId> graphs{ontology_, observed_};
    const std::vector<TermId> all{ontology_, observed_, inferred_};
    const Schema schema = readStoredSchema(reader, words, all, bounds);
    QuadWriter writer(write_);
    std::map<Triple, bool> stated_before;
    for (std::size_t left = below(4); left > 0; --left) {
      const Triple fact = this->fact();
      const bool was = stated_.contains(fact);
      stated_before.emplace(fact, was);
      const QuadIds quad{fact.s, fact.p, fact.o, observed_};
      was ? writer.remove(quad) : writer.add(quad);
      if (was)
        stated_.erase(fact);
      else
        stated_.insert(fact);
    }
    writer.flush();
    StagedFacts facts(reader, words, graphs, inferred_, late_);
    std::vector<BaseChange> changes;
    for (const auto& [fact, was] : stated_before) {
      if (was == stated_.contains(fact)) continue;
      facts.restate(fact, was);
      bases_.erase(fact);
      changes.push_back({fact, was ? kNever : 0});
    }
    StagedClosure closure(reader, words, schema, facts, bounds);
    closure.update(changes);
    for (std::size_t left = below(4); left > 0; --left) {
      changes.clear();
      const Triple fact = this->fact();
      if (stated_.contains(fact)) continue;
      const Stage base = below(2) == 0 ? kNever : 1 + static_cast<Stage>(below(kStages));
      bases_.erase(fact);
      if (base != kNever) bases_[fact] = base;
      changes.push_back({fact, base});
      closure.update(changes);
    }
    EXPECT_FALSE(facts.touchesSchema());
    // A fact that is known earlier than its base has none, as rules derive only new facts.
    std::erase_if(bases_, [&](const auto& base) { return facts.stageOf(base.first) < base.second; });
    facts.write(writer);
    late_ = facts.lateNow();
  }

  std::map<Triple, Stage> stages() {
    const QuadReader reader(static_cast<const ReadTransaction&>(write_));
    std::map<Triple, Stage> stages;
    QuadCursor cursor = reader.scan({.s = {}, .p = {}, .o = {}, .g = inferred_});
    for (QuadIds quad; cursor.next(quad);) stages[{quad.s, quad.p, quad.o}] = 0;
    for (const LateFact& late : late_) {
      EXPECT_TRUE(stages.contains(late.fact));
      stages[late.fact] = late.stage;
    }
    for (const Triple& fact : stated_) EXPECT_FALSE(stages.contains(fact)) << "a stated fact is inferred";
    return stages;
  }

  /// By closures of what is known without it up to each stage.
  std::map<Triple, Stage> stagesFromScratch() {
    std::map<Triple, Stage> stages;
    const QuadReader reader(static_cast<const ReadTransaction&>(write_));
    QuadWriter writer(write_);
    const TermId scratch = writer.intern(Term::iri("http://x/scratch"));
    const std::vector<TermId> graphs{ontology_, observed_, scratch};
    for (Stage stage = 0; stage <= kStages; ++stage) {
      for (const auto& [fact, base] : bases_)
        if (base == stage) writer.add(QuadIds{fact.s, fact.p, fact.o, scratch}), stages.emplace(fact, stage);
      writer.flush();
      for (const QuadIds& quad : closureOf(reader, inferred_, graphs, ClosureLimits::of(reader)).quads)
        stages.emplace(Triple{quad.s, quad.p, quad.o}, stage);
    }
    writer.clearGraph(scratch);
    writer.flush();
    return stages;
  }

  void inferFirst() { inferClosure(write_); }

 private:
  QuadIds axiom(QuadWriter& writer) {
    const auto iri = [&](const std::string& name) { return writer.intern(Term::iri(name)); };
    const auto property = [&] { return properties_[below(properties_.size())]; };
    switch (below(6)) {
      case 0:
      case 1:
        return {kinds_[below(kinds_.size())], iri(rdfs("subClassOf")), kinds_[below(kinds_.size())], ontology_};
      case 2:
        return {property(), iri(kOwlName + "inverseOf"), property(), ontology_};
      case 3:
        return {property(), type_, iri(kOwlName + "SymmetricProperty"), ontology_};
      case 4:
        return {property(), type_, iri(kOwlName + "TransitiveProperty"), ontology_};
      default:
        return {property(), iri(rdfs("subPropertyOf")), property(), ontology_};
    }
  }

  std::mt19937 random_;
  std::shared_ptr<Environment> environment_;
  WriteTransaction write_;
  TermId observed_ = 0, inferred_ = 0, ontology_ = 0, type_ = 0;
  std::vector<TermId> properties_, kinds_, things_;
  std::set<Triple> stated_;
  std::map<Triple, Stage> bases_;
  std::vector<LateFact> late_;
};

TEST(StagedClosure, FollowsRandomChangesAsClosuresFromScratchDo) {
  std::size_t late = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    SmallWorld world(seed);
    world.inferFirst();
    for (int step = 0; step < 40; ++step) {
      world.change();
      const auto stages = world.stages();
      ASSERT_EQ(stages, world.stagesFromScratch()) << "seed " << seed << ", step " << step;
      for (const auto& [fact, stage] : stages) late += stage > 0 ? 1 : 0;
    }
  }
  EXPECT_GT(late, 10'000U) << "the worlds must have facts of later stages";
}

TEST(StagedClosure, ACycleFallsWithItsOnlySupport) {
  const auto environment = Environment::temporary();
  WriteTransaction transaction = environment->write();
  QuadWriter writer(transaction);
  const auto iri = [&](const std::string& name) { return writer.intern(Term::iri(name)); };
  const TermId ontology = iri(std::string(kGraphOntology)), observed = iri(std::string(kGraphObserved));
  const TermId inferred = iri(std::string(kGraphInferred));
  const TermId within = iri("http://x/within"), beside = iri("http://x/beside");
  writer.add(QuadIds{within, iri(vocabulary::rdf("type")), iri(kOwlName + "TransitiveProperty"), ontology});
  writer.add(QuadIds{within, iri(vocabulary::rdf("type")), iri(kOwlName + "SymmetricProperty"), ontology});
  writer.add(QuadIds{beside, iri(rdfs("subPropertyOf")), within, ontology});
  const TermId a = iri("http://x/a"), b = iri("http://x/b");
  const QuadIds support{a, beside, b, observed};
  writer.add(support);
  writer.flush();
  EXPECT_EQ(inferClosure(transaction).added, 4U) << "within: a b, b a, a a, b b";
  writer.remove(support);
  writer.flush();
  const QuadReader reader(static_cast<const ReadTransaction&>(transaction));
  const SchemaWords words(reader);
  ClosureBounds bounds(reader, ClosureLimits::of(reader));
  const std::vector<TermId> all{ontology, observed, inferred};
  const Schema schema = readStoredSchema(reader, words, all, bounds);
  StagedFacts facts(reader, words, {ontology, observed}, inferred, {});
  const Triple fact{a, beside, b};
  facts.restate(fact, true);
  const std::vector<BaseChange> changes{{fact, kNever}};
  StagedClosure(reader, words, schema, facts, bounds).update(changes);
  facts.write(writer);
  EXPECT_EQ(reader.count({.s = {}, .p = {}, .o = {}, .g = inferred}), 0U);
}

}  // namespace
}  // namespace cluxel::rdf
