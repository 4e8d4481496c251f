// SPDX-License-Identifier: Apache-2.0
// Announced lookups give the same results as unannounced ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <string>

#include "rdf/file/environment.hpp"
#include "rdf/store/quad_store.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::rdf {
namespace {

constexpr std::array<QuadOrder, 4> kOrders = {QuadOrder::Spog, QuadOrder::Posg, QuadOrder::Ospg, QuadOrder::Gspo};
constexpr std::array<std::size_t, 9> kCounts = {0, 1, 2, 31, 32, 33, 63, 64, 65};

QuadIds randomQuad(std::mt19937& random) {
  const auto id = [&](TermId max) { return static_cast<TermId>(random() % max); };
  return {1 + id(400), 1 + id(5), 1 + id(400), id(3)};
}

std::vector<QuadKey> drained(PrefixLookup& lookup, std::span<const TermId> prefix) {
  std::vector<QuadKey> found;
  for (auto block = lookup.find(prefix); !block.empty(); block = lookup.more())
    found.insert(found.end(), block.begin(), block.end());
  return found;
}

bool same(const std::vector<QuadKey>& a, const std::vector<QuadKey>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const QuadKey& x, const QuadKey& y) { return x.bytes == y.bytes; });
}

/// Random prefixes in ascending or random order; all of them, some of them, or other prefixes are announced.
void expectSameLookups(const QuadReader& reader, QuadOrder order, std::size_t length, std::size_t count,
                       std::mt19937& random) {
  std::vector<std::array<TermId, 4>> prefixes(count);
  for (auto& prefix : prefixes) {
    const QuadIds quad = randomQuad(random);
    const std::array<TermId, 4> ids = {quad.s, quad.p, quad.o, quad.g};
    for (std::size_t i = 0; i < 4; ++i) prefix[i] = ids[placesOf(order)[i]];
  }
  if (random() % 2 == 0) std::sort(prefixes.begin(), prefixes.end());
  std::vector<TermId> told;
  for (const auto& prefix : prefixes) {
    if (random() % 8 == 0) continue;
    told.insert(told.end(), prefix.begin(), prefix.begin() + static_cast<std::ptrdiff_t>(length));
  }
  PrefixLookup plain = reader.lookup(order), informed = reader.lookup(order);
  informed.expect(told, length);
  if (random() % 4 == 0) {  // no lengths that a lookup has: nothing is expected
    informed.expect(told, 0);
    informed.expect(told, 5);
  }
  for (const auto& prefix : prefixes) {
    const std::span<const TermId> ids(prefix.data(), length);
    EXPECT_TRUE(same(drained(plain, ids), drained(informed, ids)));
  }
}

TEST(Expectation, LookupsFindTheSameWhateverTheyWereToldToExpect) {
  for (const std::size_t quads : {0U, 1U, 2U, 100U, 5000U, 40'000U}) {
    std::mt19937 random(static_cast<unsigned>(quads) + 3);
    const auto environment = Environment::temporary();
    {
      WriteTransaction transaction = environment->write();
      QuadWriter writer(transaction);
      for (std::size_t i = 0; i < quads; ++i) writer.add(randomQuad(random));
      writer.flush();
      const QuadReader within(transaction);
      for (const QuadOrder order : kOrders) expectSameLookups(within, order, 2, 65, random);
      transaction.commit();
    }
    const QuadReader reader(environment->read());
    for (const QuadOrder order : kOrders)
      for (std::size_t length = 1; length <= 4; ++length)
        for (const std::size_t count : kCounts) expectSameLookups(reader, order, length, count, random);
  }
}

TEST(Expectation, TermsAndValuesAreTheSameAfterBeingExpected) {
  const auto environment = Environment::temporary();
  WriteTransaction transaction = environment->write();
  QuadWriter writer(transaction);
  for (int i = 0; i < 5000; ++i) {
    writer.intern(Term::integer(i));
    writer.intern(
        Term::iri("http://example.org/" + std::string(static_cast<std::size_t>(i) % 3000, 'x') + std::to_string(i)));
  }
  writer.flush();
  transaction.commit();
  const QuadReader reader(environment->read());
  const auto terms = static_cast<TermId>(reader.termCount());
  std::mt19937 random(5);
  for (const std::size_t count : kCounts) {
    std::vector<TermId> ids;
    for (std::size_t i = 0; i < count; ++i) ids.push_back(static_cast<TermId>(random() % (terms + 1)));
    if (count > 2) ids[0] = terms + 1, ids[1] = 0xFFFF'FFFF;  // neither is there
    reader.expectValues(ids);
    for (const TermId id : ids) {
      if (id == kNoTerm || id > terms) continue;
      const Term term = reader.termOf(id);
      EXPECT_EQ(reader.idOf(term), id);
      if (term.datatype == vocabulary::xsd("integer")) {
        EXPECT_EQ(std::to_string(reader.valueOf(id).integer), term.text);
      }
    }
  }
}

/// The text of integer * 10^-scale with a fraction of `scale` digits.
std::string written(const DecodedValue& value) {
  std::string digits = std::to_string(value.integer < 0 ? -value.integer : value.integer);
  if (digits.size() <= value.scale) digits.insert(0, value.scale + 1U - digits.size(), '0');
  if (value.scale > 0) digits.insert(digits.size() - value.scale, ".");
  return (value.integer < 0 ? "-" : "") + digits;
}

TEST(Expectation, DecimalsKeepTheirDigitsWhere64BitsHoldThem) {
  const auto environment = Environment::temporary();
  WriteTransaction transaction = environment->write();
  QuadWriter writer(transaction);
  std::mt19937_64 random(11);
  std::vector<std::pair<TermId, std::string>> made;
  const auto make = [&](const std::string& text) {
    made.emplace_back(writer.intern(Term::literal(text, vocabulary::xsd("decimal"))), text);
  };
  for (int i = 0; i < 500; ++i) {
    const std::string whole = std::to_string(random() % 1'000'000'000),
                      fraction = std::to_string(random() % 1'000'000'000);
    make((i % 3 == 0 ? "-" : "") + whole + (i % 4 == 0 ? "" : "." + fraction));
  }
  const TermId plus = writer.intern(Term::literal("+.50", vocabulary::xsd("decimal")));
  const TermId long_one = writer.intern(Term::literal("1234567890123456789", vocabulary::xsd("decimal")));
  std::vector<TermId> too_long;
  for (const char* text : {"9999999999999999999", "-9999999999999999999", "+9999999999999999999",
                           "999999999999999999.9", "-0.9999999999999999999", "99999999999999999999"}) {
    too_long.push_back(writer.intern(Term::literal(text, vocabulary::xsd("decimal"))));
  }
  make("999999999999999999");
  make("-999999999999999999");
  make("-0.99999999999999999");
  make("99999999999999999.9");
  const TermId long_fraction = writer.intern(Term::literal("0.0000000000000000001", vocabulary::xsd("decimal")));
  const TermId ill_formed = writer.intern(Term::literal("1.2.3", vocabulary::xsd("decimal")));
  writer.flush();
  transaction.commit();
  const QuadReader reader(environment->read());
  for (const auto& [id, text] : made) {
    ASSERT_NE(reader.valueOf(id).scale, DecodedValue::kNoScale) << text;
    EXPECT_EQ(written(reader.valueOf(id)), text);
  }
  EXPECT_EQ(reader.valueOf(plus).integer, 50);
  EXPECT_EQ(reader.valueOf(plus).scale, 2);
  EXPECT_EQ(reader.valueOf(long_one).scale, DecodedValue::kNoScale);
  EXPECT_EQ(reader.valueOf(long_fraction).scale, DecodedValue::kNoScale);
  for (const TermId id : too_long) {
    EXPECT_EQ(reader.valueOf(id).type, DecodedValue::Type::Decimal);
    EXPECT_EQ(reader.valueOf(id).scale, DecodedValue::kNoScale) << reader.termOf(id).text;
  }
  EXPECT_EQ(reader.valueOf(ill_formed).type, DecodedValue::Type::None);
}

}  // namespace
}  // namespace cluxel::rdf
