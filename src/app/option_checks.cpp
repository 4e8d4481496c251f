// SPDX-License-Identifier: Apache-2.0
// Reads numbers before CLI11 does, so that each fault has a message of its own.
#include "app/option_checks.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <set>

#include "app/console/usage_fault.hpp"
#include "base/utf8.hpp"

namespace cluxel::app {

namespace {

std::set<const CLI::Option*>& optionsThatMayBeEmpty() {
  static std::set<const CLI::Option*> options;
  return options;
}

constexpr std::uint64_t kLargestWhole = std::numeric_limits<std::uint64_t>::max();

/// As CLI11 will read it.
std::optional<double> numberFrom(const std::string& text) {
  double value = 0;
  if (!CLI::detail::lexical_cast(text, value)) return std::nullopt;
  return value;
}

std::optional<std::uint64_t> wholeFrom(const std::string& text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_read = error == std::errc() && end == text.data() + text.size();
  const bool is_octal = text.size() > 1 && text.front() == '0';
  return is_read && !is_octal ? std::optional(value) : std::nullopt;
}

std::string shown(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.10g", value);
  return text.data();
}

std::string noNumber(const std::string& text) {
  return "'" + text + "' is no number";
}

/// A number for which `fits` holds. `wanted` says which these are.
template <typename Fits>
CLI::Validator number(Fits fits, const std::string& wanted, const std::string& description) {
  const auto fault = [fits, wanted](std::string& text) {
    const auto value = numberFrom(text);
    if (!value) return noNumber(text);
    return std::isfinite(*value) && fits(*value) ? std::string() : "write a number " + wanted + ", not " + text;
  };
  return {fault, description, "number"};
}

CLI::Validator wholeNumber(WholeRange range, const std::string& wanted, const std::string& description) {
  const auto fault = [range, wanted](std::string& text) {
    if (!numberFrom(text)) return noNumber(text);
    const auto value = wholeFrom(text);
    const bool fits = value && *value >= range.min && *value <= range.max;
    return fits ? std::string() : "write a whole number " + wanted + ", not " + text;
  };
  return {fault, description, "whole"};
}

}  // namespace

CLI::Validator finite() {
  return number([](double) { return true; }, "that is finite", "NUMBER");
}

CLI::Validator within(NumberRange range) {
  const std::string min = shown(range.min), max = shown(range.max);
  const auto fits = [range](double value) { return value >= range.min && value <= range.max; };
  return number(fits, "from " + min + " to " + max, min + " TO " + max);
}

CLI::Validator above0() {
  return number([](double value) { return value > 0; }, "above 0", "ABOVE 0");
}

CLI::Validator share() {
  return within({.min = 0, .max = 1});
}

CLI::Validator wholeWithin(WholeRange range) {
  const std::string min = std::to_string(range.min), max = std::to_string(range.max);
  return wholeNumber(range, "from " + min + " to " + max, min + " TO " + max);
}

CLI::Validator wholeAbove0() {
  return wholeNumber({.min = 1, .max = kLargestWhole}, "above 0", "ABOVE 0");
}

CLI::Validator whole() {
  const WholeRange all{.min = 0, .max = kLargestWhole};
  return wholeNumber(all, "from 0 to " + std::to_string(kLargestWhole), "WHOLE");
}

CLI::Validator oneOf(std::vector<double> numbers) {
  std::vector<std::string> words;
  for (const double one : numbers) words.push_back(shown(one));
  const auto fault = [numbers = std::move(numbers), words](std::string& text) {
    const auto value = numberFrom(text);
    if (value && std::find(numbers.begin(), numbers.end(), *value) != numbers.end()) return std::string();
    return "'" + text + "' is none of " + listed(words);
  };
  return {fault, "{" + listed(words) + "}", "one of"};
}

CLI::Validator oneOf(std::vector<std::string> words) {
  const std::string all = listed(words);
  const auto fault = [words = std::move(words), all](std::string& text) {
    if (std::find(words.begin(), words.end(), text) != words.end()) return std::string();
    return "'" + text + "' is none of " + all;
  };
  return {fault, "{" + all + "}", "one of"};
}

CLI::Validator named() {
  const auto fault = [](std::string& text) { return text.empty() ? std::string("the name is empty") : std::string(); };
  return {fault, "NAME", "named"};
}

void mayBeEmpty(const CLI::Option& option) {
  optionsThatMayBeEmpty().insert(&option);
}

void refuseEmptyValues(CLI::App& program) {
  const CLI::Validator filled(
      [](std::string& text) { return text.empty() ? std::string("the value is empty") : std::string(); }, "", "filled");
  for (CLI::Option* option : program.get_options([](CLI::Option*) { return true; }))
    if (option->get_expected_max() > 0 && !optionsThatMayBeEmpty().contains(option)) option->check(filled);
  for (CLI::App* command : program.get_subcommands([](CLI::App*) { return true; })) refuseEmptyValues(*command);
}

CLI::Validator validText() {
  const auto fault = [](std::string& text) {
    if (text.empty()) return std::string("the text is empty");
    return firstInvalidUtf8(text) ? std::string("the text is not UTF-8") : std::string();
  };
  return {fault, "", "valid"};
}

}  // namespace cluxel::app
