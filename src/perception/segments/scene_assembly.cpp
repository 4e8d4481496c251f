// SPDX-License-Identifier: Apache-2.0
// The second level of connected components: joins the stored components of tiles across tiles.
#include "perception/segments/scene_assembly.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <set>
#include <tuple>

#include "base/disjoint_sets.hpp"
#include "cluxel/error.hpp"
#include "perception/segments/merged_component.hpp"
#include "perception/segments/scene_relations.hpp"
#include "perception/segments/tile_fit.hpp"

namespace cluxel::perception {

namespace {

/// Consecutive numbers of items over all tiles, in key order.
class TileNumbering {
 public:
  template <typename Tiles>
  explicit TileNumbering(const Tiles& tiles) {
    for (const auto& [key, tile] : tiles) {
      base_.emplace(key, total_);
      total_ += static_cast<std::uint32_t>(tile.size());
    }
  }
  std::uint32_t of(const TileKey& key) const { return base_.at(key); }
  std::uint32_t total() const { return total_; }

 private:
  std::map<TileKey, std::uint32_t> base_;
  std::uint32_t total_ = 0;
};

/// Components joined to primitives.
struct JoinedComponents {
  std::vector<std::uint32_t> primitive_of;  ///< by component, in the order of first components
  std::vector<std::uint32_t> cut;           ///< components that continue in a tile that is not held
};

/// `apart`: tiles that are not held; what continues in those of `elsewhere` is cut.
JoinedComponents joinComponents(const TileOutputs& tiles, const TileNumbering& components, const TileSet& apart,
                                const TileSet& elsewhere) {
  JoinedComponents joined;
  DisjointSets sets(components.total());
  for (const auto& [key, tile] : tiles.contacts) {
    const auto ring = ringOf(key);
    const auto is_apart = ringAmong(apart, key), is_elsewhere = ringAmong(elsewhere, key);
    for (const Contact& contact : tile.contacts) {
      if (contact.linked_edges == 0) continue;
      const std::uint32_t from = components.of(key) + contact.from;
      if (is_elsewhere[contact.to_ring]) joined.cut.push_back(from);
      if (!is_apart[contact.to_ring]) sets.join(from, components.of(ring[contact.to_ring]) + contact.to);
    }
  }
  joined.primitive_of = sets.numbers();
  return joined;
}

/// Appends `of(i)` for each of `count` items. One field at a time is faster than all fields in turn.
template <typename Value, typename Of>
void appendEach(std::vector<Value>& all, std::size_t count, const Of& of) {
  const std::size_t first = all.size();
  all.resize(first + count);
  for (std::size_t i = 0; i < count; ++i) all[first + i] = of(static_cast<std::uint32_t>(i));
}

/// The edges of a tile that lead to a tile that is held.
FeatureTile heldEdges(const FeatureTile& graph, const std::array<bool, 9>& is_elsewhere) {
  FeatureTile held;
  held.edge_offset.push_back(0);
  for (std::uint32_t c = 0; c < graph.size(); ++c) {
    for (std::uint32_t e = graph.edge_offset[c]; e < graph.edge_offset[c + 1]; ++e)
      if (!is_elsewhere[graph.edge_target[e].ring]) held.edge_target.push_back(graph.edge_target[e]);
    held.edge_offset.push_back(static_cast<std::uint32_t>(held.edge_target.size()));
  }
  return held;
}

void appendEdges(const FeatureTile& graph, const TileOutputs& tiles, const TileKey& key, const TileNumbering& numbering,
                 SceneCluxels& all) {
  const auto ring = ringOf(key);
  std::array<std::uint32_t, 9> base{};
  for (std::size_t r = 0; r < base.size(); ++r) base[r] = tiles.summaries.contains(ring[r]) ? numbering.of(ring[r]) : 0;
  const auto first = static_cast<std::uint32_t>(all.edge_target.size());
  appendEach(all.edge_target, graph.edge_target.size(),
             [&](auto e) { return base[graph.edge_target[e].ring] + graph.edge_target[e].index; });
  const std::size_t count = graph.size();
  appendEach(all.edge_offset, count, [&](auto c) { return first + graph.edge_offset[c + 1]; });
  for (std::uint32_t c = 0; c < count; ++c) {
    const auto begin = all.edge_target.begin() + first + graph.edge_offset[c];
    const auto end = all.edge_target.begin() + first + graph.edge_offset[c + 1];
    if (!std::is_sorted(begin, end)) std::sort(begin, end);  // already sorted within a tile
  }
}

void appendSeeds(const SummaryTile& cluxels, SceneSeeds& all) {
  std::vector<std::uint32_t> scan_number;  // the scene's number of each of the tile's scans
  for (const ContentHash& scan : cluxels.scans)
    scan_number.push_back(
        static_cast<std::uint32_t>(std::lower_bound(all.scans.begin(), all.scans.end(), scan) - all.scans.begin()));
  appendEach(all.seed, cluxels.size(), [&](auto c) {
    return SeedName{scan_number[cluxels.seed_scan[c]], cluxels.seed_point[c]};
  });
}

void appendCluxels(const TileOutputs& tiles, const TileKey& key, const TileNumbering& numbering,
                   const TileSet& elsewhere, SceneCluxels& all) {
  const SummaryTile& cluxels = tiles.summaries.at(key);
  const LabelTile& labels = tiles.labels.at(key);
  const ComponentTile& components = tiles.components.at(key);
  const auto ground = ringIn(tiles.ground, key);
  const Eigen::Vector3d corner = tiles.grid.cornerOf(key);
  const std::size_t count = cluxels.size();
  const auto centre = [&](auto c) -> const Eigen::Vector3f& { return cluxels.mean[c]; };
  appendEach(all.name, count, [&](auto c) { return CluxelName{key, c}; });
  appendSeeds(cluxels, all);
  appendEach(all.center, count, [&](auto c) -> Eigen::Vector3d { return corner + centre(c).template cast<double>(); });
  appendEach(all.extent, count, [&](auto c) { return cluxels.size_m[c]; });
  appendEach(all.low_corner, count,
             [&](auto c) -> Eigen::Vector3d { return corner + cluxels.box_min[c].template cast<double>(); });
  appendEach(all.point_count, count, [&](auto c) { return cluxels.point_count[c]; });
  appendEach(all.component, count, [&](auto c) { return components.component_of[c]; });
  appendEach(all.label, count, [&](auto c) { return static_cast<scan::PrimitiveLabel>(labels.label[c]); });
  appendEach(all.probability, count, [&](auto c) { return labels.probability[c]; });
  appendEach(all.height_above_ground, count, [&](auto c) {
    return static_cast<float>(centre(c).z() - groundHeightAt(ground, centre(c).x(), centre(c).y()));
  });
  const FeatureTile& graph = tiles.features.at(key);
  const auto is_elsewhere = ringAmong(elsewhere, key);
  const bool is_inside = std::none_of(is_elsewhere.begin(), is_elsewhere.end(), [](bool away) { return away; });
  appendEdges(is_inside ? graph : heldEdges(graph, is_elsewhere), tiles, key, numbering, all);
}

std::vector<ContentHash> scansOf(const TileOutputs& tiles) {
  std::set<ContentHash> scans;
  for (const auto& [key, tile] : tiles.summaries) scans.insert(tile.scans.begin(), tile.scans.end());
  return {scans.begin(), scans.end()};
}

void reserve(SceneCluxels& all, std::size_t cluxels, std::size_t edges) {
  all.seed.reserve(cluxels);
  all.name.reserve(cluxels), all.center.reserve(cluxels), all.extent.reserve(cluxels), all.low_corner.reserve(cluxels);
  all.component.reserve(cluxels), all.point_count.reserve(cluxels), all.label.reserve(cluxels),
      all.probability.reserve(cluxels);
  all.height_above_ground.reserve(cluxels), all.edge_offset.reserve(cluxels + 1);
  all.edge_target.reserve(edges);
}

SceneCluxels gatherCluxels(const TileOutputs& tiles, const TileSet& elsewhere) {
  const TileNumbering numbering(tiles.summaries);
  SceneCluxels all;
  std::size_t edges = 0;
  for (const auto& [key, tile] : tiles.features) edges += tile.edge_target.size();
  reserve(all, numbering.total(), edges);
  all.grid = tiles.grid;
  all.scans = scansOf(tiles);
  all.edge_offset.push_back(0);
  for (const auto& [key, tile] : tiles.summaries) appendCluxels(tiles, key, numbering, elsewhere, all);
  return all;
}

/// The hash of the label and of the members' seeds, which identify a cluxel independently of the other points of its
/// tile. The hasher is called once, since a call per member costs as much as the hashing.
ContentHash nameOf(const Primitive& primitive, const SceneCluxels& cluxels) {
  struct Member {
    ContentHash scan;
    std::uint32_t point;
  };
  static_assert(std::has_unique_object_representations_v<Member>);
  std::vector<Member> members;
  members.reserve(primitive.cluxels.size());
  for (const std::uint32_t member : primitive.cluxels)
    members.push_back({cluxels.scans[cluxels.seed[member].scan], cluxels.seed[member].point});
  return ContentHasher().add(primitive.label).addBytes(members.data(), members.size() * sizeof(Member)).finish();
}

/// Sorts the primitives by id and returns the new number of each old one.
std::vector<std::uint32_t> sortById(std::vector<Primitive>& primitives) {
  std::vector<std::uint32_t> order(primitives.size()), rank(primitives.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return primitives[a].id < primitives[b].id; });
  std::vector<Primitive> sorted;
  sorted.reserve(primitives.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    rank[order[i]] = i;
    sorted.push_back(std::move(primitives[order[i]]));
  }
  primitives = std::move(sorted);
  return rank;
}

/// The numbers in `views` of the scans; both are ascending.
std::vector<std::uint32_t> viewsOf(const std::set<scan::ScanId>& scans, const std::vector<SceneView>& views) {
  std::vector<std::uint32_t> numbers;
  for (const scan::ScanId& scan : scans) {
    const auto found = std::lower_bound(views.begin(), views.end(), scan,
                                        [](const SceneView& view, const scan::ScanId& id) { return view.scan < id; });
    if (found != views.end() && found->scan == scan)
      numbers.push_back(static_cast<std::uint32_t>(found - views.begin()));
  }
  return numbers;
}

void fillPrimitives(const TileOutputs& tiles, const std::vector<std::uint32_t>& primitive_of, std::size_t count,
                    Scene& scene) {
  std::vector<MergedComponent> merged(count);
  scene.primitives.resize(count);
  std::uint32_t component = 0, cluxel = 0;
  for (const auto& [key, tile] : tiles.components) {
    for (const std::uint32_t own : tile.component_of)
      scene.primitives[primitive_of[component + own]].cluxels.push_back(cluxel++);
    for (std::size_t number = 0; number < tile.size(); ++number, ++component) {
      scene.primitives[primitive_of[component]].label =
          static_cast<scan::PrimitiveLabel>(tile.components[number].label);
      merged[primitive_of[component]].add(tile, number, tiles.grid.cornerOf(key));
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    merged[i].describe(scene.primitives[i]);
    scene.primitives[i].views = viewsOf(merged[i].scans(), scene.views);
    scene.primitives[i].id = nameOf(scene.primitives[i], scene.cluxels);
  }
}

/// All contacts between different primitives, summed in canonical order.
std::vector<PrimitiveContact> mergeContacts(const TileOutputs& tiles, const TileNumbering& components,
                                            const std::vector<std::uint32_t>& primitive_of, const TileSet& elsewhere) {
  std::vector<PrimitiveContact> all;
  for (const auto& [key, tile] : tiles.contacts) {
    const auto ring = ringOf(key);
    const auto is_elsewhere = ringAmong(elsewhere, key);
    for (const Contact& contact : tile.contacts) {
      if (is_elsewhere[contact.to_ring]) continue;
      const std::uint32_t from = primitive_of[components.of(key) + contact.from];
      const std::uint32_t to = primitive_of[components.of(ring[contact.to_ring]) + contact.to];
      if (from != to)
        all.push_back({from, to, contact.edges, contact.overlaps, contact.height_difference, contact.gap});
    }
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const auto& a, const auto& b) { return std::tie(a.from, a.to) < std::tie(b.from, b.to); });
  std::vector<PrimitiveContact> merged;
  for (const PrimitiveContact& contact : all) {
    if (merged.empty() || merged.back().from != contact.from || merged.back().to != contact.to) {
      merged.push_back(contact);
      continue;
    }
    PrimitiveContact& sum = merged.back();
    sum.edges += contact.edges, sum.overlaps += contact.overlaps;
    sum.height_difference += contact.height_difference;
    sum.gap = std::min(sum.gap, contact.gap);
  }
  return merged;
}

}  // namespace

void describe(RelationParams& params, ParameterVisitor& visitor) {
  visitor.real({"relation.touches", "m", 0, 2, "largest gap of things that touch"}, params.touches_m);
  visitor.real({"relation.near", "m", 0, 8, "largest gap of things that are near"}, params.near_m);
  visitor.real({"relation.above", "m", 0, 10, "least mean height difference of what is above"}, params.above_m);
  visitor.real({"relation.stands_on", "m", 0, 2, "largest gap of what stands on another"}, params.stands_on_m);
  visitor.real({"relation.ground", "m", 0, 5, "largest height above the ground of what touches it"}, params.ground_m);
  visitor.real({"relation.inside", "1", 0, 1, "least share of a box that lies inside"}, params.inside_share);
  visitor.real({"relation.parallel", "rad", 0, 1.5708, "largest angle of parallel things"}, params.parallel_rad);
}

SceneCluxels assembleCluxels(const TileOutputs& tiles, const TileSet& elsewhere) {
  checkFit(tiles, elsewhere);
  return gatherCluxels(tiles, elsewhere);
}

SceneSeeds seedsOf(const TileOutputs& tiles) {
  checkFit(tiles, {});
  SceneSeeds seeds;
  seeds.scans = scansOf(tiles);
  for (const auto& [key, tile] : tiles.summaries) appendSeeds(tile, seeds);
  return seeds;
}

SceneWindow assembleWindow(const TileOutputs& tiles, const TileSet& elsewhere, const TileSet& hidden,
                           const RelationParams& params, std::vector<SceneView> views) {
  const TileSet apart = unionOf(elsewhere, hidden);
  checkFit(tiles, apart);
  SceneWindow window;
  Scene& scene = window.scene;
  std::sort(views.begin(), views.end(), [](const SceneView& a, const SceneView& b) { return a.scan < b.scan; });
  scene.views = std::move(views);
  scene.cluxels = gatherCluxels(tiles, apart);
  const TileNumbering components(tiles.components);
  JoinedComponents joined = joinComponents(tiles, components, apart, elsewhere);
  std::vector<std::uint32_t>& primitive_of = joined.primitive_of;
  const auto last = std::max_element(primitive_of.begin(), primitive_of.end());
  fillPrimitives(tiles, primitive_of, last == primitive_of.end() ? 0 : *last + 1, scene);
  const std::vector<std::uint32_t> rank = sortById(scene.primitives);
  for (std::uint32_t& primitive : primitive_of) primitive = rank[primitive];
  window.is_cut.assign(scene.primitives.size(), 0);
  for (const std::uint32_t component : joined.cut) window.is_cut[primitive_of[component]] = 1;
  scene.cluxels.primitive.resize(scene.cluxels.size());
  for (PrimitiveIndex i = 0; i < scene.primitives.size(); ++i)
    for (const std::uint32_t cluxel : scene.primitives[i].cluxels) scene.cluxels.primitive[cluxel] = i;
  appendRelations(mergeContacts(tiles, components, primitive_of, apart), params, scene);
  indexRelations(scene);
  return window;
}

Scene assembleScene(const TileOutputs& tiles, const RelationParams& params, std::vector<SceneView> views) {
  return assembleWindow(tiles, {}, {}, params, std::move(views)).scene;
}

}  // namespace cluxel::perception
