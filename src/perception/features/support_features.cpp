// SPDX-License-Identifier: Apache-2.0
// Support features: HOR, shape, extent and density of a cluxel's neighbours in the graph. One pass over the 1-ring and
// 2-ring of each cluxel fills all of them.
#include <algorithm>
#include <cmath>

#include "perception/features/feature_groups.hpp"
#include "perception/features/oriented_residuals.hpp"

namespace cluxel::perception {
namespace {

const std::vector<std::string> kShapeNames{"linearity", "planarity", "scattering", "normal_up", "axis_up"};

void putShape(const EigenShape& shape, std::span<float> out) {
  out[0] = static_cast<float>(shape.linearity());
  out[1] = static_cast<float>(shape.planarity());
  out[2] = static_cast<float>(shape.scattering());
  out[3] = static_cast<float>(std::abs(shape.normal.z()));
  out[4] = static_cast<float>(std::abs(shape.axis.z()));
}

/// The supports of one cluxel.
struct Surroundings {
  MomentSum ring1;
  Support ring2;
  std::size_t neighbours = 0;
};

/// Sums over the members of a support relative to the cluxel's centre; the fourth lane is unused.
class SupportSum {
 public:
  void add(const Eigen::Array4f& d, const Eigen::Array4f& d_yzx, const Member& member) {
    ++count_;
    sum_ += d;
    squares_ += d * d + member.spread;
    products_ += d * d_yzx + member.spread_yzx;
  }
  MomentSum total() const {
    return {static_cast<double>(count_),
            sum_[0],
            sum_[1],
            sum_[2],
            squares_[0],
            products_[0],
            products_[2],
            squares_[1],
            products_[1],
            squares_[2]};
  }

 private:
  std::size_t count_ = 0;
  Eigen::Array4f sum_ = Eigen::Array4f::Zero(), squares_ = Eigen::Array4f::Zero(), products_ = Eigen::Array4f::Zero();
};

/// Lists supports without duplicates: each cluxel is marked with the last support that it was added to.
class SupportWalk {
 public:
  explicit SupportWalk(const FeatureInput& input)
      : input_(input), mark_(input.cluxels.size(), 0xffffffffU), members_(input.cluxels.size() + 1) {}

  /// Overwrites `found`, whose memory is reused.
  void walkAround(std::uint32_t center, Surroundings& found) {
    const auto neighbours = input_.graph.neighbours(center);
    found.neighbours = neighbours.size();
    measure(center, listMembers(center, neighbours), found);
  }

 private:
  /// Lists the cluxel, its 1-ring and its 2-ring; returns their number.
  std::size_t listMembers(std::uint32_t center, std::span<const std::uint32_t> neighbours) {
    std::size_t count = 0;
    // Branchless append: a branch would be mispredicted half of the time.
    const auto enter = [&](std::uint32_t member) {
      members_[count] = member;
      count += mark_[member] != center ? 1U : 0U;
      mark_[member] = center;
    };
    enter(center);
    for (const auto first : neighbours) enter(first);
    for (const auto first : neighbours)
      for (const auto second : input_.graph.neighbours(first)) enter(second);
    return count;
  }

  void measure(std::uint32_t center, std::size_t count, Surroundings& found) {
    const Member& own = input_.cluxels.member[center];
    Support& support = found.ring2;
    support.residual.resize(count - 1);
    float low = own.place[2], high = own.place[2];
    SupportSum sum;
    for (std::size_t i = 0; i < count; ++i) {
      const Member& member = input_.cluxels.member[members_[i]];
      const Eigen::Array4f d = member.place - own.place;
      sum.add(d, member.yzx - own.yzx, member);
      if (i > 0) support.residual.set(i - 1, d[0], d[1], d[2]);
      if (i == found.neighbours) found.ring1 = sum.total();
      low = std::min(low, member.lowZ());
      high = std::max(high, member.highZ());
    }
    support.height_low = low - own.place[2];
    support.height_high = high - own.place[2];
    support.sum = sum.total();
  }

  const FeatureInput& input_;
  std::vector<std::uint32_t> mark_, members_;
};

/// Writes groups into a row, one after the other.
class RowWriter {
 public:
  explicit RowWriter(std::span<float> row) : rest_(row) {}
  std::span<float> take(std::size_t count) {
    const auto part = rest_.subspan(0, count);
    rest_ = rest_.subspan(count);
    return part;
  }
  void put(double value) { take(1)[0] = static_cast<float>(value); }

 private:
  std::span<float> rest_;
};

/// Sizes of the cluxel and of its supports; lengths and widths are standard deviations.
void putExtents(const CluxelTile& own, std::uint32_t c, const EigenShape& ball, const EigenShape& ring1,
                const EigenShape& ring2, const Support& support, RowWriter& row) {
  const Eigen::Vector3f box = own.box_max[c] - own.box_min[c];
  row.put(std::hypot(box.x(), box.y()));
  row.put(box.z());
  row.put(ball.length(2));
  row.put(ring1.length(2));
  for (std::size_t i = 0; i < 3; ++i) row.put(ring2.length(i));
  row.put(-support.height_low);
  row.put(support.height_high);
}

void putDensities(const CluxelTile& own, std::uint32_t c, const Surroundings& around, RowWriter& row) {
  row.put(own.reach[c]);
  row.put(own.reach[c] / std::sqrt(own.ball[c].count));
  row.put(std::log2(own.ball[c].count));
  row.put(static_cast<double>(around.neighbours));
  row.put(static_cast<double>(around.ring2.residual.size()));
}

void append(std::vector<std::string>& names, const std::string& prefix, const std::vector<std::string>& more) {
  for (const auto& name : more) names.push_back(prefix + name);
}

}  // namespace

std::vector<std::string> supportColumns(const FeatureParams& params) {
  std::vector<std::string> names;
  if (params.hor) append(names, "", horColumns());
  if (params.shape)
    for (const char* support : {"shape.ball_", "shape.ring1_", "shape.ring2_"}) append(names, support, kShapeNames);
  if (params.extent)
    append(names, "metric.extent_",
           {"box_width", "box_height", "ball_rough", "ring1_rough", "ring2_length", "ring2_width", "ring2_rough",
            "ring2_below", "ring2_above"});
  if (params.density)
    append(names, "metric.density_", {"reach", "spacing", "log_points", "neighbours", "ring2_members"});
  return names;
}

void fillSupportFeatures(const FeatureInput& input, const FeatureParams& params, std::size_t column,
                         FeatureRows& rows) {
  const CluxelTile& own = input.own();
  const std::size_t count = supportColumns(params).size();
  SupportWalk walk(input);
  HorScratch scratch;
  std::array<Surroundings, 2> pair;  // two at a time: their four shapes are solved at once
  const auto fillRow = [&](std::uint32_t c, const Surroundings& around, const EigenShape& ring1,
                           const EigenShape& ring2) {
    const EigenShape& ball = input.ball[input.cluxels.own_begin + c];
    RowWriter row(rows.row(c, column, count));
    if (params.hor) fillHor(around.ring2, ring2, scratch, row.take(kHorColumns));
    if (params.shape)
      for (const auto* shape : {&ball, &ring1, &ring2}) putShape(*shape, row.take(kShapeNames.size()));
    if (params.extent) putExtents(own, c, ball, ring1, ring2, around.ring2, row);
    if (params.density) putDensities(own, c, around, row);
  };
  for (std::size_t first = 0; first < input.chosen.size(); first += 2) {
    const std::size_t some = std::min<std::size_t>(2, input.chosen.size() - first);
    std::array<Covariance, 4> covariances{};
    for (std::size_t i = 0; i < some; ++i) {
      walk.walkAround(input.cluxels.own_begin + input.chosen[first + i], pair[i]);
      covariances[2 * i] = covarianceOf(pair[i].ring1);
      covariances[2 * i + 1] = covarianceOf(pair[i].ring2.sum);
    }
    const auto shapes = shapesOf({covariances.data(), 2 * some});
    for (std::size_t i = 0; i < some; ++i) fillRow(input.chosen[first + i], pair[i], shapes[2 * i], shapes[2 * i + 1]);
  }
}

}  // namespace cluxel::perception
