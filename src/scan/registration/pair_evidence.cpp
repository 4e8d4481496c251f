// SPDX-License-Identifier: Apache-2.0
// Point-to-plane distances in both directions. Directions that only noisy normals constrain get no information.
#include "scan/registration/pair_evidence.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <vector>

namespace cluxel::scan {

namespace {

/// A point of the source and its plane of the target, in the frame of the source.
struct Match {
  Eigen::Vector3d p, normal;
  double gap_m = 0;  ///< along the normal
  double flatness = 0;
};

struct Matches {
  std::vector<Match> all;
  double overlap = 0;
};

constexpr double kMinFacing = 0.7;  // of two normals: further apart they are of different surfaces

/// Matches of the points of `from` with planes of `to`, where both have one; `normal` and `gap_m` in the frame of
/// `from`.
Matches matchesOf(const SurfaceCloud& to, const SurfaceCloud& from, const Eigen::Isometry3d& T_to_from,
                  double reach_m) {
  Matches matches;
  std::size_t near = 0;
  for (const std::size_t i : from.withPlane()) {
    const Eigen::Vector3d p = T_to_from * from.point(i);
    const auto j = to.nearest(p, SurfaceCloud::kMaxReach_m);
    if (!j) continue;
    ++near;
    if (!to.hasPlane(*j) || (p - to.point(*j)).squaredNorm() > reach_m * reach_m) continue;
    const Eigen::Vector3d normal = T_to_from.linear().transpose() * to.normal(*j);
    if (std::abs(normal.dot(from.normal(i))) < kMinFacing) continue;
    const double gap_m = to.normal(*j).dot(p - to.point(*j));
    matches.all.push_back({from.point(i), normal, gap_m, std::min(to.flatness(*j), from.flatness(i))});
  }
  const std::size_t all = from.withPlane().size();
  matches.overlap = all == 0 ? 0 : static_cast<double>(near) / static_cast<double>(all);
  return matches;
}

/// The largest of three median distances, one for each principal axis of the normals. One median over all surfaces
/// would hide errors: a street is mostly ground, which does not constrain the position along the street.
double worstMedianGap(const std::vector<Match>& matches) {
  constexpr double kFlat = 0.3;
  constexpr std::size_t kFew = 50;
  Eigen::Matrix3d facing = Eigen::Matrix3d::Zero();
  for (const Match& match : matches)
    if (match.flatness > kFlat) facing += match.normal * match.normal.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(facing);
  std::array<std::vector<double>, 3> gaps_m;
  for (const Match& match : matches) {
    if (match.flatness <= kFlat) continue;
    Eigen::Index axis = 0;
    (axes.eigenvectors().transpose() * match.normal).cwiseAbs().maxCoeff(&axis);
    gaps_m[static_cast<std::size_t>(axis)].push_back(std::abs(match.gap_m));
  }
  double worst_m = 0;
  for (std::vector<double>& gaps : gaps_m)
    if (gaps.size() >= kFew) worst_m = std::max(worst_m, medianOf(std::move(gaps)));
  return worst_m;
}

/// Normal equations of the motion of the source, summed over matches.
struct Normals {
  Matrix6d information = Matrix6d::Zero();
  Vector6d pull = Vector6d::Zero();
  double weight = 0, squared_reach_m2 = 0;

  void add(const Eigen::Vector3d& p, const Eigen::Vector3d& normal, double gap_m, double w) {
    Vector6d row;
    row << normal, p.cross(normal);
    information += w * row * row.transpose();
    pull -= w * gap_m * row;
    weight += w;
    squared_reach_m2 += w * p.squaredNorm();
  }
};

double weightOf(const Match& match, double tolerance_m) {
  const double ratio = match.gap_m / tolerance_m, doubt = 1 + ratio * ratio;
  return match.flatness / (doubt * doubt);
}

/// Subtracts from the information what normals with errors of some degrees contribute in every direction.
void dropPretence(const Normals& sums, PairEvidence& evidence) {
  constexpr double kPretence = 0.01;  // mean square of a normal's part along a direction that no surface faces
  const double reach_m = std::sqrt(sums.squared_reach_m2 / sums.weight);
  Vector6d scale;
  scale << 1, 1, 1, 1 / reach_m, 1 / reach_m, 1 / reach_m;
  const Matrix6d scaled = scale.asDiagonal() * sums.information * scale.asDiagonal() / sums.weight;
  const Eigen::SelfAdjointEigenSolver<Matrix6d> axes(scaled);
  const Vector6d known = (axes.eigenvalues().array() - kPretence).cwiseMax(0);
  Vector6d along = axes.eigenvectors().transpose() * (scale.cwiseProduct(sums.pull) / sums.weight);
  for (int k = 0; k < 6; ++k) along[k] = known[k] > 0 ? along[k] / axes.eigenvalues()[k] : 0;
  const Matrix6d unscaled = scale.cwiseInverse().asDiagonal() * axes.eigenvectors();
  evidence.information = unscaled * known.asDiagonal() * unscaled.transpose();
  evidence.wish = scale.asDiagonal() * (axes.eigenvectors() * along);
}

}  // namespace

double medianOf(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

PairEvidence evidenceOf(const SurfaceCloud& target, const SurfaceCloud& source,
                        const Eigen::Isometry3d& T_target_source, const EvidenceParams& params) {
  Matches forth = matchesOf(target, source, T_target_source, params.reach_m);
  const Eigen::Isometry3d T_source_target = T_target_source.inverse();
  const Matches back = matchesOf(source, target, T_source_target, params.reach_m);
  // For a point of the target and a plane of the source the plane moves, so the sign of the gap's change is reversed.
  for (const Match& match : back.all)
    forth.all.push_back(
        {T_source_target * match.p, -(T_source_target.linear() * match.normal), match.gap_m, match.flatness});
  PairEvidence evidence;
  evidence.overlap = std::min(forth.overlap, back.overlap);
  evidence.residual_m = worstMedianGap(forth.all);
  Normals sums;
  for (const Match& match : forth.all)
    sums.add(match.p, match.normal, match.gap_m, weightOf(match, params.tolerance_m));
  if (sums.weight > 0 && sums.squared_reach_m2 > 0) dropPretence(sums, evidence);
  return evidence;
}

}  // namespace cluxel::scan
