// SPDX-License-Identifier: Apache-2.0
// Compares numbers, times and their text with references, and tests algebraic laws.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_dec_float.hpp>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <random>

#include "sparql/support/arithmetic_fixture.hpp"
#include "sparql/support/store_fixture.hpp"
#include "sparql/values/calendar.hpp"
#include "sparql/values/decimal.hpp"
#include "sparql/values/value.hpp"

namespace cluxel::sparql {

using namespace rdf;
namespace {

using boost::multiprecision::cpp_rational;

TEST(Arithmetic, OfDecimalsIsExactForRandomOperands) {
  std::mt19937_64 random(11);
  for (int i = 0; i < 3000; ++i) {
    const std::string a = test::randomDecimalText(random), b = test::randomDecimalText(random);
    const Decimal x = *Decimal::parse(a), y = *Decimal::parse(b);
    const cpp_rational p = test::rationalOf(a), q = test::rationalOf(b);
    EXPECT_EQ(test::rationalOf(Decimal::add(x, y)->text()), p + q) << a << " + " << b;
    EXPECT_EQ(test::rationalOf(Decimal::subtract(x, y)->text()), p - q) << a << " - " << b;
    EXPECT_EQ(test::rationalOf(Decimal::multiply(x, y)->text()), p * q) << a << " * " << b;
    EXPECT_EQ(x < y, p < q) << a << " < " << b;
    EXPECT_EQ(x == y, p == q) << a << " = " << b;
  }
}

TEST(Arithmetic, DecimalsAroundTheEndOfMachineWordsStayExact) {
  const std::string texts[] = {"9223372036854775807",
                               "-9223372036854775808",
                               "9223372036854775808",
                               "-9223372036854775809",
                               "922337203685477580.7",
                               "-0.9223372036854775808",
                               "1000000000000000000",
                               "0.000000000000000001",
                               "-1",
                               "10",
                               "0",
                               "0.1"};
  for (const std::string& a : texts) {
    const Decimal x = *Decimal::parse(a);
    EXPECT_EQ(test::rationalOf(x.text()), test::rationalOf(a)) << a;
    EXPECT_EQ(test::rationalOf((-x).text()), -test::rationalOf(a)) << a;
    EXPECT_EQ(x.toDouble(), std::strtod(a.c_str(), nullptr)) << a;
    for (const std::string& b : texts) {
      const Decimal y = *Decimal::parse(b);
      const cpp_rational p = test::rationalOf(a), q = test::rationalOf(b);
      EXPECT_EQ(test::rationalOf(Decimal::add(x, y)->text()), p + q) << a << " + " << b;
      EXPECT_EQ(test::rationalOf(Decimal::subtract(x, y)->text()), p - q) << a << " - " << b;
      EXPECT_EQ(test::rationalOf(Decimal::multiply(x, y)->text()), p * q) << a << " * " << b;
      EXPECT_EQ(x < y, p < q) << a << " < " << b;
      EXPECT_EQ(x == y, p == q) << a << " = " << b;
    }
  }
}

TEST(Arithmetic, NearestDoublesOfDecimalsAreThoseOfTheirText) {
  std::mt19937_64 random(14);
  for (int i = 0; i < 3000; ++i) {
    const std::string text = test::randomDecimalText(random);
    EXPECT_EQ(Decimal::parse(text)->toDouble(), std::strtod(text.c_str(), nullptr)) << text;
  }
}

TEST(Arithmetic, QuotientsOfDecimalsAreCutBehindEighteenDigits) {
  std::mt19937_64 random(12);
  const cpp_rational unit(1, boost::multiprecision::cpp_int("1000000000000000000"));
  for (int i = 0; i < 3000; ++i) {
    const std::string a = test::randomDecimalText(random), b = test::randomDecimalText(random);
    if (test::rationalOf(b) == 0) continue;
    const auto quotient = Decimal::divide(*Decimal::parse(a), *Decimal::parse(b));
    ASSERT_TRUE(quotient.has_value());
    const cpp_rational exact = test::rationalOf(a) / test::rationalOf(b);
    const cpp_rational error = abs(exact) - abs(test::rationalOf(quotient->text()));
    EXPECT_GE(error, 0) << a << " / " << b;
    EXPECT_LT(error, unit) << a << " / " << b;
  }
}

TEST(Arithmetic, OfTheEngineAgreesWithTheReferenceForRandomNumbersOfAllTypes) {
  const test::SmallStore store("");
  std::mt19937_64 random(13);
  for (int i = 0; i < 300; ++i) {
    const test::RandomSum sum = test::randomSum(random);
    EXPECT_EQ(store.value(sum.expression), sum.expected) << sum.expression;
  }
}

TEST(Arithmetic, OfIntegersGoesBeyondSixtyFourBits) {
  const test::SmallStore store("");
  EXPECT_EQ(store.value("9223372036854775807 + 1"), "\"9223372036854775808\"^^integer");
  EXPECT_EQ(store.value("-9223372036854775807 - 3"), "\"-9223372036854775810\"^^integer");
  EXPECT_EQ(store.value("9223372036854775807 * 9223372036854775807"),
            "\"85070591730234615847396907784232501249\"^^integer");
  EXPECT_EQ(store.value("-(-9223372036854775807 - 1)"), "\"9223372036854775808\"^^integer");
  EXPECT_EQ(store.value("9223372036854775808 > 9223372036854775807"), "\"true\"^^boolean");
}

TEST(Arithmetic, DividesIntegersToDecimals) {
  const test::SmallStore store("");
  EXPECT_EQ(store.value("6 / 3"), "\"2\"^^decimal");
  EXPECT_EQ(store.value("1 / 3"), "\"0.333333333333333333\"^^decimal");
  EXPECT_EQ(store.value("1 / 0.1"), "\"10\"^^decimal");
  EXPECT_EQ(store.value("1 / 0"), "-");
  EXPECT_EQ(store.value("1e0 / 0"), "\"INF\"^^double");
  EXPECT_EQ(store.value("xsd:float(7) / 2"), "\"3.5E0\"^^float");
}

TEST(Numbers, PrintInCanonicalForm) {
  EXPECT_EQ(canonicalText(1.0), "1.0E0");
  EXPECT_EQ(canonicalText(0.1), "1.0E-1");
  EXPECT_EQ(canonicalText(123456.789), "1.23456789E5");
  EXPECT_EQ(canonicalText(-0.0), "-0.0E0");
  EXPECT_EQ(canonicalText(-INFINITY), "-INF");
  EXPECT_EQ(canonicalText(NAN), "NaN");
  EXPECT_EQ(Decimal::parse("-0012.3400")->text(), "-12.34");
  EXPECT_EQ(Decimal::parse("+5.")->text(), "5");
  EXPECT_EQ(Decimal::parse(".5")->text(), "0.5");
  EXPECT_FALSE(Decimal::parse(".").has_value());
  EXPECT_FALSE(Decimal::parse("1e3").has_value());
}

TEST(Numbers, ReadBackTheSameFromTheirCanonicalForm) {
  std::mt19937_64 random(14);
  for (int i = 0; i < 5000; ++i) {
    const double value = std::bit_cast<double>(random());
    if (!std::isfinite(value)) continue;
    EXPECT_EQ(*parseDouble(canonicalText(value)), value);
    EXPECT_EQ(Decimal::fromDouble(value)->toDouble(), value);
  }
}

TEST(Numbers, BeyondTheRangeOfDoublesBecomeZeroOrInfinity) {
  const std::string zeros(400, '0');
  EXPECT_EQ(parseDouble("0." + zeros + "1"), 0.0);
  EXPECT_TRUE(std::signbit(*parseDouble("-0." + zeros + "1")));
  EXPECT_EQ(parseDouble("1" + zeros + "e-1"), HUGE_VAL);
  EXPECT_EQ(parseDouble("-1" + zeros), -HUGE_VAL);
  EXPECT_EQ(parseDouble("1e-400"), 0.0);
  EXPECT_EQ(parseDouble("0.1e400"), HUGE_VAL);
  EXPECT_EQ(parseFloat("1e-60"), 0.0f);
  EXPECT_EQ(parseFloat("0e999"), 0.0f);
}

TEST(Numbers, OfWrongFormHaveNoValue) {
  for (const char* text : {"", "nan", "inf", "1e", "0x10", "1 2", "+-1", "--1"})
    EXPECT_FALSE(parseDouble(text).has_value()) << text;
}

TEST(Times, CompareAcrossZones) {
  const test::SmallStore store("");
  const auto compare = [&](const std::string& a, const std::string& op, const std::string& b) {
    return store.value("\"" + a + "\"^^xsd:dateTime " + op + " \"" + b + "\"^^xsd:dateTime");
  };
  EXPECT_EQ(compare("2024-01-01T12:00:00Z", "=", "2024-01-01T13:00:00+01:00"), "\"true\"^^boolean");
  EXPECT_EQ(compare("2024-01-01T00:30:00+01:00", "<", "2024-01-01T00:00:00Z"), "\"true\"^^boolean");
  EXPECT_EQ(compare("2024-01-01T12:00:00", "<", "2024-01-03T12:00:00Z"), "\"true\"^^boolean");
  EXPECT_EQ(compare("2024-01-01T12:00:00", "<", "2024-01-01T13:00:00Z"), "-") << "undecided without zone";
  EXPECT_EQ(compare("2024-01-01T24:00:00Z", "=", "2024-01-02T00:00:00Z"), "\"true\"^^boolean");
}

TEST(Times, MoveByDurations) {
  const test::SmallStore store("");
  EXPECT_EQ(store.value("\"2024-01-31T00:00:00Z\"^^xsd:dateTime + \"P1M\"^^xsd:yearMonthDuration"),
            "\"2024-02-29T00:00:00Z\"^^dateTime");
  EXPECT_EQ(store.value("\"2024-03-01T00:00:00Z\"^^xsd:dateTime - \"2024-02-28T12:00:00Z\"^^xsd:dateTime"),
            "\"P1DT12H\"^^dayTimeDuration");
  EXPECT_EQ(store.value("\"P1Y\"^^xsd:duration = \"P12M\"^^xsd:duration"), "\"true\"^^boolean");
}

/// What a cast or a sum drops must not affect comparisons.
TEST(Times, ComputedOnesEqualThoseThatAreWritten) {
  const test::SmallStore store;
  for (
      const char* expression :
      {R"(xsd:date("2020-01-01T12:00:00Z"^^xsd:dateTime) = "2020-01-01Z"^^xsd:date)",
       R"(xsd:time("2020-01-01T12:00:00Z"^^xsd:dateTime) = "12:00:00Z"^^xsd:time)",
       R"(xsd:gYear("2020-03-01T12:00:00"^^xsd:dateTime) = "2020"^^xsd:gYear)",
       R"(xsd:gMonthDay("2020-03-01T12:00:00"^^xsd:dateTime) = "--03-01"^^xsd:gMonthDay)",
       R"(xsd:gMonth("2020-03-05T12:00:00"^^xsd:dateTime) = "--03"^^xsd:gMonth)",
       R"("2020-01-01"^^xsd:date + "PT12H"^^xsd:dayTimeDuration = "2020-01-01"^^xsd:date)",
       R"("2020-01-01"^^xsd:date + "PT36H"^^xsd:dayTimeDuration = "2020-01-02"^^xsd:date)",
       R"("2020-01-02"^^xsd:date - ("2020-01-01"^^xsd:date + "PT12H"^^xsd:dayTimeDuration) = "P1D"^^xsd:dayTimeDuration)"}) {
    EXPECT_EQ(store.value(expression), "\"true\"^^boolean") << expression;
  }
}

TEST(Times, OfFarYearsAreOrdered) {
  const test::SmallStore store;
  EXPECT_EQ(store.value(R"("99999999999-01-01"^^xsd:date > "2020-01-01"^^xsd:date)"), "\"true\"^^boolean");
  EXPECT_EQ(store.value(R"("-99999999999-01-01"^^xsd:date < "2020-01-01"^^xsd:date)"), "\"true\"^^boolean");
  EXPECT_EQ(store.value(R"("999999999999-01-01"^^xsd:date < "2020-01-01"^^xsd:date)"), "-")
      << "more than can be counted in seconds";
}

TEST(Times, RoundTripThroughTheTimeline) {
  std::mt19937_64 random(15);
  for (int i = 0; i < 500; ++i) {
    const auto microseconds = static_cast<std::int64_t>(random() % 8'000'000'000'000'000ull) - 4'000'000'000'000'000;
    const CalendarTime time = calendarFromMicroseconds(microseconds);
    const auto read = parseCalendar(CalendarKind::DateTime, formatCalendar(CalendarKind::DateTime, time));
    ASSERT_TRUE(read.has_value());
    EXPECT_EQ(read->timeline(), Decimal(Decimal::Integer(microseconds), 6));
  }
}

TEST(Times, OfWrongFormHaveNoValue) {
  for (const char* text : {"2024-13-01T00:00:00", "2023-02-29T00:00:00", "2024-01-01T25:00:00", "2024-01-01",
                           "24-01-01T00:00:00", "2024-01-01T00:00:00+15:00", "2024-01-01T24:00:01"}) {
    EXPECT_FALSE(parseCalendar(CalendarKind::DateTime, text).has_value()) << text;
  }
}

}  // namespace
}  // namespace cluxel::sparql
