// SPDX-License-Identifier: Apache-2.0
// Scenes before and after a change, and the check that a run around the change gives what the whole run gives.
#pragma once

#include <map>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "rules/box_world.hpp"
#include "rules/decide/local_run.hpp"

namespace cluxel::testing {

/// A number of [low, high).
double within(std::mt19937& random, double low, double high);

/// Shared crowns that are split and gathered, groups with limits, rivals, related joins, finds, absorbing at both
/// times.
RuleSet smallRules();
/// The shipped rules with a ground that is decided part by part.
RuleSet rulesOfLoneGround();
/// Things of all kinds along a street of this length, so dense that they touch, but with some gaps.
BoxScene randomStreet(std::mt19937& random, double length_m, double things_per_m);

/// Two scenes with common primitives, the change between them being near one place.
struct ChangedScene {
  Scene before, after;
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
};

/// All primitives of `all` but some near the place; others near it are in the second scene only.
ChangedScene changeOf(const Scene& all, const Eigen::Vector2d& place, double around_m, std::mt19937& random);

/// The part of the new scene within a distance of the place, as input of a local run.
struct Window {
  Scene scene;
  std::vector<char> is_dirty, is_open;
  std::vector<Eigen::AlignedBox2d> gone;
  std::vector<std::optional<std::uint64_t>> stored_trace;
  LocalInput input() const { return {scene, is_dirty, is_open, gone, stored_trace}; }
};
Window windowOf(const ChangedScene& change, const ReasoningResult& before, double around_m, double reach_m);

/// An object by its content: id, rule and confidence; class-wide objects by their members.
using KnownObjects = std::set<std::string>;
KnownObjects objectsIn(const Scene& scene, const ReasoningResult& result, const RuleSet& rules);

/// What the outcome and the run before say together.
struct Glued {
  KnownObjects objects;
  std::map<ContentHash, std::uint64_t> traces;  ///< by primitive
};
Glued gluedOf(const ChangedScene& change, const ReasoningResult& before, const Window& window,
              const LocalOutcome& outcome, const RuleSet& rules);

std::map<ContentHash, std::uint64_t> tracesOf(const Scene& scene, const std::vector<std::uint64_t>& traces);

}  // namespace cluxel::testing
