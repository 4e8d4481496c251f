// SPDX-License-Identifier: Apache-2.0
// Checks of the values of options: what a fault says is alike in all commands, and no number is NaN or infinite.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <map>
#include <string>
#include <type_traits>
#include <vector>

namespace cluxel::app {

/// Limits of a number, both included.
struct NumberRange {
  double min, max;
};

/// Limits of a whole number, both included.
struct WholeRange {
  std::uint64_t min, max;
};

/// For options that take any finite number.
CLI::Validator finite();
/// For options that take a number within limits.
CLI::Validator within(NumberRange range);
/// For options that take a number above 0.
CLI::Validator above0();
/// For options that take a share: a number from 0 to 1.
CLI::Validator share();

/// For options that take a whole number, in decimal digits. CLI11 alone would truncate, wrap or read octal digits.
CLI::Validator wholeWithin(WholeRange range);
/// For options that take a whole number above 0.
CLI::Validator wholeAbove0();
/// For options that take any unsigned 64-bit number.
CLI::Validator whole();

/// For options that take one of a few numbers.
CLI::Validator oneOf(std::vector<double> numbers);
/// For options that take one of a few words.
CLI::Validator oneOf(std::vector<std::string> words);

/// For options that take one of a few words, each of which stands for a value.
template <typename Enum>
CLI::Validator wordFor(const std::map<std::string, Enum>& values, const std::string& shown) {
  static_assert(std::is_enum_v<Enum>);
  std::vector<std::string> words;
  for (const auto& [word, value] : values) words.push_back(word);
  const auto fault = [values, is_known = oneOf(words)](std::string& text) {
    const std::string message = is_known(text);
    if (message.empty()) text = std::to_string(static_cast<std::underlying_type_t<Enum>>(values.at(text)));
    return message;
  };
  return {fault, shown, "word"};
}

/// For names of output: an empty name usually comes from an unset shell variable.
CLI::Validator named();
/// The same for all options and arguments of a program and its commands, after their other checks.
void refuseEmptyValues(CLI::App& program);
/// The option means something when it is empty; refuseEmptyValues() leaves it alone.
void mayBeEmpty(const CLI::Option& option);
/// For texts that go into a map.
CLI::Validator validText();

}  // namespace cluxel::app
