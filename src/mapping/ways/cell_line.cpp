// SPDX-License-Identifier: Apache-2.0
// Lines are smoothed over cells before they are simplified.
#include "mapping/ways/cell_line.hpp"

#include <algorithm>

namespace cluxel::mapping {

namespace {

double distanceToChord(const std::vector<Eigen::Vector3d>& line, std::size_t i, std::size_t from, std::size_t to) {
  const Eigen::Vector2d a = line[from].head<2>(), p = line[i].head<2>() - a, d = line[to].head<2>() - a;
  const double square = d.squaredNorm();
  if (square == 0) return p.norm();
  return (p - d * std::clamp(p.dot(d) / square, 0.0, 1.0)).norm();
}

}  // namespace

std::vector<Eigen::Vector3d> smoothedLine(const LineGraph& graph, const std::vector<std::uint32_t>& chain) {
  std::vector<Eigen::Vector3d> line;
  for (std::size_t i = 0; i < chain.size(); ++i) {
    const std::size_t half = std::min({kSmoothedCells, i, chain.size() - 1 - i});
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t j = i - half; j <= i + half; ++j) {
      const Eigen::Vector2d centre = centreOf(graph.place[chain[j]]);
      sum += Eigen::Vector3d(centre.x(), centre.y(), graph.height[chain[j]]);
    }
    line.emplace_back(sum / static_cast<double>(2 * half + 1));
  }
  return line;
}

std::vector<Eigen::Vector3d> simplifiedLine(const std::vector<Eigen::Vector3d>& line) {
  std::vector<std::size_t> kept{0};
  std::vector<std::size_t> open{line.size() - 1};
  while (!open.empty()) {
    const std::size_t from = kept.back(), to = open.back();
    std::size_t farthest = from;
    double most = kLineTolerance_m;
    for (std::size_t i = from + 1; i < to; ++i)
      if (const double d = distanceToChord(line, i, from, to); d > most) most = d, farthest = i;
    if (farthest != from) {
      open.push_back(farthest);
    } else {
      kept.push_back(to);
      open.pop_back();
    }
  }
  std::vector<Eigen::Vector3d> simplified;
  for (const std::size_t i : kept) simplified.push_back(line[i]);
  return simplified;
}

double lengthOf(const std::vector<Eigen::Vector3d>& line) {
  double length = 0;
  for (std::size_t i = 1; i < line.size(); ++i) length += (line[i] - line[i - 1]).head<2>().norm();
  return length;
}

}  // namespace cluxel::mapping
