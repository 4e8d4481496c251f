// SPDX-License-Identifier: Apache-2.0
// Times each optimisation and its plain alternative in alternating rounds of one run.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "scan/scan.hpp"

namespace cluxel::bench {

/// One way to compute the same values.
struct Side {
  std::string name;
  std::function<std::size_t()> run;  ///< returns a checksum of the result
};

struct Comparison {
  std::string what;         ///< what is computed, and on which data
  std::string stage;        ///< the stage that it is a part of
  double stage_s = 0;       ///< processor time of that stage; 0 when it is the whole
  std::vector<Side> sides;  ///< the one in use first
};

/// Trees, pair costs, eigenvectors and sort orders on the stages' outputs of `scans`.
std::vector<Comparison> stageComparisons(const std::vector<scan::Scan>& scans);
/// Lookups in a generated quad store, with and without the page directory and announcements.
std::vector<Comparison> lookupComparisons();

/// Keeps `value` alive until the process ends; the sides of comparisons refer to it.
template <typename T>
const T& kept(T value) {
  static std::vector<std::unique_ptr<const T>> all;
  return *all.emplace_back(std::make_unique<const T>(std::move(value)));
}

}  // namespace cluxel::bench
