// SPDX-License-Identifier: Apache-2.0
// Invariant: the fragments that are alive partition the cluxels of the scene. Objects are disjoint because fragments
// are.
#include "rules/propose/fragment_table.hpp"

#include <algorithm>
#include <cassert>
#include <limits>

#include "base/parallel.hpp"
#include "base/radix_order.hpp"
#include "rules/decide/trace_recorder.hpp"

namespace cluxel::rules {

FragmentTable::FragmentTable(const perception::Scene& scene, unsigned threads)
    : scene_(scene),
      fragments_(scene.primitives.size()),
      shapes_(scene.primitives.size()),
      outlines_(scene.primitives.size()),
      hashes_(scene.primitives.size()),
      fragments_of_primitive_(scene.primitives.size()),
      fragment_of_cluxel_(scene.cluxels.size(), kFree) {
  constexpr std::size_t kTogether = 64;
  const std::size_t count = scene.primitives.size();
  parallelFor((count + kTogether - 1) / kTogether, threads, [&](std::size_t chunk) {
    const std::size_t end = std::min(count, (chunk + 1) * kTogether);
    for (std::size_t i = chunk * kTogether; i < end; ++i) addWhole(static_cast<perception::PrimitiveIndex>(i));
  });
}

/// The fragment that is the whole primitive.
void FragmentTable::addWhole(perception::PrimitiveIndex primitive) {
  Fragment& fragment = fragments_[primitive];
  fragment.primitive = primitive;
  fragment.cluxels = scene_.primitives[primitive].cluxels;
  for (const std::uint32_t cluxel : fragment.cluxels) fragment_of_cluxel_[cluxel] = primitive;
  fragments_of_primitive_[primitive] = {primitive};
  hashes_[primitive] = contentHashOf(fragment);
  measure(primitive);
}

FragmentIndex FragmentTable::add(Fragment fragment) {
  const auto index = static_cast<FragmentIndex>(fragments_.size());
  for (std::uint32_t cluxel : fragment.cluxels) fragment_of_cluxel_[cluxel] = index;
  fragments_of_primitive_[fragment.primitive].push_back(index);
  fragments_.push_back(std::move(fragment));
  shapes_.emplace_back();
  outlines_.emplace_back();
  hashes_.push_back(contentHashOf(fragments_.back()));
  measure(index);
  return index;
}

void FragmentTable::measure(FragmentIndex index) {
  const Fragment& fragment = fragments_[index];
  const perception::Primitive& primitive = scene_.primitives[fragment.primitive];
  const std::array<perception::PrimitiveIndex, 1> members{fragment.primitive};
  outlines_[index] = rules::outlineOf(scene_.cluxels, fragment.cluxels);
  shapes_[index] = isWhole(index) ? shapeOfPrimitive(primitive, scene_.cluxels)
                                  : shapeOfCluxels(scene_, fragment.cluxels, members, {}, outlines_[index]);
}

std::uint64_t FragmentTable::contentHashOf(const Fragment& fragment) const {
  const perception::SceneSeeds& seeds = scene_.cluxels;
  std::uint64_t sum = std::hash<ContentHash>()(scene_.primitives[fragment.primitive].id);
  for (const std::uint32_t cluxel : fragment.cluxels) {
    const perception::SeedName& seed = seeds.seed[cluxel];
    sum += mixed(std::hash<ContentHash>()(seeds.scans[seed.scan]), std::uint64_t{seed.point});
  }
  return sum;
}

std::uint64_t FragmentTable::hashOf(std::span<const FragmentIndex> fragments) const {
  std::uint64_t sum = 0;
  for (const FragmentIndex fragment : fragments) sum += mixed(std::uint64_t{1}, hashes_[fragment]);
  return sum;
}

bool FragmentTable::isWhole(FragmentIndex index) const {
  const Fragment& fragment = fragments_[index];
  return fragment.cluxels.size() == scene_.primitives[fragment.primitive].cluxels.size();
}

std::vector<FragmentIndex> FragmentTable::cut(FragmentIndex index, std::vector<std::vector<std::uint32_t>> parts) {
  assert(fragments_[index].alive);
  const perception::PrimitiveIndex primitive = fragments_[index].primitive;
  fragments_[index].alive = false;
  std::erase(fragments_of_primitive_[primitive], index);
  std::vector<FragmentIndex> made;
  for (auto& cluxels : parts) {
    if (cluxels.empty()) continue;
    Fragment fragment;
    fragment.primitive = primitive;
    fragment.cluxels = std::move(cluxels);
    made.push_back(add(std::move(fragment)));
  }
  return made;
}

void FragmentTable::join(FragmentIndex index, const std::vector<FragmentIndex>& others) {
  if (others.empty()) return;
  Fragment& fragment = fragments_[index];
  for (const FragmentIndex other : others) {
    assert(index != other && fragment.alive && fragments_[other].alive);
    const std::vector<std::uint32_t>& more = fragments_[other].cluxels;
    fragment.cluxels.insert(fragment.cluxels.end(), more.begin(), more.end());
    for (std::uint32_t cluxel : more) fragment_of_cluxel_[cluxel] = index;
    fragments_[other].alive = false;
    std::erase(fragments_of_primitive_[fragment.primitive], other);
  }
  std::sort(fragment.cluxels.begin(), fragment.cluxels.end());
  hashes_[index] = contentHashOf(fragment);
  measure(index);
}

bool FragmentTable::before(FragmentIndex a, FragmentIndex b) const {
  const Fragment& first = fragments_[a];
  const Fragment& second = fragments_[b];
  if (first.primitive != second.primitive)
    return scene_.primitives[first.primitive].id < scene_.primitives[second.primitive].id;
  return first.cluxels < second.cluxels;
}

Candidate FragmentTable::candidateOf(std::vector<FragmentIndex> fragments) const {
  Candidate candidate;
  std::sort(fragments.begin(), fragments.end());
  fragments.erase(std::unique(fragments.begin(), fragments.end()), fragments.end());
  candidate.fragments = std::move(fragments);
  if (candidate.fragments.size() == 1) {
    candidate.shape = shapes_[candidate.fragments.front()];
    return candidate;
  }
  candidate.shape = shapeOfAll(candidate);
  return candidate;
}

Candidate FragmentTable::extentOf(std::vector<FragmentIndex> fragments) const {
  Candidate candidate;
  std::sort(fragments.begin(), fragments.end());
  fragments.erase(std::unique(fragments.begin(), fragments.end()), fragments.end());
  candidate.fragments = std::move(fragments);
  Shape& shape = candidate.shape;
  shape.min = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  shape.max = -shape.min;
  double cluxels = 0;
  for (const FragmentIndex fragment : candidate.fragments) {
    shape.min = shape.min.cwiseMin(shapes_[fragment].min);
    shape.max = shape.max.cwiseMax(shapes_[fragment].max);
    cluxels += static_cast<double>(fragments_[fragment].cluxels.size());
  }
  shape.attributes[static_cast<std::size_t>(perception::Attribute::CluxelCount)] = cluxels;
  return candidate;
}

std::vector<FragmentIndex> FragmentTable::inCanonicalOrder(const Candidate& candidate) const {
  std::vector<FragmentIndex> ordered = candidate.fragments;
  std::sort(ordered.begin(), ordered.end(), [this](FragmentIndex a, FragmentIndex b) { return before(a, b); });
  return ordered;
}

Shape FragmentTable::shapeOfAll(const Candidate& candidate) const {
  std::vector<perception::PrimitiveIndex> members, whole;
  std::vector<const Outline*> outlines;
  for (const FragmentIndex fragment : inCanonicalOrder(candidate)) {
    const perception::PrimitiveIndex primitive = fragments_[fragment].primitive;
    // Fragments of one primitive are neighbours in canonical order.
    if (members.empty() || members.back() != primitive) members.push_back(primitive);
    if (isWhole(fragment)) whole.push_back(primitive);
    outlines.push_back(&outlines_[fragment]);
  }
  return shapeOfCluxels(scene_, cluxelsOf(candidate), members, whole, unionOf(outlines));
}

Shape FragmentTable::shapeOfSome(const Candidate& candidate, std::span<const std::uint32_t> cluxels) const {
  auto isHere = [&](std::uint32_t cluxel) { return std::binary_search(cluxels.begin(), cluxels.end(), cluxel); };
  std::vector<perception::PrimitiveIndex> members, whole;
  for (const FragmentIndex fragment : inCanonicalOrder(candidate)) {
    const std::vector<std::uint32_t>& own = fragments_[fragment].cluxels;
    if (std::none_of(own.begin(), own.end(), isHere)) continue;
    const perception::PrimitiveIndex primitive = fragments_[fragment].primitive;
    if (members.empty() || members.back() != primitive) members.push_back(primitive);
    if (isWhole(fragment) && std::all_of(own.begin(), own.end(), isHere)) whole.push_back(primitive);
  }
  return shapeOfCluxels(scene_, cluxels, members, whole);
}

std::optional<Shape> FragmentTable::shapeOfSlice(const Candidate& candidate, const SliceSpec& slice) const {
  std::vector<std::uint32_t> cluxels = cluxelsOf(candidate);
  const std::size_t all = cluxels.size();
  std::erase_if(cluxels, [&](std::uint32_t cluxel) { return !isWithin(scene_.cluxels, cluxel, slice); });
  if (cluxels.empty()) return std::nullopt;
  return cluxels.size() == all ? candidate.shape : shapeOfSome(candidate, cluxels);
}

std::vector<std::uint32_t> FragmentTable::cluxelsOf(const Candidate& candidate) const {
  std::vector<std::uint32_t> cluxels;
  for (FragmentIndex fragment : candidate.fragments)
    cluxels.insert(cluxels.end(), fragments_[fragment].cluxels.begin(), fragments_[fragment].cluxels.end());
  sortNumbers(cluxels);
  return cluxels;
}

bool isWithin(const perception::SceneCluxels& all, std::uint32_t cluxel, const SliceSpec& slice) {
  const double height = static_cast<double>(all.height_above_ground[cluxel]);
  return height >= slice.from_m && height <= slice.to_m;
}

std::vector<std::vector<std::uint32_t>> connectedBunches(const perception::SceneCluxels& all,
                                                         std::span<const std::uint32_t> cluxels) {
  std::vector<std::vector<std::uint32_t>> bunches;
  std::vector<bool> seen(cluxels.size(), false);
  auto place = [&](std::uint32_t cluxel) {
    const auto found = std::lower_bound(cluxels.begin(), cluxels.end(), cluxel);
    const bool here = found != cluxels.end() && *found == cluxel;
    return here ? static_cast<std::size_t>(found - cluxels.begin()) : cluxels.size();
  };
  for (std::size_t start = 0; start < cluxels.size(); ++start) {
    if (seen[start]) continue;
    std::vector<std::uint32_t> bunch{cluxels[start]};
    seen[start] = true;
    for (std::size_t next = 0; next < bunch.size(); ++next)
      for (std::uint32_t neighbour : all.neighbours(bunch[next])) {
        const std::size_t at = place(neighbour);
        if (at == cluxels.size() || seen[at]) continue;
        seen[at] = true;
        bunch.push_back(neighbour);
      }
    std::sort(bunch.begin(), bunch.end());
    bunches.push_back(std::move(bunch));
  }
  return bunches;
}

}  // namespace cluxel::rules
