// SPDX-License-Identifier: Apache-2.0
// Ways to look for the targets of a campus: Cluxel's search, two sweeps, and the shortest tour to known targets.
#pragma once

#include <cstdint>
#include <vector>

#include "search_world.hpp"
#include "tasks/ways/way_search.hpp"

namespace cluxel::bench {

/// A robot on its way. It believes the map, and corrects what it sees.
class Walker {
 public:
  /// `knows_ground`: the belief is the truth from the start.
  explicit Walker(const SearchWorld& world, bool knows_ground = false);

  /// Walks to a cell and looks every metre, until 80 % of the targets are found or `isEnough` holds. False when no way
  /// leads there. `ways`: from here, when they are known already.
  template <typename Enough>
  bool walkTo(std::uint32_t goal, const Enough& isEnough, const tasks::CheapestWays* ways = nullptr);
  bool isDone() const { return found_ >= wanted_; }
  double length_m() const { return length_m_; }
  std::uint32_t at() const { return at_; }
  const tasks::PassableGrid& belief() const { return belief_; }
  const tasks::SightGrid& sight() const { return sight_; }
  /// Per cell, how near it was looked at [m]; infinite: not at all.
  const std::vector<float>& nearest() const { return nearest_; }
  /// Cells that were in sight since this was called last, ascending.
  std::vector<std::uint32_t> takeSeen();
  void look();
  /// Takes for open what the map calls closed or a step and was not looked at: the map may be wrong. False when there
  /// is nothing left to doubt.
  bool doubtMap();
  bool isFound(std::size_t target) const { return is_found_[target]; }
  const SearchWorld& world() const { return world_; }

 private:
  bool isBlocked(std::uint32_t next);

  const SearchWorld& world_;
  tasks::PassableGrid belief_;
  tasks::SightGrid sight_;
  std::uint32_t at_ = 0;
  double length_m_ = 0, looked_at_m_ = 0;
  std::vector<float> nearest_;
  std::vector<std::uint32_t> seen_;
  std::vector<bool> is_found_;
  std::size_t found_ = 0, wanted_ = 0;
};

/// The length of the walk until 80 % of the targets are found [m].
double searchLength(const SearchWorld& world, const std::vector<rdf::UsualPlace>& places);
/// To the nearest ground that was not looked at. `spares_known`: ground within view of the map's scans comes last.
double frontierLength(const SearchWorld& world, bool spares_known);
/// Along lanes that lie 1.8 views apart, to and fro.
double lanesLength(const SearchWorld& world);
/// From target to target: the shortest order to up to 12, else always to the nearest.
double knowingLength(const SearchWorld& world);

}  // namespace cluxel::bench
