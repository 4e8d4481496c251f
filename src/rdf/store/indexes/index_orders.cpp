// SPDX-License-Identifier: Apache-2.0
// The ids of quads are dense, so that quads are counted by id rather than compared.
#include "rdf/store/indexes/index_orders.hpp"

#include <algorithm>
#include <utility>

#include "rdf/store/quad_reader_impl.hpp"

namespace cluxel::rdf {

namespace {

using Place = TermId QuadIds::*;

/// Stable. By counting, when there are not many more ids than quads.
std::vector<QuadIds> sortedBy(Place place, std::span<const QuadIds> quads) {
  std::vector<QuadIds> sorted(quads.begin(), quads.end());
  TermId last = 0;
  for (const QuadIds& quad : quads) last = std::max(last, quad.*place);
  if (last / 4 > quads.size()) {
    std::stable_sort(sorted.begin(), sorted.end(),
                     [place](const QuadIds& a, const QuadIds& b) { return a.*place < b.*place; });
    return sorted;
  }
  std::vector<std::uint32_t> next(std::size_t{last} + 1, 0);
  for (const QuadIds& quad : quads) ++next[quad.*place];
  std::uint32_t sum = 0;
  for (std::uint32_t& value : next) sum += std::exchange(value, sum);
  for (const QuadIds& quad : quads) sorted[next[quad.*place]++] = quad;
  return sorted;
}

std::vector<Key128> numbersOf(std::span<const QuadIds> quads, QuadOrder order) {
  std::vector<Key128> keys(quads.size());
  std::transform(quads.begin(), quads.end(), keys.begin(),
                 [order](const QuadIds& quad) { return toNumber(quad, order); });
  return keys;
}

}  // namespace

/// Sorting by the first place is enough, when the rest is in order: s, p, o, g gives g, s, p, o and p, s, o, g and
/// o, s, p, g, and that p, o, s, g.
std::vector<Key128> keysOf(std::span<const QuadIds> quads, QuadOrder order) {
  switch (order) {
    case QuadOrder::Posg:
      return numbersOf(sortedBy(&QuadIds::p, sortedBy(&QuadIds::o, quads)), order);
    case QuadOrder::Ospg:
      return numbersOf(sortedBy(&QuadIds::o, quads), order);
    case QuadOrder::Gspo:
      return numbersOf(sortedBy(&QuadIds::g, quads), order);
    case QuadOrder::Psog:
      return numbersOf(sortedBy(&QuadIds::p, quads), order);
    case QuadOrder::Spog:
      break;
  }
  return numbersOf(quads, order);
}

}  // namespace cluxel::rdf
