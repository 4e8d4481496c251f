// SPDX-License-Identifier: Apache-2.0
// Numbers in messages are short, and right to the last decimal that they show.
#include "base/text/short_number.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace cluxel {
namespace {

TEST(ShortNumber, HasNoDigitThatTellsNothing) {
  EXPECT_EQ(shortNumber(2.5), "2.5");
  EXPECT_EQ(shortNumber(-3), "-3");
  EXPECT_EQ(shortNumber(100), "100");
  EXPECT_EQ(shortNumber(0), "0");
  EXPECT_EQ(shortNumber(-0.01, 1), "0");
  EXPECT_EQ(shortNumber(0.25, 1), "0.2") << "the binary tie goes to the even digit";
  EXPECT_EQ(shortNumber(1e6), "1000000");
  EXPECT_EQ(shortNumber(20, 0), "20");
}

TEST(ShortNumber, HasAnExponentInsteadOfHundredsOfDigits) {
  EXPECT_EQ(shortNumber(1e300), "1e300");
  EXPECT_EQ(shortNumber(-1e300), "-1e300");
  EXPECT_EQ(shortNumber(-2.5e17, 1), "-2.5e17");
  EXPECT_EQ(shortNumber(std::numeric_limits<double>::infinity()), "inf");
  EXPECT_EQ(shortNumber(std::numeric_limits<double>::quiet_NaN()), "nan");
}

TEST(ShortNumber, IsReadBackWithinHalfOfItsLastDigit) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> exponent(-12, 308), unit(-1, 1);
  for (int i = 0; i < 20'000; ++i) {
    const double value = unit(random) * std::pow(10, exponent(random));
    const int decimals = i % 7;
    const std::string text = shortNumber(value, decimals);
    ASSERT_LE(text.size(), 24U) << text;
    const double error = 0.501 * std::pow(10, -decimals), share = 6e-6;
    const double allowed = std::abs(value) < 1e15 ? error + 1e-15 * std::abs(value) : share * std::abs(value);
    ASSERT_NEAR(std::stod(text), value, allowed) << text;
    ASSERT_TRUE(text.find('.') == std::string::npos || text.find('e') != std::string::npos || text.back() != '0');
  }
}

}  // namespace
}  // namespace cluxel
