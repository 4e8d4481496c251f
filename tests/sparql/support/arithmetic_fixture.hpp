// SPDX-License-Identifier: Apache-2.0
// Random arithmetic expressions with their expected values.
#pragma once

#include <boost/multiprecision/cpp_int.hpp>
#include <random>
#include <string>

namespace cluxel::test {

std::string randomDecimalText(std::mt19937_64& random);
/// The exact value of decimal text.
boost::multiprecision::cpp_rational rationalOf(const std::string& text);

/// An expression of two numbers of random types, and its value as SmallStore::value() shows it.
struct RandomSum {
  std::string expression, expected;
};
RandomSum randomSum(std::mt19937_64& random);

}  // namespace cluxel::test
