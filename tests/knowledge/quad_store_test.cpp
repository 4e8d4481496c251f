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

void expectSameAnswers(const QuadReader& reader, const std::set<QuadIds>& quads, std::mt19937& random,
                       TermId range) {
  ASSERT_EQ(reader.size(), quads.size());
  for (unsigned bound = 0; bound < 16; ++bound) {
    const QuadPattern pattern = patternOf(randomQuad(random, range), bound);
    for (const QuadOrder order : kOrders)
      ASSERT_EQ(drain(reader.scan(pattern, order)), expected(quads, pattern, order)) << bound;
    ASSERT_EQ(reader.count(pattern), expected(quads, pattern, QuadOrder::Spog).size());
    const QuadIds probe = randomQuad(random, range);
    ASSERT_EQ(reader.contains(probe), quads.contains(probe));
  }
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
