// SPDX-License-Identifier: Apache-2.0
// Fills boxes with cluxels, joins cluxels that touch, then measures and relates the primitives as perception does.
#include "rules/testing/box_scene.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "rules/propose/candidate.hpp"
#include "rules/propose/cluxel_grid.hpp"

namespace cluxel::rules {

namespace {

constexpr double kSpacing_m = 0.25;   // of cluxels; larger in large boxes
constexpr int kMaxBoxCluxels = 2500;  // per box
constexpr double kMeet_m = 0.10;      // cluxels with a gap up to this are joined by an edge
constexpr double kTouches_m = 0.20, kNear_m = 1.0, kAbove_m = 0.25, kInside = 0.9;

/// A cluxel before it is sorted into the scene.
struct Seedling {
  perception::CluxelName name;
  Eigen::Vector3d center;
  Eigen::Vector3f extent;
  std::size_t box = 0;
};

std::array<int, 3> cellsOf(const Eigen::Vector3d& size) {
  for (double spacing = kSpacing_m;; spacing *= 1.25) {
    std::array<int, 3> cells{};
    double count = 1;
    for (int i = 0; i < 3; ++i) {
      cells[static_cast<std::size_t>(i)] = std::max(1, static_cast<int>(std::lround(std::min(size[i], 1e4) / spacing)));
      count *= cells[static_cast<std::size_t>(i)];
    }
    if (count <= kMaxBoxCluxels) return cells;
  }
}

void fill(const BoxPrimitive& box, std::size_t number, std::uint32_t& next, std::vector<Seedling>& seedlings) {
  const auto cells = cellsOf(box.size);
  const Eigen::Vector3d step = box.size.cwiseQuotient(Eigen::Vector3d(cells[0], cells[1], cells[2]));
  const double c = std::cos(box.yaw_rad), s = std::sin(box.yaw_rad);
  const Eigen::Vector3d extent(std::abs(c) * step.x() + std::abs(s) * step.y(),
                               std::abs(s) * step.x() + std::abs(c) * step.y(), step.z());
  for (int x = 0; x < cells[0]; ++x)
    for (int y = 0; y < cells[1]; ++y)
      for (int z = 0; z < cells[2]; ++z) {
        const Eigen::Vector3d p = Eigen::Vector3d(x + 0.5, y + 0.5, z + 0.5).cwiseProduct(step) - box.size / 2;
        const Eigen::Vector3d rotated(c * p.x() - s * p.y(), s * p.x() + c * p.y(), p.z());
        const Eigen::Vector3d center = box.center + rotated;
        seedlings.push_back({{perception::TileGrid().tileOf(center), next++}, center, extent.cast<float>(), number});
      }
}

class Builder {
 public:
  explicit Builder(const BoxScene& boxes) : boxes_(boxes) {}

  BuiltBoxScene build() {
    makeViews();
    makePrimitives();
    makeCluxels();
    joinCluxels();
    for (perception::PrimitiveIndex i = 0; i < scene().primitives.size(); ++i) measure(i);
    relate();
    return std::move(built_);
  }

 private:
  perception::Scene& scene() { return built_.scene; }
  const BoxPrimitive& boxOf(perception::PrimitiveIndex i) const { return boxes_.boxes[box_of_primitive_[i]]; }

  void makeViews() {
    for (std::size_t i = 0; i < boxes_.views.size(); ++i) {
      perception::SceneView view;
      view.scan = ContentHasher().add(i).finish();
      view.T_map_sensor.translation() = boxes_.views[i].from;
      if (boxes_.views[i].up_to_rad) view.sight.upper_edge = perception::UpperEdge{*boxes_.views[i].up_to_rad, 0, 0};
      scene().views.push_back(view);
    }
  }

  static ContentHash idOf(const BoxPrimitive& box) {
    ContentHasher hasher;
    hasher.addText(box.name).add(box.label);
    for (int i = 0; i < 3; ++i) hasher.add(box.center[i]).add(box.size[i]);
    return hasher.add(box.yaw_rad).finish();
  }

  void makePrimitives() {
    const std::size_t count = boxes_.boxes.size();
    box_of_primitive_.resize(count);
    std::iota(box_of_primitive_.begin(), box_of_primitive_.end(), 0);
    std::vector<ContentHash> ids;
    for (const BoxPrimitive& box : boxes_.boxes) ids.push_back(idOf(box));
    std::sort(box_of_primitive_.begin(), box_of_primitive_.end(),
              [&](std::size_t a, std::size_t b) { return ids[a] < ids[b]; });
    scene().primitives.resize(count);
    primitive_of_box_.resize(count);
    for (perception::PrimitiveIndex i = 0; i < count; ++i) {
      scene().primitives[i].id = ids[box_of_primitive_[i]];
      scene().primitives[i].label = boxOf(i).label;
      scene().primitives[i].views.resize(boxes_.views.size());
      std::iota(scene().primitives[i].views.begin(), scene().primitives[i].views.end(), 0U);
      built_.names.push_back(boxOf(i).name);
      primitive_of_box_[box_of_primitive_[i]] = i;
    }
  }

  void makeCluxels() {
    std::vector<std::size_t> by_name(boxes_.boxes.size());
    std::iota(by_name.begin(), by_name.end(), 0);
    std::sort(by_name.begin(), by_name.end(),
              [&](std::size_t a, std::size_t b) { return boxes_.boxes[a].name < boxes_.boxes[b].name; });
    std::vector<Seedling> seedlings;
    std::uint32_t next = 0;
    for (std::size_t box : by_name) fill(boxes_.boxes[box], box, next, seedlings);
    std::sort(seedlings.begin(), seedlings.end(), [](const Seedling& a, const Seedling& b) { return a.name < b.name; });
    perception::SceneCluxels& cluxels = scene().cluxels;
    cluxels.scans = {ContentHash{}};  // all boxes together count as one scan
    for (const Seedling& seedling : seedlings) {
      const perception::PrimitiveIndex primitive = primitive_of_box_[seedling.box];
      const scan::PrimitiveLabel label = scene().primitives[primitive].label;
      scene().primitives[primitive].cluxels.push_back(static_cast<std::uint32_t>(cluxels.size()));
      cluxels.name.push_back(seedling.name);
      cluxels.seed.push_back({0, seedling.name.index});
      cluxels.center.push_back(seedling.center);
      cluxels.extent.push_back(seedling.extent);
      cluxels.low_corner.push_back(cluxels.center.back() - cluxels.extent.back().cast<double>() / 2);
      cluxels.point_count.push_back(10);
      cluxels.primitive.push_back(primitive);
      cluxels.label.push_back(label);
      std::array<float, scan::kPrimitiveLabelCount> probability;
      probability.fill(0.025F);
      probability[static_cast<std::size_t>(label)] = 0.9F;
      cluxels.probability.push_back(probability);
      cluxels.height_above_ground.push_back(static_cast<float>(seedling.center.z() - boxes_.ground_z_m));
    }
  }

  void joinCluxels() {
    const perception::SceneCluxels& cluxels = scene().cluxels;
    edges_.resize(cluxels.size());
    const CluxelGrid grid(cluxels);
    for (std::uint32_t a = 0; a < cluxels.size(); ++a)
      grid.near(a, kMeet_m, [&](std::uint32_t b) {
        if (b > a && gapBetween(cluxels, a, b).gap() <= kMeet_m) addEdge(a, b);
      });
    for (perception::PrimitiveIndex i = 0; i < scene().primitives.size(); ++i)
      if (!boxOf(i).adjacency.empty()) imposeAdjacency(i);
    scene().cluxels.edge_offset.push_back(0);
    for (const auto& targets : edges_) {
      scene().cluxels.edge_target.insert(scene().cluxels.edge_target.end(), targets.begin(), targets.end());
      scene().cluxels.edge_offset.push_back(static_cast<std::uint32_t>(scene().cluxels.edge_target.size()));
    }
  }
  void addEdge(std::uint32_t a, std::uint32_t b) {
    edges_[a].insert(b);
    edges_[b].insert(a);
  }

  /// Replaces the outward edges of a box, so that the requested shares lead to the named boxes.
  void imposeAdjacency(perception::PrimitiveIndex i) {
    dropOutwardEdges(i);
    double left = 1;
    for (const auto& [name, share] : boxOf(i).adjacency) left -= share;
    for (perception::PrimitiveIndex other = 0; other < scene().primitives.size(); ++other) {
      if (other == i) continue;
      const auto requested = boxOf(i).adjacency.find(boxOf(other).name);
      if (requested != boxOf(i).adjacency.end()) addEdges(i, other, requested->second);
    }
    const auto stranger = largestStranger(i);
    if (left > 1e-9 && stranger) addEdges(i, *stranger, left);
  }
  void dropOutwardEdges(perception::PrimitiveIndex i) {
    for (std::uint32_t a : scene().primitives[i].cluxels)
      for (auto target = edges_[a].begin(); target != edges_[a].end();) {
        const bool outward = scene().cluxels.primitive[*target] != i;
        if (outward) edges_[*target].erase(a);
        target = outward ? edges_[a].erase(target) : std::next(target);
      }
  }
  void addEdges(perception::PrimitiveIndex i, perception::PrimitiveIndex other, double share) {
    const auto& mine = scene().primitives[i].cluxels;
    const auto& theirs = scene().primitives[other].cluxels;
    const std::size_t edge_count = static_cast<std::size_t>(std::lround(share * kImposedEdges));
    for (std::size_t e = 0; e < edge_count && e < mine.size() * theirs.size(); ++e)
      addEdge(mine[e % mine.size()], theirs[(e / mine.size()) % theirs.size()]);
  }
  std::optional<perception::PrimitiveIndex> largestStranger(perception::PrimitiveIndex i) {
    std::optional<perception::PrimitiveIndex> largest;
    for (perception::PrimitiveIndex other = 0; other < scene().primitives.size(); ++other) {
      if (other == i || boxOf(i).adjacency.count(boxOf(other).name) > 0) continue;
      if (!largest || scene().primitives[other].cluxels.size() > scene().primitives[*largest].cluxels.size())
        largest = other;
    }
    return largest;
  }

  void measure(perception::PrimitiveIndex i) {
    perception::Primitive& primitive = scene().primitives[i];
    const BoxPrimitive& box = boxOf(i);
    const Shape shape = shapeOfCluxels(scene(), primitive.cluxels, {}, {});
    primitive.attributes = shape.attributes;
    auto set = [&](perception::Attribute attribute, double value) {
      primitive.attributes[static_cast<std::size_t>(attribute)] = value;
    };
    const auto [width, length] = std::minmax(box.size.x(), box.size.y());
    set(perception::Attribute::Length, length), set(perception::Attribute::HorizontalExtent, length);
    set(perception::Attribute::Width, width), set(perception::Attribute::HorizontalThickness, width);
    set(perception::Attribute::Volume, box.size.prod());
    set(perception::Attribute::ViewCount, 1);
    set(perception::Attribute::GroundContact, shape[perception::Attribute::Bottom] <= 0.3 ? 1 : 0);
    for (const auto& [attribute, value] : box.attributes) set(attribute, value);
    primitive.probabilities.fill(0.025F);
    primitive.probabilities[static_cast<std::size_t>(box.label)] = 0.9F;
    primitive.box = {box.center, box.size, box.yaw_rad};
    primitive.min = shape.min;
    primitive.max = shape.max;
    primitive.centroid = shape.centroid;
    primitive.axis = shape.axis;
    primitive.normal = shape.normal;
    primitive.ground_z = boxes_.ground_z_m;
  }

  void relate() {
    const auto gaps = smallestGaps();
    for (perception::PrimitiveIndex a = 0; a < scene().primitives.size(); ++a) {
      const double bottom = scene().primitives[a][perception::Attribute::Bottom];
      if (bottom <= kNear_m) scene().relations.push_back({perception::RelationKind::TouchesGround, a, a, bottom});
    }
    for (const auto& [pair, gap] : gaps) relatePair(pair.first, pair.second, gap);
    indexRelations(scene());
  }

  /// The smallest cluxel gap of each pair of primitives closer than kNear_m.
  std::map<std::pair<perception::PrimitiveIndex, perception::PrimitiveIndex>, double> smallestGaps() {
    const perception::SceneCluxels& cluxels = scene().cluxels;
    std::map<std::pair<perception::PrimitiveIndex, perception::PrimitiveIndex>, double> gaps;
    const CluxelGrid grid(cluxels);
    for (std::uint32_t a = 0; a < cluxels.size(); ++a)
      grid.near(a, kNear_m, [&](std::uint32_t b) {
        if (cluxels.primitive[a] == cluxels.primitive[b]) return;
        const double gap = gapBetween(cluxels, a, b).gap();
        if (gap > kNear_m) return;
        const auto [entry, fresh] = gaps.try_emplace({cluxels.primitive[a], cluxels.primitive[b]}, gap);
        if (!fresh) entry->second = std::min(entry->second, gap);
      });
    return gaps;
  }

  void relatePair(perception::PrimitiveIndex i, perception::PrimitiveIndex j, double gap) {
    const perception::Primitive& a = scene().primitives[i];
    const perception::Primitive& b = scene().primitives[j];
    const bool edge = std::any_of(a.cluxels.begin(), a.cluxels.end(), [&](std::uint32_t mine) {
      return std::any_of(edges_[mine].begin(), edges_[mine].end(),
                         [&](std::uint32_t other) { return scene().cluxels.primitive[other] == j; });
    });
    auto add = [&](perception::RelationKind kind, double measure) {
      scene().relations.push_back({kind, i, j, measure});
    };
    if (edge) add(perception::RelationKind::Intersects, gap);
    if (gap <= kTouches_m) add(perception::RelationKind::Touches, gap);
    add(perception::RelationKind::Near, gap);
    if (insideShare(a, b) >= kInside) add(perception::RelationKind::Inside, insideShare(a, b));
    relateHeights(a, b, gap, add);
  }

  static double insideShare(const perception::Primitive& a, const perception::Primitive& b) {
    const Eigen::Vector3d thin = Eigen::Vector3d::Constant(0.005);
    const Eigen::Vector3d overlap =
        ((a.max + thin).cwiseMin(b.max + thin) - (a.min - thin).cwiseMax(b.min - thin)).cwiseMax(0);
    return overlap.cwiseQuotient(a.max - a.min + 2 * thin).prod();
  }

  template <typename Add>
  static void relateHeights(const perception::Primitive& a, const perception::Primitive& b, double gap,
                            const Add& add) {
    const Eigen::Vector2d apart = (a.min - b.max).cwiseMax(b.min - a.max).head<2>();
    if (apart.maxCoeff() > 0.25) return;
    const double rise = a.centroid.z() - b.centroid.z();
    if (rise > kAbove_m) {
      add(perception::RelationKind::Above, rise);
      if (gap <= 0.3 && a.min.z() > b.centroid.z()) add(perception::RelationKind::StandsOn, gap);
    } else if (rise < -kAbove_m) {
      add(perception::RelationKind::Below, -rise);
      if (gap <= 0.3 && b.min.z() > a.centroid.z()) add(perception::RelationKind::Supports, gap);
    }
  }

  static constexpr double kImposedEdges = 100;
  const BoxScene& boxes_;
  BuiltBoxScene built_;
  std::vector<std::size_t> box_of_primitive_;
  std::vector<perception::PrimitiveIndex> primitive_of_box_;
  std::vector<std::set<std::uint32_t>> edges_;
};

}  // namespace

BuiltBoxScene sceneOfBoxes(const BoxScene& boxes) {
  return Builder(boxes).build();
}

}  // namespace cluxel::rules
