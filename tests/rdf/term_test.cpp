// SPDX-License-Identifier: Apache-2.0
// Tests of terms, their canonical text and the values of literals.
#include "cluxel/term.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "rdf/terms/literal_value.hpp"
#include "rdf/vocabulary.hpp"

namespace cluxel::rdf {
namespace {

using Type = DecodedValue::Type;

DecodedValue decode(const char* lexical, const char* type) {
  return decodeLiteral(lexical, vocabulary::xsd(type));
}

TEST(Term, WritesCanonicalNTriples) {
  EXPECT_EQ(toNTriples(Term::iri("http://x/é y>")), "<http://x/é\\u0020y\\u003E>");
  EXPECT_EQ(toNTriples(Term::blank("b1")), "_:b1");
  EXPECT_EQ(toNTriples(Term::literal("a\"\\\n\r\té")), "\"a\\\"\\\\\\n\\r\té\"");
  EXPECT_EQ(toNTriples(Term::langLiteral("x", "EN-gb")), "\"x\"@en-gb");
  EXPECT_EQ(toNTriples(Term::integer(-5)), "\"-5\"^^<http://www.w3.org/2001/XMLSchema#integer>");
  EXPECT_EQ(toNQuads({Term::iri("a"), Term::iri("b"), Term::literal("c"), Term::iri("")}), "<a> <b> \"c\" .\n");
  EXPECT_EQ(toNQuads({Term::iri("a"), Term::iri("b"), Term::literal("c"), Term::iri("g")}), "<a> <b> \"c\" <g> .\n");
}

TEST(Term, WritesDoublesThatReadBackTheSame) {
  EXPECT_EQ(Term::real(0).text, "0.0E0");
  EXPECT_EQ(Term::real(-1.5e-7).text, "-1.5E-7");
  EXPECT_EQ(Term::real(100).text, "1.0E2");
  EXPECT_EQ(Term::real(std::numeric_limits<double>::infinity()).text, "INF");
  EXPECT_EQ(Term::real(std::nan("")).text, "NaN");
  std::mt19937_64 random(2);
  for (int i = 0; i < 20'000; ++i) {
    double value = 0;
    const std::uint64_t bits = random();
    std::memcpy(&value, &bits, sizeof value);
    if (std::isfinite(value)) {
      ASSERT_EQ(decode(Term::real(value).text.c_str(), "double").number, value);
    }
  }
}

TEST(LiteralValue, DecodesIntegersWithinTheirTypes) {
  EXPECT_EQ(decode("007", "integer").integer, 7);
  EXPECT_EQ(decode("+7", "integer").integer, 7);
  EXPECT_EQ(decode("-9223372036854775808", "long").integer, std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(decode("9223372036854775807", "integer").number, 9223372036854775807.0);
  for (const auto& [lexical, type] :
       std::vector<std::pair<const char*, const char*>>{{"9223372036854775808", "integer"},
                                                        {"128", "byte"},
                                                        {"-1", "unsignedInt"},
                                                        {"0", "positiveInteger"},
                                                        {"1", "negativeInteger"},
                                                        {"1.0", "integer"},
                                                        {"", "integer"},
                                                        {" 1", "integer"},
                                                        {"+-1", "integer"},
                                                        {"+", "integer"},
                                                        {"1e3", "integer"},
                                                        {"0x1", "integer"}})
    EXPECT_EQ(decode(lexical, type).type, Type::None) << lexical;
  EXPECT_EQ(decode("255", "unsignedByte").type, Type::Integer);
}

TEST(LiteralValue, DecodesDecimalsDoublesAndFloats) {
  EXPECT_EQ(decode("-.5", "decimal").number, -0.5);
  EXPECT_EQ(decode("5.", "decimal").number, 5.0);
  EXPECT_EQ(decode("1e5", "decimal").type, Type::None);
  EXPECT_EQ(decode(".", "decimal").type, Type::None);
  EXPECT_EQ(decode("1e5", "double").number, 1e5);
  EXPECT_EQ(decode("-INF", "double").number, -std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isnan(decode("NaN", "float").number));
  EXPECT_EQ(decode("1e400", "double").number, std::numeric_limits<double>::infinity());
  EXPECT_EQ(decode("-1e-400", "double").number, 0.0);
  EXPECT_TRUE(std::signbit(decode("-1e-400", "double").number));
  EXPECT_EQ(decode((std::string("0.") + std::string(400, '0') + "1e401").c_str(), "double").number, 1.0);
  EXPECT_EQ(decode("0.1", "float").number, static_cast<double>(0.1F));
  for (const char* bad : {"inf", "Infinity", "nan", "1e", "e1", "0x1p3", "1e+", "1.2.3", ""})
    EXPECT_EQ(decode(bad, "double").type, Type::None) << bad;
}

TEST(LiteralValue, DecodesBooleansAndMoments) {
  EXPECT_EQ(decode("1", "boolean").integer, 1);
  EXPECT_EQ(decode("TRUE", "boolean").type, Type::None);
  EXPECT_EQ(decode("1970-01-01T00:00:00Z", "dateTime").integer, 0);
  EXPECT_EQ(decode("1969-12-31T24:00:00Z", "dateTime").integer, 0);
  EXPECT_EQ(decode("2000-02-29T12:30:00.25+02:00", "dateTime").integer, 951'820'200'250'000);
  EXPECT_EQ(decode("-0001-01-01T00:00:00Z", "dateTime").integer, -62'198'755'200'000'000);
  EXPECT_EQ(decode("2004-04-12-05:00", "date").integer, 1'081'746'000'000'000);
  for (const char* bad : {"2001-02-29T00:00:00Z", "2001-1-1T00:00:00Z", "2001-01-01T25:00:00Z", "2001-01-01T00:00:00",
                          "2001-01-01T00:00:00.Z", "2001-01-01T00:00:00+15:00", "2001-01-01", "01-01-01T00:00:00Z"})
    EXPECT_EQ(decode(bad, "dateTime").type, Type::None) << bad;
}

TEST(LiteralValue, KnowsStringsAndLeavesForeignTypesAlone) {
  EXPECT_EQ(decode("x", "string").type, Type::String);
  EXPECT_EQ(decodeLiteral("x", vocabulary::rdf("langString")).type, Type::LangString);
  EXPECT_EQ(decodeLiteral("1", "http://own/integer").type, Type::None);
  EXPECT_EQ(decode("P1D", "duration").type, Type::None);
}

}  // namespace
}  // namespace cluxel::rdf
