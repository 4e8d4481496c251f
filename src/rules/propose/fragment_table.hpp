// SPDX-License-Identifier: Apache-2.0
// Ownership of primitives during reasoning. A primitive consists of one or more fragments; each fragment is free,
// shared, owned by an object, or left unknown.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "rules/language/rule_condition.hpp"
#include "rules/propose/outline.hpp"

namespace cluxel::rules {

using OwnerIndex = std::uint32_t;
inline constexpr OwnerIndex kFree = 0xFFFFFFFFU;
inline constexpr OwnerIndex kShared = 0xFFFFFFFEU;   ///< claimed by one or more objects, to be split among them
inline constexpr OwnerIndex kUnknown = 0xFFFFFFFDU;  ///< a rule decided to leave it unassigned

struct Fragment {
  perception::PrimitiveIndex primitive = 0;
  std::vector<std::uint32_t> cluxels;  ///< ascending
  OwnerIndex owner = kFree;
  bool alive = true;  ///< false after it was cut, or joined to another one
};

class FragmentTable {
 public:
  explicit FragmentTable(const perception::Scene& scene, unsigned threads = 1);

  const Fragment& operator[](FragmentIndex fragment) const { return fragments_[fragment]; }
  std::size_t size() const { return fragments_.size(); }
  FragmentIndex fragmentOf(std::uint32_t cluxel) const { return fragment_of_cluxel_[cluxel]; }
  /// The fragments of a primitive that are alive.
  const std::vector<FragmentIndex>& fragmentsOf(perception::PrimitiveIndex primitive) const {
    return fragments_of_primitive_[primitive];
  }
  scan::PrimitiveLabel labelOf(FragmentIndex fragment) const {
    return scene_.primitives[fragments_[fragment].primitive].label;
  }

  void setOwner(FragmentIndex fragment, OwnerIndex owner) { fragments_[fragment].owner = owner; }
  /// Replaces a fragment by new, free ones. `parts` is a partition of its cluxels, each part ascending.
  std::vector<FragmentIndex> cut(FragmentIndex fragment, std::vector<std::vector<std::uint32_t>> parts);
  /// Adds the cluxels of `others` (of the same primitive) to `fragment`, which keeps its owner.
  void join(FragmentIndex fragment, const std::vector<FragmentIndex>& others);

  /// A hash of the fragment's primitive and cluxels. It does not depend on any number of this scene.
  std::uint64_t hashOf(FragmentIndex fragment) const { return hashes_[fragment]; }
  /// The same of a set of fragments.
  std::uint64_t hashOf(std::span<const FragmentIndex> fragments) const;

  /// Canonical order: by primitive id, then by cluxels. Independent of the order of primitives in the scene.
  bool before(FragmentIndex a, FragmentIndex b) const;
  /// The candidate made of these fragments.
  Candidate candidateOf(std::vector<FragmentIndex> fragments) const;
  /// The same, but of its shape only min, max and CluxelCount are set: enough for gaps and adjacency, and cheap.
  Candidate extentOf(std::vector<FragmentIndex> fragments) const;
  /// The shape of the part of a candidate between two heights above the ground; absent when it has no cluxel there.
  std::optional<Shape> shapeOfSlice(const Candidate& candidate, const SliceSpec& slice) const;
  /// All cluxels of a candidate, ascending.
  std::vector<std::uint32_t> cluxelsOf(const Candidate& candidate) const;
  const Shape& shapeOf(FragmentIndex fragment) const { return shapes_[fragment]; }
  const Outline& outlineOf(FragmentIndex fragment) const { return outlines_[fragment]; }

 private:
  Shape shapeOfAll(const Candidate& candidate) const;
  /// The shape of `cluxels` (ascending), which are some of the candidate's.
  Shape shapeOfSome(const Candidate& candidate, std::span<const std::uint32_t> cluxels) const;
  std::vector<FragmentIndex> inCanonicalOrder(const Candidate& candidate) const;
  bool isWhole(FragmentIndex fragment) const;
  void addWhole(perception::PrimitiveIndex primitive);
  FragmentIndex add(Fragment fragment);
  void measure(FragmentIndex fragment);
  std::uint64_t contentHashOf(const Fragment& fragment) const;

  const perception::Scene& scene_;
  std::vector<Fragment> fragments_;
  std::vector<Shape> shapes_;
  std::vector<Outline> outlines_;
  std::vector<std::uint64_t> hashes_;
  std::vector<std::vector<FragmentIndex>> fragments_of_primitive_;
  std::vector<FragmentIndex> fragment_of_cluxel_;
};

/// True when the cluxel's height above the local ground is within the slice.
bool isWithin(const perception::SceneCluxels& all, std::uint32_t cluxel, const SliceSpec& slice);

/// Connected components of `cluxels` (ascending) in the cluxel graph. Each is ascending; they are ordered by their
/// first cluxel.
std::vector<std::vector<std::uint32_t>> connectedBunches(const perception::SceneCluxels& all,
                                                         std::span<const std::uint32_t> cluxels);

}  // namespace cluxel::rules
