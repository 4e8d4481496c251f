// SPDX-License-Identifier: Apache-2.0
// Terms of every kind keep their ids and values, for all readers of a commit.
#include <gtest/gtest.h>

#include <array>
#include <set>

#include "base/parallel.hpp"
#include "rdf/file/environment.hpp"
#include "rdf/store/quad_store.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::rdf {
namespace {

/// A store with terms of every kind and literals of every value type.
std::vector<Term> variedTerms() {
  using vocabulary::xsd;
  std::vector<Term> terms = {Term::iri("http://a"),
                             Term::blank("b"),
                             Term::literal(""),
                             Term::literal("x"),
                             Term::langLiteral("x", "en"),
                             Term::langLiteral("x", "de"),
                             Term::literal("x", "http://t"),
                             Term::literal(std::string(200'000, 'l')),
                             Term::literal(std::string("a\0b", 3)),
                             Term::literal("1", xsd("integer")),
                             Term::literal("01", xsd("integer")),
                             Term::literal("1", xsd("int")),
                             Term::literal("1", xsd("decimal"))};
  for (int i = 0; i < 3000; ++i) terms.push_back(Term::integer(i * 7919));
  return terms;
}

TEST(StoredTerms, GivesBackEveryTermAndFindsItsIdAgain) {
  const std::vector<Term> terms = variedTerms();
  auto environment = Environment::temporary();
  std::vector<TermId> ids;
  for (std::size_t part = 0; part < 2; ++part) {  // the second time they are all there
    WriteTransaction transaction = environment->write();
    QuadWriter writer(transaction);
    std::vector<TermId> given;
    for (const Term& term : terms) given.push_back(writer.intern(term));
    writer.flush();
    for (std::size_t i = 0; i < terms.size(); ++i) ASSERT_EQ(QuadReader(transaction).termOf(given[i]), terms[i]);
    if (part == 0) ids = given;
    EXPECT_EQ(given, ids);
    transaction.commit();
  }
  const QuadReader reader(environment->read());
  EXPECT_EQ(std::set<TermId>(ids.begin(), ids.end()).size(), terms.size());
  for (std::size_t i = 0; i < terms.size(); ++i) {
    ASSERT_EQ(reader.idOf(terms[i]), ids[i]);
    ASSERT_EQ(reader.termOf(ids[i]), terms[i]);
    ASSERT_EQ(reader.viewOf(ids[i]).toTerm(), terms[i]);
  }
  EXPECT_EQ(reader.idOf(Term::literal("absent")), std::nullopt);
  EXPECT_EQ(reader.idOf(Term::literal("1", "http://absent")), std::nullopt);
  EXPECT_EQ(reader.idOf(Term::iri("")), kNoTerm) << "the unnamed graph";
}

TEST(StoredTerms, ForgetsTermsOfATransactionThatWasNotCommitted) {
  auto environment = Environment::temporary();
  const auto intern = [&](const Term& term, bool commit) {
    WriteTransaction transaction = environment->write();
    QuadWriter writer(transaction);
    const TermId id = writer.intern(term);
    writer.flush();
    EXPECT_EQ(QuadReader(transaction).valueOf(id).integer, std::stoi(term.text));
    if (commit) transaction.commit();
    return id;
  };
  intern(Term::integer(1), true);
  const TermId dropped = intern(Term::integer(2), false);
  EXPECT_EQ(intern(Term::integer(3), true), dropped) << "the number is given again";
  EXPECT_EQ(QuadReader(environment->read()).valueOf(dropped).integer, 3);
}

TEST(StoredTerms, SharesOneCommitAmongReadersOfManyThreads) {
  auto environment = Environment::temporary();
  {
    WriteTransaction transaction = environment->write();
    QuadWriter writer(transaction);
    for (const Term& term : variedTerms()) {
      const TermId id = writer.intern(term);
      writer.add(QuadIds{id, 1 + id % 5, id, id % 3});
    }
    writer.flush();
    transaction.commit();
  }
  std::array<std::uint64_t, 4> sums{};
  parallelFor(sums.size(), 4, [&](std::size_t i) {
    const QuadReader reader(environment->read());
    PrefixLookup lookup = reader.lookup(QuadOrder::Ospg);
    for (TermId id = 1; id <= reader.termCount(); ++id) {
      sums[i] += static_cast<std::uint64_t>(reader.valueOf(id).integer) + reader.viewOf(id).text.size();
      sums[i] += lookup.find(std::array{id}).size();
    }
    sums[i] += reader.statistics(2).subjects + reader.graphs().size();
  });
  EXPECT_EQ(std::set<std::uint64_t>(sums.begin(), sums.end()).size(), 1U);
}

TEST(StoredTerms, FindsTheQuadsOfANumberWhileOtherThreadsCollectTheSameQuads) {
  constexpr std::size_t kCommits = 10, kQuads = 20'000;
  auto environment = Environment::temporary();
  TermId subject = 10;
  for (std::size_t commit = 1; commit <= kCommits; ++commit) {
    WriteTransaction transaction = environment->write();
    QuadWriter writer(transaction);
    const TermId predicate = writer.intern(Term::iri("http://p")), number = writer.intern(Term::integer(7));
    for (std::size_t i = 0; i < kQuads; ++i) writer.add(QuadIds{subject++, predicate, number, 0});
    writer.flush();
    transaction.commit();
    std::array<std::size_t, 4> found{};
    parallelFor(found.size(), 4, [&](std::size_t i) {
      found[i] = QuadReader(environment->read()).lookup(QuadOrder::Ospg).find(std::array{number}).size();
    });
    for (const std::size_t quads : found) ASSERT_EQ(quads, commit * kQuads);
  }
}

}  // namespace
}  // namespace cluxel::rdf
