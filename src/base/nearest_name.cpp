// SPDX-License-Identifier: Apache-2.0
// Edit distance with swaps (optimal string alignment).
#include "base/nearest_name.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "base/ascii.hpp"

namespace cluxel {

std::size_t editDistance(std::string_view a, std::string_view b) {
  const std::size_t columns = b.size() + 1;
  std::vector<std::size_t> before_last(columns), last(columns), row(columns);
  for (std::size_t j = 0; j < columns; ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before_last = std::exchange(last, row);
    row[0] = i;
    for (std::size_t j = 1; j < columns; ++j) {
      const std::size_t replaced = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, replaced});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
  }
  return row.back();
}

std::optional<std::string> nearestName(std::string_view name, std::span<const std::string> known) {
  const std::string name_to_find = lowerCase(name);
  std::size_t best_distance = std::max<std::size_t>(1, name_to_find.size() / 3) + 1;
  std::optional<std::string> best;
  for (const std::string& candidate : known) {
    const std::size_t distance = editDistance(name_to_find, lowerCase(candidate));
    if (distance >= best_distance) continue;
    best_distance = distance;
    best = candidate;
  }
  return best;
}

std::string suggestion(std::string_view name, std::span<const std::string> known) {
  if (const auto nearest = nearestName(name, known)) return "did you mean '" + *nearest + "'?";
  if (known.empty() || known.size() > 16) return {};
  std::string text = "known: ";
  for (std::size_t i = 0; i < known.size(); ++i) text += (i ? ", " : "") + known[i];
  return text;
}

}  // namespace cluxel
