// SPDX-License-Identifier: Apache-2.0
// The quad store against a std::set of quads.
#include "cluxel/knowledge/quad_store.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "cluxel/knowledge/environment.hpp"

namespace cluxel {
namespace {

constexpr std::array<QuadOrder, 4> kOrders = {QuadOrder::Spog, QuadOrder::Posg, QuadOrder::Ospg,
                                              QuadOrder::Gspo};

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

/// What a scan of a plain set gives.
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

QuadIds randomQuad(std::mt19937& random, TermId range) {
  const auto id = [&](TermId most) { return static_cast<TermId>(random() % most); };
  return {1 + id(range), 1 + id(7), 1 + id(range), id(3)};
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

/// Runs through `quads` with a cursor that seeks ahead now and then.
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

void expectLookupsFindWhatScansFind(const QuadReader& reader, const std::set<QuadIds>& quads,
                                    std::mt19937& random, TermId range) {
  for (const QuadOrder order : kOrders) {
    PrefixLookup lookup = reader.lookup(order);
    const std::vector<QuadIds> all = expected(quads, {}, order);
    for (int i = 0; i < 20; ++i) {
      const std::array<TermId, 4> ids = inOrder(randomQuad(random, range), order);
      const std::size_t length = 1 + random() % 4;
      std::vector<QuadIds> found;
      for (auto keys = lookup.find(std::span(ids).first(length)); !keys.empty(); keys = lookup.more())
        for (const QuadKey& key : keys) found.push_back(toQuad(key, order));
      std::vector<QuadIds> wanted = all;
      std::erase_if(wanted, [&](const QuadIds& quad) {
        const auto other = inOrder(quad, order);
        return !std::equal(ids.begin(), ids.begin() + static_cast<std::ptrdiff_t>(length), other.begin());
      });
      ASSERT_EQ(found, wanted);
    }
  }
}

void expectSameAnswers(const QuadReader& reader, const std::set<QuadIds>& quads, std::mt19937& random,
                       TermId range) {
  ASSERT_EQ(reader.size(), quads.size());
  for (unsigned bound = 0; bound < 16; ++bound) {
    const QuadPattern pattern = patternOf(randomQuad(random, range), bound);
    for (const QuadOrder order : kOrders) {
      const std::vector<QuadIds> wanted = expected(quads, pattern, order);
      ASSERT_EQ(drain(reader.scan(pattern, order)), wanted) << bound;
      ASSERT_EQ(drainInBulk(reader.scan(pattern, order), 1 + random() % 300), wanted) << bound;
      ASSERT_EQ(drainBlocks(reader.scan(pattern, order), pattern), wanted) << bound;
      expectSeeksLikeASortedList(reader.scan(pattern, order), wanted, random, range);
    }
    ASSERT_EQ(reader.count(pattern), expected(quads, pattern, QuadOrder::Spog).size());
    const QuadIds probe = randomQuad(random, range);
    ASSERT_EQ(reader.contains(probe), quads.contains(probe));
  }
  expectLookupsFindWhatScansFind(reader, quads, random, range);
}

TEST(QuadStore, AnswersEveryPatternAsAPlainSetDoes) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    std::mt19937 random(seed);
    const TermId range = seed % 2 == 0 ? 12 : 400;
    auto environment = Environment::temporary();
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

}  // namespace
}  // namespace cluxel
