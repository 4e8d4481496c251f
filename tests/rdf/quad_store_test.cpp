// SPDX-License-Identifier: Apache-2.0
// Compares the quad store with a std::set of quads.
#include "rdf/store/quad_store.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "rdf/file/environment.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::rdf {
namespace {

std::array<TermId, 4> inOrder(const QuadIds& quad, QuadOrder order) {
  const std::array<TermId, 4> ids = {quad.s, quad.p, quad.o, quad.g};
  std::array<TermId, 4> sorted{};
  for (std::size_t i = 0; i < 4; ++i) sorted[i] = ids[placesOf(order)[i]];
  return sorted;
}

bool matches(const QuadIds& quad, const QuadPattern& pattern) {
  return (!pattern.s || *pattern.s == quad.s) && (!pattern.p || *pattern.p == quad.p) &&
         (!pattern.o || *pattern.o == quad.o) && (!pattern.g || *pattern.g == quad.g);
}

/// The expected result of a scan, from a plain set.
std::vector<QuadIds> expected(const std::set<QuadIds>& quads, const QuadPattern& pattern, QuadOrder order) {
  std::vector<QuadIds> found;
  std::copy_if(quads.begin(), quads.end(), std::back_inserter(found),
               [&](const QuadIds& quad) { return matches(quad, pattern); });
  std::sort(found.begin(), found.end(),
            [&](const QuadIds& a, const QuadIds& b) { return inOrder(a, order) < inOrder(b, order); });
  return found;
}

std::vector<QuadIds> drain(QuadCursor cursor) {
  std::vector<QuadIds> found;
  for (QuadIds quad; cursor.next(quad);) found.push_back(quad);
  return found;
}

/// Predicates 6 and 7 have numbers only, if addTerms() made them.
QuadIds randomQuad(std::mt19937& random, TermId range) {
  const auto id = [&](TermId max) { return static_cast<TermId>(random() % max); };
  QuadIds quad{1 + id(range), 1 + id(7), 1 + id(range), id(3)};
  if (quad.p >= 6) quad.o = range < 20 ? 4 : 20 * (1 + quad.o % (range / 20));
  return quad;
}

QuadPattern patternOf(const QuadIds& quad, unsigned bound) {
  QuadPattern pattern;
  if ((bound & 1U) != 0) pattern.s = quad.s;
  if ((bound & 2U) != 0) pattern.p = quad.p;
  if ((bound & 4U) != 0) pattern.o = quad.o;
  if ((bound & 8U) != 0) pattern.g = quad.g;
  return pattern;
}

std::vector<QuadIds> drainInBulk(QuadCursor cursor, std::size_t at_once) {
  std::vector<QuadIds> found;
  std::vector<QuadIds> buffer(at_once);
  while (const std::size_t count = cursor.next(buffer))
    found.insert(found.end(), buffer.begin(), buffer.begin() + count);
  return found;
}

std::vector<QuadIds> drainBlocks(QuadCursor cursor, const QuadPattern& pattern) {
  std::vector<QuadIds> found;
  for (auto block = cursor.nextBlock(); !block.empty(); block = cursor.nextBlock())
    for (const QuadKey& key : block) {
      const QuadIds quad = toQuad(key, cursor.order());
      EXPECT_TRUE(cursor.filtered() || matches(quad, pattern));
      if (matches(quad, pattern)) found.push_back(quad);
    }
  return found;
}

/// Reads `quads` with a cursor that sometimes seeks forward.
void expectSeeksLikeASortedList(QuadCursor cursor, const std::vector<QuadIds>& quads, std::mt19937& random,
                                TermId range) {
  const QuadOrder order = cursor.order();
  std::size_t at = 0;
  for (QuadIds quad; true;) {
    if (random() % 3 == 0) {
      const QuadIds target = randomQuad(random, range);
      cursor.seek(target);
      while (at < quads.size() && inOrder(quads[at], order) < inOrder(target, order)) ++at;
    }
    const bool more = cursor.next(quad);
    ASSERT_EQ(more, at < quads.size());
    if (!more) return;
    ASSERT_EQ(quad, quads[at++]);
  }
}

void expectLookupsFindWhatScansFind(const QuadReader& reader, const std::set<QuadIds>& quads, std::mt19937& random,
                                    TermId range) {
  EXPECT_THROW(reader.lookup(QuadOrder::Psog), std::logic_error);
  for (const QuadOrder order : kQuadOrders) {
    if (order == QuadOrder::Psog) continue;
    PrefixLookup lookup = reader.lookup(order);
    const std::vector<QuadIds> all = expected(quads, {}, order);
    for (int i = 0; i < 20; ++i) {
      const std::array<TermId, 4> ids = inOrder(randomQuad(random, range), order);
      const std::size_t length = 1 + random() % 4;
      std::vector<QuadIds> found;
      for (auto keys = lookup.find(std::span(ids).first(length)); !keys.empty(); keys = lookup.more())
        for (const QuadKey& key : keys) found.push_back(toQuad(key, order));
      std::vector<QuadIds> expected_quads = all;
      std::erase_if(expected_quads, [&](const QuadIds& quad) {
        const auto other = inOrder(quad, order);
        return !std::equal(ids.begin(), ids.begin() + static_cast<std::ptrdiff_t>(length), other.begin());
      });
      ASSERT_EQ(found, expected_quads);
    }
  }
}

void expectSameAnswers(const QuadReader& reader, const std::set<QuadIds>& quads, std::mt19937& random, TermId range) {
  ASSERT_EQ(reader.size(), quads.size());
  for (unsigned bound = 0; bound < 16; ++bound) {
    const QuadPattern pattern = patternOf(randomQuad(random, range), bound);
    for (const QuadOrder order : kQuadOrders) {
      const std::vector<QuadIds> expected_quads = expected(quads, pattern, order);
      ASSERT_EQ(drain(reader.scan(pattern, order)), expected_quads) << bound;
      ASSERT_EQ(drainInBulk(reader.scan(pattern, order), 1 + random() % 300), expected_quads) << bound;
      ASSERT_EQ(drainBlocks(reader.scan(pattern, order), pattern), expected_quads) << bound;
      expectSeeksLikeASortedList(reader.scan(pattern, order), expected_quads, random, range);
    }
    ASSERT_EQ(reader.count(pattern), expected(quads, pattern, QuadOrder::Spog).size());
    const QuadIds probe = randomQuad(random, range);
    ASSERT_EQ(reader.contains(probe), quads.contains(probe));
  }
  expectLookupsFindWhatScansFind(reader, quads, random, range);
}

/// Makes the ids 1 to `count` known. Every second one, or one of five, is a literal, and every second of these a
/// number.
void addTerms(Environment& environment, TermId count, unsigned one_of) {
  WriteTransaction transaction = environment.write();
  QuadWriter writer(transaction);
  for (TermId id = 1; id <= count; ++id) {
    const std::string text = "t" + std::to_string(id);
    Term term = id == 1 ? Term::iri(vocabulary::xsd("integer")) : Term::iri(text);
    if (id % one_of == 0) term = id / one_of % 2 == 0 ? Term::integer(id) : Term::literal(text);
    ASSERT_EQ(writer.intern(term), id);
  }
  writer.flush();
  transaction.commit();
}

TEST(QuadStore, AnswersEveryPatternAsAPlainSetDoes) {
  for (unsigned seed = 0; seed < 8; ++seed) {
    std::mt19937 random(seed);
    const TermId range = seed % 2 == 0 ? 12 : 400;
    auto environment = Environment::temporary();
    if (seed < 6) addTerms(*environment, range, seed < 3 ? 2 : 5);  // else without terms
    std::set<QuadIds> quads;
    for (int round = 0; round < 12; ++round) {
      WriteTransaction transaction = environment->write();
      QuadWriter writer(transaction);
      std::set<QuadIds> changed = quads;
      const int changes = static_cast<int>(random() % (round % 3 == 0 ? 4000 : 40));
      for (int i = 0; i < changes; ++i) {
        const QuadIds quad = randomQuad(random, range);
        if (random() % 3 != 0) {
          writer.add(quad);
          changed.insert(quad);
        } else {
          writer.remove(quad);
          changed.erase(quad);
        }
      }
      writer.flush();
      expectSameAnswers(QuadReader(transaction), changed, random, range);
      if (random() % 4 != 0) {
        transaction.commit();
        quads = std::move(changed);
      }
      if (testing::Test::HasFatalFailure()) return;
      WriteTransaction(std::move(transaction));
      expectSameAnswers(QuadReader(environment->read()), quads, random, range);
      if (testing::Test::HasFatalFailure()) return;
    }
  }
}

TEST(QuadStore, IsChangedByListsAsByOneCallAQuad) {
  std::mt19937 random(9);
  const auto environment = Environment::temporary();
  std::set<QuadIds> quads;
  for (int round = 0; round < 12; ++round) {
    WriteTransaction transaction = environment->write();
    transaction.useThreads(1 + static_cast<unsigned>(round) % 3);
    QuadWriter writer(transaction);
    std::set<QuadIds> added, removed;
    for (int i = 0; i < (round % 3 == 0 ? 3000 : 30); ++i) {
      const QuadIds quad = randomQuad(random, 400);
      if (random() % 3 != 0)
        added.insert(quad);
      else
        removed.insert(quad);
    }
    for (const QuadIds& quad : added) removed.erase(quad);
    const QuadIds waiting = randomQuad(random, 400);
    writer.add(waiting);  // is written before the lists are
    quads.insert(waiting);
    writer.change({{added.begin(), added.end()}, {removed.begin(), removed.end()}});
    for (const QuadIds& quad : removed) quads.erase(quad);
    quads.insert(added.begin(), added.end());
    expectSameAnswers(QuadReader(transaction), quads, random, 400);
    transaction.commit();
  }
}

/// Of 3000 objects every `one_of`-th is a literal, and every second of these a number; 0: none.
void expectGoodEstimates(unsigned one_of) {
  auto environment = Environment::temporary();
  if (one_of > 0) addTerms(*environment, 3'000, one_of);
  std::set<QuadIds> quads;
  std::mt19937 random(4);
  WriteTransaction transaction = environment->write();
  QuadWriter writer(transaction);
  for (int i = 0; i < 120'000; ++i) {
    // Predicates with very different numbers of quads; subjects with a few or hundreds of quads.
    const auto p = 1 + static_cast<TermId>(random() % 10 < 8 ? 1 : random() % 40);
    const auto s = 1 + static_cast<TermId>(random() % 2 == 0 ? random() % 50 : random() % 40'000);
    const QuadIds quad{s, p, 1 + static_cast<TermId>(random() % 3'000), 1 + static_cast<TermId>(i % 2)};
    quads.insert(quad);
    writer.add(quad);
  }
  writer.flush();
  transaction.commit();
  const QuadReader reader(environment->read());
  for (const TermId p : {1U, 2U, 17U}) {
    for (const auto& pattern : {QuadPattern{{}, p, {}, {}}, QuadPattern{{}, p, {}, 1}, QuadPattern{7, p, {}, {}},
                                QuadPattern{{}, p, 5, {}}, QuadPattern{{}, p, 8, {}}, QuadPattern{{}, {}, {}, 2},
                                QuadPattern{{}, {}, 9, {}}, QuadPattern{{}, {}, 8, {}}}) {
      const auto exact = static_cast<double>(expected(quads, pattern, QuadOrder::Spog).size());
      const auto estimate = static_cast<double>(reader.estimate(pattern));
      EXPECT_TRUE(exact >= 4'000 || estimate == exact) << estimate << " for " << exact;
      EXPECT_TRUE(estimate >= exact / 2 && estimate <= exact * 2) << estimate << " for " << exact;
    }
    std::set<TermId> subjects;
    std::set<TermId> objects;
    std::size_t count = 0;
    for (const QuadIds& quad : quads)
      if (quad.p == p) subjects.insert(quad.s), objects.insert(quad.o), ++count;
    const auto statistics = reader.statistics(p);
    EXPECT_NEAR(static_cast<double>(statistics.quads), count, count < 4'000 ? 0 : 0.1 * count);
    EXPECT_NEAR(static_cast<double>(statistics.subjects), subjects.size(), 0.35 * subjects.size());
    EXPECT_NEAR(static_cast<double>(statistics.objects), objects.size(), 0.35 * objects.size());
  }
  std::set<TermId> predicates;
  for (const QuadIds& quad : quads) predicates.insert(quad.p);
  EXPECT_EQ(reader.predicates(), std::vector<TermId>(predicates.begin(), predicates.end()));
  EXPECT_EQ(reader.graphs(), (std::vector<TermId>{1, 2}));
}

TEST(QuadStore, EstimatesWithinAFactorOfTwoAndExactlyWhenFew) {
  for (const unsigned one_of : {0U, 2U, 5U}) expectGoodEstimates(one_of);
}

}  // namespace
}  // namespace cluxel::rdf
