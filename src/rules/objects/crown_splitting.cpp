// SPDX-License-Identifier: Apache-2.0
// Multi-source Dijkstra (Boost.Graph): all trunks are sources, the vertices are the cluxels of the crown.
#include "rules/objects/crown_splitting.hpp"

#include <algorithm>
#include <boost/graph/dijkstra_shortest_paths_no_color_map.hpp>
#include <boost/property_map/function_property_map.hpp>
#include <cmath>
#include <compare>
#include <limits>
#include <tuple>

#include "rules/propose/cluxel_grid.hpp"

namespace cluxel::rules {

namespace {

constexpr double kJumpPenalty = 2.0;
constexpr double kTop_m = 0.5;
constexpr double kRounding_m = 1e-6;  // half diagonals are rounded to floats

/// Crown cluxels that the search has not settled yet, in columns ordered by height. Finds pairs across gaps that no
/// edge of the cluxel graph bridges.
class JumpGrid {
 public:
  struct Entry {
    Eigen::Vector3d centre;
    double half_m = 0;   ///< half of the box's diagonal
    std::size_t at = 0;  ///< number in the crown
  };

  /// `jump_m` is the largest gap that is looked for.
  JumpGrid(const perception::SceneCluxels& all, std::span<const std::uint32_t> crown, double jump_m) {
    for (const std::uint32_t cluxel : crown)
      widest_half_m_ = std::max(widest_half_m_, static_cast<double>(all.extent[cluxel].norm()) / 2);
    cell_m_ = std::max(jump_m / 2 + widest_half_m_, 0.05);
    std::vector<std::tuple<std::int64_t, std::int64_t, double, std::size_t>> order;
    order.reserve(crown.size());
    for (std::size_t i = 0; i < crown.size(); ++i) {
      const Eigen::Vector3d& centre = all.center[crown[i]];
      order.emplace_back(cellOf(centre.x()), cellOf(centre.y()), centre.z(), i);
    }
    std::sort(order.begin(), order.end());
    entries_.reserve(order.size());
    for (const auto& [x, y, z, i] : order) {
      const auto next = static_cast<std::uint32_t>(entries_.size());
      if (columns_.empty() || columns_.back().x != x || columns_.back().y != y) columns_.push_back({x, y, next, next});
      columns_.back().end = next + 1;
      entries_.push_back({all.center[crown[i]], static_cast<double>(all.extent[crown[i]].norm()) / 2, i});
    }
  }

  /// Calls `visit` for every cluxel of which half of the diagonal may reach to within `distance_m` of the point.
  template <typename Visit>
  void near(const Eigen::Vector3d& p, double distance_m, const Visit& visit) const {
    const double reach = distance_m + widest_half_m_;
    const std::int64_t last_y = cellOf(p.y() + reach);
    for (std::int64_t x = cellOf(p.x() - reach); x <= cellOf(p.x() + reach); ++x)
      for (auto column = firstColumn(x, cellOf(p.y() - reach));
           column != columns_.end() && column->x == x && column->y <= last_y; ++column)
        for (auto entry = firstAbove(*column, p.z() - reach);
             entry != entries_.begin() + column->end && entry->centre.z() <= p.z() + reach; ++entry)
          visit(*entry);
  }

  void remove(const Eigen::Vector3d& centre, std::size_t at) {
    const std::int64_t x = cellOf(centre.x()), y = cellOf(centre.y());
    Column& column = columns_[static_cast<std::size_t>(firstColumn(x, y) - columns_.begin())];
    const auto begin = entries_.begin() + column.begin, end = entries_.begin() + column.end;
    const auto entry = std::find_if(begin, end, [at](const Entry& known) { return known.at == at; });
    if (entry == end) return;
    std::move(entry + 1, end, entry);
    --column.end;
  }

 private:
  struct Column {
    std::int64_t x = 0, y = 0;
    std::uint32_t begin = 0, end = 0;  ///< in entries_
  };

  std::int64_t cellOf(double coordinate_m) const {
    return static_cast<std::int64_t>(std::floor(coordinate_m / cell_m_));
  }
  std::vector<Column>::const_iterator firstColumn(std::int64_t x, std::int64_t y) const {
    return std::lower_bound(columns_.begin(), columns_.end(), std::pair(x, y),
                            [](const Column& column, const auto& xy) { return std::pair(column.x, column.y) < xy; });
  }
  std::vector<Entry>::const_iterator firstAbove(const Column& column, double z) const {
    return std::lower_bound(entries_.begin() + column.begin, entries_.begin() + column.end, z,
                            [](const Entry& entry, double low) { return entry.centre.z() < low; });
  }

  double widest_half_m_ = 0, cell_m_ = 0;
  std::vector<Column> columns_;  ///< ordered by x, then y
  std::vector<Entry> entries_;
};

/// Length of a path and the number of its source. Shorter paths come first; of equal ones, the smaller source number.
struct Way {
  double length = 0;
  std::uint32_t source = 0;
  auto operator<=>(const Way&) const = default;
};
constexpr Way kNoWay{std::numeric_limits<double>::infinity(), kNoSource};

Way onward(const Way& so_far, const Way& step) {
  return {so_far.length + step.length, step.source};
}

/// The crown as an incidence graph for Boost.Graph, with one extra vertex from which all trunks are reached. Out-edges
/// are computed on demand: clearance, reach and jump differ by source, so they depend on the path found so far.
class CrownGraph {
 public:
  struct Edge {
    std::size_t from = 0, to = 0;
    Way step;
  };
  using vertex_descriptor = std::size_t;
  using edge_descriptor = Edge;
  using out_edge_iterator = std::vector<Edge>::const_iterator;
  using degree_size_type = std::size_t;
  using directed_category = boost::directed_tag;
  using edge_parallel_category = boost::allow_parallel_edge_tag;
  using traversal_category = boost::incidence_graph_tag;

  CrownGraph(const perception::SceneCluxels& all, std::span<const std::uint32_t> crown,
             std::span<const CrownSource> sources)
      : all_(all),
        crown_(crown),
        sources_(sources),
        grid_(all, crown, longestJump(sources)),
        place_(all.size(), kNowhere),
        best_(crown.size() + 1, kNoWay) {
    for (std::size_t i = 0; i < crown.size(); ++i) place_[crown[i]] = static_cast<std::uint32_t>(i);
    for (const CrownSource& source : sources) tops_.push_back(topOf(all, source.trunk));
    best_[start()] = {};
  }

  std::size_t start() const { return crown_.size(); }
  /// Shortest known path to each vertex; the search updates it.
  std::vector<Way>& best() { return best_; }

  /// Valid until the next call. The search asks once for each vertex, when its shortest path is known: no path through
  /// it is looked for later.
  const std::vector<Edge>& edgesFrom(std::size_t at) const {
    edges_.clear();
    from_ = at;
    if (at != start()) {
      grid_.remove(all_.center[crown_[at]], at);
      stepFrom(crown_[at], best_[at]);
    } else {
      for (std::uint32_t s = 0; s < sources_.size(); ++s) leave(s);
    }
    return edges_;
  }

 private:
  static double longestJump(std::span<const CrownSource> sources) {
    double longest = 0;
    for (const CrownSource& source : sources) longest = std::max(longest, source.jump_m);
    return longest;
  }

  /// Paths start at the trunk's cluxels above the clearance, or at its highest ones when none is above it.
  void leave(std::uint32_t s) const {
    const CrownSource& source = sources_[s];
    std::vector<std::uint32_t> from;
    double highest = -std::numeric_limits<double>::infinity();
    for (std::uint32_t cluxel : source.trunk) {
      highest = std::max(highest, all_.center[cluxel].z());
      if (static_cast<double>(all_.height_above_ground[cluxel]) >= source.clearance_m) from.push_back(cluxel);
    }
    if (from.empty())
      for (std::uint32_t cluxel : source.trunk)
        if (all_.center[cluxel].z() >= highest - kTop_m) from.push_back(cluxel);
    for (std::uint32_t cluxel : from) stepFrom(cluxel, {0, s});
    if (source.start_m > source.jump_m) leapFrom(from, s);
  }

  /// Edges from the trunk to crown cluxels that are farther than a jump but within start_m.
  void leapFrom(const std::vector<std::uint32_t>& from, std::uint32_t s) const {
    for (std::size_t to = 0; to < crown_.size(); ++to) {
      if (isBeyond(to, s)) continue;
      double shortest = std::numeric_limits<double>::infinity();
      for (std::uint32_t cluxel : from)
        if (const double distance = (all_.center[crown_[to]] - all_.center[cluxel]).norm();
            distance < shortest && gapBetween(all_, cluxel, crown_[to]).gap() <= sources_[s].start_m)
          shortest = distance;
      if (std::isfinite(shortest)) addEdge(to, {kJumpPenalty * shortest, s});
    }
  }

  /// Edges of the cluxel graph and jumps over gaps. Vertices that already have a shorter path are skipped.
  void stepFrom(std::uint32_t cluxel, const Way& so_far) const {
    const Eigen::Vector3d& from = all_.center[cluxel];
    for (std::uint32_t neighbour : all_.neighbours(cluxel)) {
      const std::size_t to = place_[neighbour];
      if (to != kNowhere && best_[to] > so_far) addEdge(to, {(all_.center[neighbour] - from).norm(), so_far.source});
    }
    const double jump = sources_[so_far.source].jump_m;
    const double reach = jump + static_cast<double>(all_.extent[cluxel].norm()) / 2 + kRounding_m;
    grid_.near(from, reach, [&](const JumpGrid::Entry& other) {
      // Most pairs are too far apart, or have a shorter path: both are known before the gap is measured.
      const double square = (other.centre - from).squaredNorm();
      if (square > (reach + other.half_m) * (reach + other.half_m)) return;
      const Way step{kJumpPenalty * (other.centre - from).norm(), so_far.source};
      if (best_[other.at] > onward(so_far, step) && gapBetween(all_, cluxel, crown_[other.at]).gap() <= jump)
        addEdge(other.at, step);
    });
  }

  void addEdge(std::size_t to, const Way& step) const {
    const CrownSource& source = sources_[step.source];
    if (static_cast<double>(all_.height_above_ground[crown_[to]]) < source.clearance_m || isBeyond(to, step.source))
      return;
    if (source.may_take && !source.may_take(crown_[to])) return;
    edges_.push_back({from_, to, step});
  }

  bool isBeyond(std::size_t to, std::uint32_t s) const {
    return (all_.center[crown_[to]].head<2>() - tops_[s]).norm() > sources_[s].reach_m;
  }

  const perception::SceneCluxels& all_;
  std::span<const std::uint32_t> crown_;
  std::span<const CrownSource> sources_;
  mutable JumpGrid grid_;
  static constexpr std::uint32_t kNowhere = 0xFFFFFFFFU;
  std::vector<std::uint32_t> place_;  ///< in the crown, by cluxel
  std::vector<Eigen::Vector2d> tops_;
  std::vector<Way> best_;
  mutable std::vector<Edge> edges_;  ///< of the vertex from_
  mutable std::size_t from_ = 0;
};

// The free functions of Boost.Graph's IncidenceGraph concept, found by argument-dependent lookup.
std::size_t source(const CrownGraph::Edge& edge, const CrownGraph&) {
  return edge.from;
}
std::size_t target(const CrownGraph::Edge& edge, const CrownGraph&) {
  return edge.to;
}
std::pair<CrownGraph::out_edge_iterator, CrownGraph::out_edge_iterator> out_edges(std::size_t at,
                                                                                  const CrownGraph& graph) {
  const auto& edges = graph.edgesFrom(at);
  return {edges.begin(), edges.end()};
}

}  // namespace

Eigen::Vector2d topOf(const perception::SceneCluxels& all, std::span<const std::uint32_t> trunk) {
  double highest = -std::numeric_limits<double>::infinity();
  for (std::uint32_t cluxel : trunk) highest = std::max(highest, all.center[cluxel].z());
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double count = 0;
  for (std::uint32_t cluxel : trunk)
    if (all.center[cluxel].z() >= highest - kTop_m) {
      sum += all.center[cluxel].head<2>();
      count += 1;
    }
  return count == 0 ? sum : Eigen::Vector2d(sum / count);
}

std::vector<std::uint32_t> splitCrown(const perception::SceneCluxels& all, std::span<const std::uint32_t> crown,
                                      std::span<const CrownSource> sources) {
  CrownGraph graph(all, crown, sources);
  const auto places = boost::typed_identity_property_map<std::size_t>();
  boost::dijkstra_shortest_paths_no_color_map_no_init(
      graph, graph.start(), boost::dummy_property_map(),
      boost::make_iterator_property_map(graph.best().begin(), places),
      boost::make_function_property_map<CrownGraph::Edge, Way>([](const CrownGraph::Edge& edge) { return edge.step; }),
      places, std::less<>(), onward, kNoWay, Way(), boost::dijkstra_visitor<>());
  std::vector<std::uint32_t> taken;
  for (std::size_t at = 0; at < crown.size(); ++at) taken.push_back(graph.best()[at].source);
  return taken;
}

}  // namespace cluxel::rules
