// SPDX-License-Identifier: Apache-2.0
// Later visits to a campus: cars leave, arrive and move, signs are removed, lamps replaced, hedges cut, vans hide
// things.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "simulation/site/campus.hpp"

namespace cluxel::simulation {

/// A van that hides something arrives, too. What is hidden may have left since the visit before.
enum class SiteEventKind { Left, Arrived, Moved, Replaced, Cut, Hidden };
std::string_view nameOf(SiteEventKind kind);  ///< "left"

/// One difference between a visit and the one before.
struct SiteEvent {
  SiteEventKind kind = SiteEventKind::Left;
  std::size_t visit = 0;       ///< the first visit that finds the difference; the first visit of all is 0
  std::int32_t instance = -1;  ///< the object concerned, before; -1 when it arrived
  std::int32_t new_instance =
      -1;  ///< the object afterwards: what arrived, is there after a move or a replacement, or hides it
  /// Where the difference is, when it is not the whole object [m, map]: what was cut off; of lamps that were replaced
  /// all from the head of the lower one upwards.
  Eigen::AlignedBox3d gone, come;
};

struct VisitedSite {
  /// One campus for each visit, with the surfaces and stops of that visit. All have the same list of objects, which
  /// holds those of every visit.
  std::vector<Campus> visits;
  std::vector<SiteEvent> events;
};

/// The first visit is `campus` without the objects that arrive later. A function of the campus and `count`.
VisitedSite visitSite(const Campus& campus, std::size_t count);

}  // namespace cluxel::simulation
