// SPDX-License-Identifier: Apache-2.0
// Neighbours by distance, a shortest spanning forest, and partners at doubling distances.
#include "scan/registration/scan_pairing.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <tuple>

namespace cluxel::scan {

namespace {

struct Neighbour {
  double distance_m = 0;
  std::size_t scan = 0;
  bool operator<(const Neighbour& other) const {
    return std::tie(distance_m, scan) < std::tie(other.distance_m, other.scan);
  }
};

/// Scans whose boxes overlap that of scan `i`, nearest first; equal distances by number.
std::vector<Neighbour> neighboursOf(std::size_t i, const std::vector<ScanPlace>& places) {
  std::vector<Neighbour> found;
  for (std::size_t j = 0; j < places.size(); ++j)
    if (j != i && places[i].box.intersects(places[j].box))
      found.push_back({(places[j].position - places[i].position).norm(), j});
  std::sort(found.begin(), found.end());
  return found;
}

ScanPair pairOf(std::size_t a, std::size_t b) {
  return {std::min(a, b), std::max(a, b)};
}

/// Prim's algorithm, from the smallest number not yet reached: ties go to smaller numbers.
void addSpanningForest(const std::vector<ScanPlace>& places, std::set<ScanPair>& pairs) {
  constexpr double kUnreached = std::numeric_limits<double>::infinity();
  std::vector<double> distance_m(places.size(), kUnreached);
  std::vector<std::size_t> from(places.size());
  std::vector<bool> is_in(places.size(), false);
  for (std::size_t round = 0; round < places.size(); ++round) {
    std::size_t next = places.size();
    for (std::size_t i = 0; i < places.size(); ++i)
      if (!is_in[i] && (next == places.size() || distance_m[i] < distance_m[next])) next = i;
    is_in[next] = true;
    if (distance_m[next] < kUnreached) pairs.insert(pairOf(from[next], next));
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (is_in[i] || !places[i].box.intersects(places[next].box)) continue;
      const double d = (places[i].position - places[next].position).norm();
      if (d < distance_m[i]) std::tie(distance_m[i], from[i]) = std::tie(d, next);
    }
  }
}

}  // namespace

std::vector<ScanPair> nearestPairs(const std::vector<ScanPlace>& places) {
  constexpr std::size_t kNearest = 2;
  std::set<ScanPair> pairs;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const std::vector<Neighbour> near = neighboursOf(i, places);
    for (std::size_t k = 0; k < std::min(kNearest, near.size()); ++k) pairs.insert(pairOf(i, near[k].scan));
  }
  addSpanningForest(places, pairs);
  return {pairs.begin(), pairs.end()};
}

std::vector<ScanPair> widerPairs(const std::vector<ScanPlace>& places, double reach_m) {
  constexpr int kPerDoubling = 2;
  constexpr double kMinStep_m = 0.5;
  const std::vector<ScanPair> nearest = nearestPairs(places);
  std::set<ScanPair> pairs(nearest.begin(), nearest.end());
  for (std::size_t i = 0; i < places.size(); ++i) {
    double bound_m = 0;
    int left = 0;
    for (const Neighbour& near : neighboursOf(i, places)) {
      if (near.distance_m > reach_m) break;
      for (; near.distance_m >= bound_m; left = kPerDoubling)
        bound_m = std::max(2 * bound_m, 2 * std::max(near.distance_m, kMinStep_m));
      if (left-- > 0) pairs.insert(pairOf(i, near.scan));
    }
  }
  return {pairs.begin(), pairs.end()};
}

}  // namespace cluxel::scan
