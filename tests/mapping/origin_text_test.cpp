// SPDX-License-Identifier: Apache-2.0
// An origin that is told can be given again: its text reads as the same number, and up to three decimals it is the text
// that measured numbers have.
#include "mapping/origin_text.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>

#include "mapping/facts/fact_sink.hpp"

namespace cluxel::mapping {
namespace {

TEST(OriginText, ReadsAsTheSameNumber) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> anywhere(-7e6, 7e6);
  for (int i = 0; i < 10'000; ++i) {
    const double number = anywhere(random);
    const std::string text = exactDecimalText(number);
    EXPECT_EQ(std::strtod(text.c_str(), nullptr), number) << text;
    EXPECT_EQ(text.find_first_not_of("-.0123456789"), std::string::npos) << text;
    EXPECT_NE(text.find('.'), std::string::npos) << text;
  }
  EXPECT_EQ(originText({451234.5600001, 5423123.7800003, 210.30000001}),
            "[451234.5600001, 5423123.7800003, 210.30000001]");
  EXPECT_EQ(originText({-0.0, 1e-7, 1e7}), "[0.0, 0.0000001, 10000000.0]");
}

TEST(OriginText, IsThatOfMeasuredNumbersUpToThreeDecimals) {
  std::mt19937_64 random(6);
  std::uniform_int_distribution<std::int64_t> anywhere(-7'000'000'000, 7'000'000'000);
  for (int i = 0; i < 10'000; ++i) {
    const double number = static_cast<double>(anywhere(random)) / std::pow(10.0, i % 4);
    EXPECT_EQ(exactDecimalText(number), decimalText(number, 3));
  }
}

}  // namespace
}  // namespace cluxel::mapping
