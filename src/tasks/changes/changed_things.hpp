// SPDX-License-Identifier: Apache-2.0
// The things that vanished or appeared between two groups of scans.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

#include "tasks/changes/change_survey.hpp"

namespace cluxel::tasks {

/// Connected cluxels that vanished or appeared together, or a part of them that did.
struct ChangedThing {
  std::vector<std::uint32_t> cluxels;   ///< numbers in the scene of the map, ascending
  std::optional<std::uint32_t> object;  ///< that most of them belong to; absent when most belong to none
  /// That object is not absent as a whole, more of it stays than changed, or other parts of it changed alike.
  bool is_part = false;
  Eigen::AlignedBox3d box{};            ///< [m, map]
  std::vector<std::uint32_t> visits{};  ///< on which it was surely there (ChangeSurvey::visits), ascending
  bool has_more_parts = false;          ///< other changes of the same kind are of the same object
};

/// What vanished and what appeared.
struct ChangedThings {
  std::vector<ChangedThing> gone, come;
};

/// A thing is a cluster of cluxels that changed alike (clustersOf), or where there is none within 0.3 m, a part of
/// cluxels (changedParts). Things that stood side by side are told apart (sheetsOf). An object of which neither tells
/// is a thing, too, when its states do (ChangeSurvey::wholes). A thing is dropped when the last visits of the time at
/// which it was there saw through it: it had left before, or has left again. A part of an object that is there at both
/// times is dropped when only visits without the object saw through the part's place, and when visits found the part
/// and saw through it in turn, three times or more: then rays miss it from some places.
ChangedThings changedThings(const ChangeSurvey& survey);

}  // namespace cluxel::tasks
