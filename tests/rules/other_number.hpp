// SPDX-License-Identifier: Apache-2.0
// Rule texts of which one number is another.
#pragma once

#include <array>
#include <random>
#include <regex>
#include <string>
#include <utility>
#include <vector>

namespace cluxel::test {

/// What numbers of a rule text say, each with a pattern of which the last group is the number.
inline const std::vector<std::pair<std::string, std::regex>>& kindsOfNumbers() {
  static const std::vector<std::pair<std::string, std::regex>> kKinds = {
      {"attribute", std::regex("()[a-z_]+(?: of [a-z]+)? [<>]=? ([0-9.]+)(?! x)")},
      {"distance", std::regex("((?:gap|distance)(?: of [a-z]+)? to [a-zA-Z:]+) <= ([0-9.]+)")},
      {"share", std::regex("(adjacent_fraction(?: of [a-z]+)? to [a-zA-Z:]+) >= ([0-9.]+)")},
      {"ratio", std::regex("()[<>]=? ([0-9.]+) x")},
      {"lower bound", std::regex("()between ([0-9.]+)")},
      {"upper bound", std::regex("(between [0-9.]+ ?[a-z0-9]*) and ([0-9.]+)")},
      {"group", std::regex("()(?:near|horizontal|vertical): ([0-9.]+) m")},
      {"confidence", std::regex("()confidence: ([0-9.]+)")},
      {"surest", std::regex("(from: [0-9.]+, to:) ([0-9.]+), over")},
      {"curve", std::regex("(curve: \\{ [0-9.]+ ?[a-z]*:) (-?[0-9.]+)")},
      {"weight", std::regex("()weight: (-?[0-9.]+)")},
      {"budget", std::regex("()max_fraction_of_points: ([0-9.]+)")},
      {"constant", std::regex("()\\n  [a-z_]+: ([0-9.]+) m\\n")}};
  return kKinds;
}

struct OtherNumber {
  std::string text;  ///< the whole rule text
  std::string what;  ///< "distance: gap to pole <= 0.4 times 1.05"
};

/// The text with one of its numbers, of a random kind, multiplied by a random factor. It may be faulty.
inline OtherNumber withOtherNumber(const std::string& text, std::mt19937& random) {
  const auto& [kind, pattern] = kindsOfNumbers()[random() % kindsOfNumbers().size()];
  const std::vector<std::smatch> found(std::sregex_iterator(text.begin(), text.end(), pattern), std::sregex_iterator());
  const std::smatch& match = found.at(random() % found.size());
  const double factor = std::array{0.3, 0.6, 0.9, 0.98, 0.999, 1.001, 1.02, 1.1, 1.5, 2.5}[random() % 10];
  OtherNumber other{text, kind + ": " + match.str() + " times " + std::to_string(factor)};
  other.text.replace(static_cast<std::size_t>(match.position(2)), static_cast<std::size_t>(match.length(2)),
                     std::to_string(std::stod(match.str(2)) * factor));
  return other;
}

}  // namespace cluxel::test
