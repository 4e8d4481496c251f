// SPDX-License-Identifier: Apache-2.0
// Looks at each end from the sensor of every scan that saw the candidate.
#include "rules/propose/unseen_ends.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace cluxel::rules {

namespace {

using perception::Attribute;

constexpr double kTopBand_m = 0.10;   // cluxels that end this far below the top belong to it
constexpr double kOnGround_m = 0.30;  // a bottom this low is the thing's own
constexpr double kOwnDepth_m = 0.30;  // what is nearer to the end than this does not hide it
constexpr double kRayWidth_m = 0.05;  // added to the boxes of cluxels that may hide an end

class EndSight {
 public:
  EndSight(const ReasoningState& state, const Candidate& candidate)
      : state_(state), all_(state.scene.cluxels), cluxels_(state.fragments.cluxelsOf(candidate)) {
    for (const FragmentIndex fragment : candidate.fragments) {
      const auto& views = state.scene.primitives[state.fragments[fragment].primitive].views;
      views_.insert(views_.end(), views.begin(), views.end());
    }
    std::sort(views_.begin(), views_.end());
    views_.erase(std::unique(views_.begin(), views_.end()), views_.end());
  }

  bool isTopUnseen() const {
    if (views_.empty()) return false;
    double top = -std::numeric_limits<double>::infinity();
    for (const std::uint32_t cluxel : cluxels_) top = std::max(top, highOf(cluxel));
    bool is_cut = false;
    for (const std::uint32_t view : views_) {
      const TopInView in_view = topIn(viewOf(view), top);
      if (in_view == TopInView::Shown) return false;
      is_cut = is_cut || in_view == TopInView::Cut;
    }
    return is_cut;
  }

  bool isBottomUnseen() const {
    if (views_.empty()) return false;
    const auto lowest = std::min_element(cluxels_.begin(), cluxels_.end(), [&](std::uint32_t a, std::uint32_t b) {
      return lowOf(a) < lowOf(b) || (lowOf(a) == lowOf(b) && all_.name[a] < all_.name[b]);
    });
    const double above_ground = static_cast<double>(all_.height_above_ground[*lowest]) - halfHeight(*lowest);
    if (above_ground <= kOnGround_m) return false;
    Eigen::Vector3d below = all_.center[*lowest];
    below.z() = lowOf(*lowest) - kBeyond_m;
    return isHiddenInAll(below, *lowest);
  }

  bool isSideUnseen() const {
    if (views_.empty()) return false;
    const Eigen::Vector2d along = longDirection();
    const auto [first, last] =
        std::minmax_element(cluxels_.begin(), cluxels_.end(), [&](std::uint32_t a, std::uint32_t b) {
          const double at_a = along.dot(all_.center[a].head<2>()), at_b = along.dot(all_.center[b].head<2>());
          return at_a < at_b || (at_a == at_b && all_.name[a] < all_.name[b]);
        });
    return isHiddenInAll(beyond(*first, -along), *first) || isHiddenInAll(beyond(*last, along), *last);
  }

 private:
  const perception::SceneView& viewOf(std::uint32_t view) const { return state_.scene.views[view]; }
  double halfHeight(std::uint32_t cluxel) const { return static_cast<double>(all_.extent[cluxel].z()) / 2; }
  double highOf(std::uint32_t cluxel) const { return all_.center[cluxel].z() + halfHeight(cluxel); }
  double lowOf(std::uint32_t cluxel) const { return all_.center[cluxel].z() - halfHeight(cluxel); }

  /// Where the highest cluxels lie in a scan's field of view. What lies above all of it was seen by another scan.
  enum class TopInView : std::uint8_t { Shown, Cut, Above };
  TopInView topIn(const perception::SceneView& view, double top) const {
    if (!view.sight.upper_edge) return TopInView::Shown;
    const Eigen::Isometry3d T_sensor_map = view.T_map_sensor.inverse(Eigen::Isometry);
    const auto aboveEdge = [&](std::uint32_t cluxel, double z) {
      Eigen::Vector3d place = all_.center[cluxel];
      place.z() = z;
      const Eigen::Vector3d direction = T_sensor_map * place - view.sight.origin;
      return perception::elevationOf_rad(direction) - view.sight.upper_edge->elevationAt_rad(direction);
    };
    TopInView found = TopInView::Shown;
    for (const std::uint32_t cluxel : cluxels_) {
      if (highOf(cluxel) < top - kTopBand_m || aboveEdge(cluxel, highOf(cluxel)) < -kEdge_rad) continue;
      if (aboveEdge(cluxel, lowOf(cluxel)) <= kEdge_rad) return TopInView::Cut;
      found = TopInView::Above;
    }
    return found;
  }

  /// The direction in plan view in which the cluxels extend most.
  Eigen::Vector2d longDirection() const {
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (const std::uint32_t cluxel : cluxels_) mean += all_.center[cluxel].head<2>();
    mean /= static_cast<double>(cluxels_.size());
    Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
    for (const std::uint32_t cluxel : cluxels_) {
      const Eigen::Vector2d d = all_.center[cluxel].head<2>() - mean;
      scatter += d * d.transpose();
    }
    return Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(scatter).eigenvectors().col(1);
  }

  Eigen::Vector3d beyond(std::uint32_t cluxel, const Eigen::Vector2d& outward) const {
    const double half = static_cast<double>(all_.extent[cluxel].head<2>().maxCoeff()) / 2;
    Eigen::Vector3d place = all_.center[cluxel];
    place.head<2>() += (half + kBeyond_m) * outward;
    return place;
  }

  bool isHiddenInAll(const Eigen::Vector3d& place, std::uint32_t end) const {
    return std::all_of(views_.begin(), views_.end(),
                       [&](std::uint32_t view) { return isHidden(viewOf(view), place, end); });
  }

  /// Whether something stands on the way from the sensor to the place.
  bool isHidden(const perception::SceneView& view, const Eigen::Vector3d& place, std::uint32_t end) const {
    const Eigen::Vector3d origin = view.T_map_sensor * view.sight.origin;
    const double range = (origin - place).head<2>().norm();
    if (range <= kOwnDepth_m) return false;
    const Eigen::Vector3d toward = (origin - place) / range;  // one metre in plan view
    const Eigen::Vector3d near = place + kOwnDepth_m * toward, far = place + std::min(range, kHiding_m) * toward;
    bool is_hidden = false;
    // The grid shows also what is farther away, up to the width of the largest cluxel of the scene.
    constexpr double kReach_m = kHiding_m + kBeyond_m;
    state_.grid.nearInPlan(end, kReach_m, [&](std::uint32_t other) {
      is_hidden = is_hidden || (meets(other, near, far) && gapBetween(all_, end, other).horizontal <= kReach_m &&
                                !std::binary_search(cluxels_.begin(), cluxels_.end(), other));
    });
    return is_hidden;
  }

  /// Whether the segment meets the box of the cluxel.
  bool meets(std::uint32_t cluxel, const Eigen::Vector3d& from, const Eigen::Vector3d& to) const {
    const Eigen::Vector3d half = (all_.extent[cluxel].cast<double>() / 2).array() + kRayWidth_m;
    const Eigen::Vector3d start = from - all_.center[cluxel], way = to - from;
    double enters = 0, leaves = 1;
    for (int i = 0; i < 3; ++i) {
      if (way[i] == 0) {
        if (std::abs(start[i]) > half[i]) return false;
        continue;
      }
      const double a = (-half[i] - start[i]) / way[i], b = (half[i] - start[i]) / way[i];
      enters = std::max(enters, std::min(a, b));
      leaves = std::min(leaves, std::max(a, b));
      if (enters > leaves) return false;
    }
    return true;
  }

  const ReasoningState& state_;
  const perception::SceneCluxels& all_;
  std::vector<std::uint32_t> cluxels_;  ///< of the candidate, ascending
  std::vector<std::uint32_t> views_;    ///< ascending
};

/// Whether the answer is the same for `value` and everything beyond it.
bool isSureBeyond(const Condition& condition, double value, double threshold, bool upwards) {
  const double infinity = std::numeric_limits<double>::infinity();
  const double upper = condition.upper ? condition.upper->value : threshold;
  switch (condition.comparison) {
    case Comparison::Between:
    case Comparison::Outside:
    case Comparison::Equal:
    case Comparison::NotEqual:
      return upwards ? value > upper : value < threshold;
    default:
      return compare(condition, value, threshold) == compare(condition, upwards ? infinity : -infinity, threshold);
  }
}

Truth truthOfAttribute(const ReasoningState& state, const Bindings& bindings, ConditionEvaluator& evaluator,
                       const Condition& condition) {
  const Truth as_measured = evaluator.holds(condition) ? Truth::Yes : Truth::No;
  if (condition.slice || !perception::isOfAnEnd(condition.attribute)) return as_measured;
  const Candidate& candidate = bindings.at(condition.of);
  Condition alone = condition;
  alone.ratio_attribute.reset();
  const auto value = evaluator.measure(alone, 0);
  if (!value) return as_measured;
  // Relative to another attribute, the threshold is compared as a share of it.
  double threshold = condition.value ? condition.value->value : 0;
  if (condition.ratio_attribute) {
    alone.of = condition.ratio_of, alone.attribute = *condition.ratio_attribute, alone.slice = condition.ratio_slice;
    const auto other = evaluator.measure(alone, 0);
    if (!other) return as_measured;
    threshold = condition.ratio * *other;
  }
  const bool upwards = condition.attribute != Attribute::Bottom;
  if (isSureBeyond(condition, *value, threshold, upwards)) return as_measured;
  return isEndUnseen(state, candidate, condition.attribute) ? Truth::Unseen : as_measured;
}

}  // namespace

Truth truthOf(const ReasoningState& state, const Bindings& bindings, ConditionEvaluator& evaluator,
              const Condition& condition) {
  using Kind = Condition::Kind;
  if (condition.kind == Kind::Attribute) return truthOfAttribute(state, bindings, evaluator, condition);
  if (condition.kind == Kind::Not) {
    const Truth truth = truthOf(state, bindings, evaluator, condition.operands.front());
    return truth == Truth::Unseen ? truth : truth == Truth::Yes ? Truth::No : Truth::Yes;
  }
  if (condition.kind != Kind::All && condition.kind != Kind::Any)
    return evaluator.holds(condition) ? Truth::Yes : Truth::No;
  const bool all = condition.kind == Kind::All;
  Truth truth = all ? Truth::Yes : Truth::No;
  for (const Condition& operand : condition.operands) {
    const Truth next = truthOf(state, bindings, evaluator, operand);
    truth = all ? std::min(truth, next) : std::max(truth, next);
    if (truth == (all ? Truth::No : Truth::Yes)) break;
  }
  return truth;
}

bool isEndUnseen(const ReasoningState& state, const Candidate& candidate, perception::Attribute attribute) {
  if (candidate.fragments.empty() || !perception::isOfAnEnd(attribute)) return false;
  const EndSight sight(state, candidate);
  switch (attribute) {
    case Attribute::Top:
      return sight.isTopUnseen();
    case Attribute::Bottom:
      return sight.isBottomUnseen();
    case Attribute::Length:
    case Attribute::HorizontalExtent:
      return sight.isSideUnseen();
    default:
      return sight.isTopUnseen() || sight.isBottomUnseen();
  }
}

}  // namespace cluxel::rules
