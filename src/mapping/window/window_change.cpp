// SPDX-License-Identifier: Apache-2.0
// Compares the primitives of a window with those that the map knew there.
#include "mapping/window/window_change.hpp"

#include <algorithm>
#include <iterator>

namespace cluxel::mapping {

namespace {

using perception::PrimitiveIndex;
using perception::TileKey;

class WindowComparison {
 public:
  WindowComparison(const MapWindow& window, const OutputChanges& changes, const perception::TileSet& anew,
                   double reach_m, const InputOf& input_of)
      : window_(window), changes_(changes), anew_(anew), reach_m_(reach_m), input_of_(input_of) {}

  WindowChange run() {
    result_.is_open = openPrimitives(window_, reach_m_);
    findGone();
    markDirty();
    markUnclear();
    return std::move(result_);
  }

 private:
  const perception::Scene& scene() const { return window_.scene; }

  bool isChanged(const TileKey& tile) const { return changes_.tiles.contains(tile); }

  void markDirty() {
    for (PrimitiveIndex i = 0; i < scene().primitives.size(); ++i) {
      const auto known = window_.known.find(scene().primitives[i].id);
      const bool is_other = known == window_.known.end() || (!isUnclear(i) && known->second.input != input_of_(i));
      result_.is_dirty.push_back(is_other ? 1 : 0);
    }
    for (const TileKey& tile : anew_)
      if (const auto here = window_.primitive_of_component.find(tile); here != window_.primitive_of_component.end())
        for (const PrimitiveIndex primitive : here->second) result_.is_dirty[primitive] = 1;
  }

  /// An open primitive lacks edges here, and a cut one has another name: their hashes cannot be compared, nor can those
  /// of primitives related to a cut one. Such a primitive counts as dirty when something in it or beside it changed.
  /// Where it is open, the window then has to grow.
  void markUnclear() {
    const std::set<PrimitiveIndex> parted = partedByChange();
    std::vector<PrimitiveIndex> unchanged, beside_changed;
    for (PrimitiveIndex i = 0; i < scene().primitives.size(); ++i) {
      if (!isUnclear(i)) continue;
      const bool is_new = result_.is_open[i] == 0 && !window_.known.contains(scene().primitives[i].id);
      result_.is_dirty[i] = is_new || isInChangedTile(i) || parted.contains(i) || isNearGone(i) ? 1 : 0;
      if (result_.is_dirty[i] == 0) unchanged.push_back(i);
    }
    std::copy_if(unchanged.begin(), unchanged.end(), std::back_inserter(beside_changed), [&](PrimitiveIndex i) {
      const auto relations = scene().relationsOf(i);
      return std::any_of(relations.begin(), relations.end(), [&](const perception::Relation& relation) {
        return relation.to != i && result_.is_dirty[relation.to] != 0;
      });
    });
    for (const PrimitiveIndex i : beside_changed) result_.is_dirty[i] = 1;
  }

  bool isUnclear(PrimitiveIndex primitive) const { return result_.is_open[primitive] != 0 || isBesideCut(primitive); }

  bool isBesideCut(PrimitiveIndex primitive) const {
    const auto relations = scene().relationsOf(primitive);
    return std::any_of(relations.begin(), relations.end(),
                       [&](const perception::Relation& relation) { return window_.is_cut[relation.to] != 0; });
  }

  bool isInChangedTile(PrimitiveIndex primitive) const {
    const std::vector<std::uint32_t>& members = scene().primitives[primitive].cluxels;
    return std::any_of(members.begin(), members.end(),
                       [&](std::uint32_t c) { return isChanged(scene().cluxels.name[c].tile); });
  }

  bool isNearGone(PrimitiveIndex primitive) const {
    constexpr double kBeside_m = 2;  // more than relations look
    const perception::Primitive& own = scene().primitives[primitive];
    const Eigen::AlignedBox2d box(Eigen::Vector2d(own.min.head<2>()), Eigen::Vector2d(own.max.head<2>()));
    return std::any_of(result_.gone_boxes.begin(), result_.gone_boxes.end(),
                       [&](const auto& gone) { return gone.exteriorDistance(box) <= kBeside_m; });
  }

  /// Cut primitives that were one with something in a changed tile.
  std::set<PrimitiveIndex> partedByChange() const {
    std::set<ContentHash> in_changed;
    for (const auto& [tile, layer] : window_.layers)
      if (isChanged(tile))
        for (const TileLayer::PrimitiveHere& here : layer.primitives) in_changed.insert(here.id);
    std::set<PrimitiveIndex> parted;
    for (const auto& [tile, layer] : window_.layers) {
      if (isChanged(tile)) continue;
      const std::vector<PrimitiveIndex>& now = window_.primitive_of_component.at(tile);
      for (std::size_t c = 0; c < now.size(); ++c)
        if (window_.is_cut[now[c]] != 0 && in_changed.contains(layer.primitives[c].id)) parted.insert(now[c]);
    }
    return parted;
  }

  /// Primitives of before that go on as cut ones of the window: they pass through a tile that did not change.
  std::set<ContentHash> formerOfCut() const {
    std::set<ContentHash> ids;
    for (const auto& [tile, layer] : window_.layers) {
      if (isChanged(tile)) continue;
      const std::vector<PrimitiveIndex>& now = window_.primitive_of_component.at(tile);
      for (std::size_t c = 0; c < now.size(); ++c)
        if (window_.is_cut[now[c]] != 0) ids.insert(layer.primitives[c].id);
    }
    return ids;
  }

  void findGone() {
    std::set<ContentHash> present;
    for (const perception::Primitive& primitive : scene().primitives) present.insert(primitive.id);
    const std::set<ContentHash> cut = formerOfCut();
    std::map<ContentHash, Eigen::AlignedBox2d> boxes;
    for (const auto& [tile, layer] : window_.layers)
      for (const TileLayer::PrimitiveHere& here : layer.primitives) {
        if (present.contains(here.id) || cut.contains(here.id)) continue;
        const Eigen::Vector2d corner = window_.scene.cluxels.grid.cornerOf(tile).head<2>();
        Eigen::AlignedBox2d& box = boxes[here.id];
        box.extend(Eigen::Vector2d(corner + here.bounds.min().head<2>().cast<double>()));
        box.extend(Eigen::Vector2d(corner + here.bounds.max().head<2>().cast<double>()));
      }
    for (const auto& [id, box] : boxes) {
      result_.gone.insert(id);
      result_.gone_boxes.push_back(box);
    }
  }

  const MapWindow& window_;
  const OutputChanges& changes_;
  const perception::TileSet& anew_;
  double reach_m_;
  const InputOf& input_of_;
  WindowChange result_;
};

}  // namespace

WindowChange changeIn(const MapWindow& window, const OutputChanges& changes, const perception::TileSet& anew,
                      double reach_m, const InputOf& input_of) {
  return WindowComparison(window, changes, anew, reach_m, input_of).run();
}

}  // namespace cluxel::mapping
