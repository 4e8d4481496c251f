// SPDX-License-Identifier: Apache-2.0
// The questions of the comparison, how one is timed, and the engines that they are put to.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "rdf/file/environment.hpp"

namespace cluxel::bench {

struct Question {
  std::string name, text;
};

/// Seconds of the median run, and the rows of the answer.
struct Measure {
  double seconds = -1;       ///< below 0: no answer
  double processor = -1;     ///< seconds of processor time, which other work on the machine changes less
  std::size_t rows = 0;      ///< lines of the TSV
  double work_rows = 0;      ///< rows that all operators of our plan made together
  bool given_up = false;     ///< the seconds are a lower bound
  std::string failure = {};  ///< why there is no answer
};
using Measures = std::map<std::string, Measure>;

inline constexpr double kMaxSecondsPerQuery = 5;

inline double since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

inline double medianOf(std::vector<double> seconds) {
  std::sort(seconds.begin(), seconds.end());
  return seconds[seconds.size() / 2];
}

/// Each of `runs` once in every round, at least five rounds, or for almost half a second each: what disturbs the
/// machine, and what lies in its caches, is then the same for all. Each run gives the number of rows.
template <typename... Run>
std::array<Measure, sizeof...(Run)> measuredInTurn(Run... runs) {
  using Clock = std::chrono::steady_clock;
  std::array<Measure, sizeof...(Run)> measures;
  std::array<std::vector<double>, sizeof...(Run)> seconds, processor;
  const auto start = Clock::now();
  const auto timed = [&](std::size_t i, const auto& run) {
    const auto begin = Clock::now();
    const std::clock_t ticks = std::clock();
    measures[i].rows = run();
    seconds[i].push_back(since(begin));
    processor[i].push_back(static_cast<double>(std::clock() - ticks) / CLOCKS_PER_SEC);
  };
  while (seconds[0].size() < 5 || (seconds[0].size() < 200 && since(start) < 0.4 * sizeof...(Run))) {
    std::size_t i = 0;
    (timed(i++, runs), ...);
    if (since(start) > kMaxSecondsPerQuery * sizeof...(Run)) break;
  }
  for (std::size_t i = 0; i < measures.size(); ++i) {
    measures[i].seconds = medianOf(seconds[i]);
    measures[i].processor = medianOf(processor[i]);
  }
  return measures;
}

/// Runs at least five times, or for almost half a second; `run` gives the number of rows.
template <typename Run>
Measure measured(Run run) {
  return measuredInTurn(run).front();
}

inline std::size_t lines(std::string_view text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

/// The questions whose names contain `only`, with the prefixes in front.
std::vector<Question> readQuestions(const std::filesystem::path& file, const std::string& only);

/// This library: a reader, the text parsed and planned, the answer as TSV, anew in every run.
Measures askCluxel(const rdf::Environment& environment, const std::vector<Question>& asked);
/// The same of two stores, every question in turn of the one and the other.
std::pair<Measures, Measures> askCluxelInTurn(const rdf::Environment& small, const rdf::Environment& large,
                                              const std::vector<Question>& asked);
/// Oxigraph in node, its store in memory. `module` holds node_modules.
Measures askOxigraph(const std::filesystem::path& module, const std::filesystem::path& nt_file,
                     const std::vector<Question>& asked);
/// Rasqal over librdf's "trees", each question in a process of its own that a deadline ends.
Measures askRasqal(const std::filesystem::path& nt_file, const std::vector<Question>& asked);

}  // namespace cluxel::bench
