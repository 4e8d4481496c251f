// SPDX-License-Identifier: Apache-2.0
// Normal equations of all poses, by Eigen's sparse LDLT.
#include "scan/registration/pose_graph.hpp"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

namespace cluxel::scan {

namespace {

/// The adjoint that maps a motion of the first scan, in its frame, to the frame of the second.
Matrix6d seenBySecond(const Eigen::Isometry3d& T_first_second) {
  const Eigen::Matrix3d R = T_first_second.linear().transpose();
  const Eigen::Vector3d t = T_first_second.translation();
  Eigen::Matrix3d cross;
  cross << 0, -t.z(), t.y(), t.z(), 0, -t.x(), -t.y(), t.x(), 0;
  Matrix6d adjoint = Matrix6d::Zero();
  adjoint.topLeftCorner<3, 3>() = R;
  adjoint.topRightCorner<3, 3>() = -R * cross;
  adjoint.bottomRightCorner<3, 3>() = R;
  return adjoint;
}

/// Blocks of 6 x 6, added up in the order of the constraints.
class NormalEquations {
 public:
  explicit NormalEquations(std::size_t scans) : right_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(6 * scans))) {}

  void add(std::size_t row, std::size_t column, const Matrix6d& block) {
    for (int c = 0; c < 6; ++c)
      for (int r = 0; r < 6; ++r)
        entries_.emplace_back(static_cast<int>(6 * row) + r, static_cast<int>(6 * column) + c, block(r, c));
  }
  void pull(std::size_t row, const Vector6d& part) { right_.segment<6>(static_cast<Eigen::Index>(6 * row)) += part; }

  Eigen::VectorXd solve() const {
    Eigen::SparseMatrix<double> matrix(right_.size(), right_.size());
    matrix.setFromTriplets(entries_.begin(), entries_.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors(matrix);
    return factors.solve(right_);
  }

 private:
  std::vector<Eigen::Triplet<double>> entries_;
  Eigen::VectorXd right_;
};

void addPrior(NormalEquations& equations, std::size_t scan, const Eigen::Isometry3d& given,
              const Eigen::Isometry3d& now, const PoseGraphParams& params) {
  Vector6d trust;
  trust << Eigen::Vector3d::Constant(1 / (params.trust_m * params.trust_m)),
      Eigen::Vector3d::Constant(1 / (params.trust_rad * params.trust_rad));
  equations.add(scan, scan, trust.asDiagonal());
  equations.pull(scan, -trust.cwiseProduct(smallMotion(given.inverse() * now)));
}

void addConstraint(NormalEquations& equations, const PoseConstraint& said, const std::vector<Eigen::Isometry3d>& now,
                   const PoseGraphParams& params) {
  const double weight = 1 / (params.surface_m * params.surface_m);
  const Eigen::Isometry3d T_first_second = now[said.first].inverse() * now[said.second];
  const Vector6d moved = smallMotion(said.T_first_second.inverse() * T_first_second);
  const Vector6d pull = -weight * (said.information * moved);
  const Matrix6d information = weight * said.information;
  const Matrix6d of_first = -seenBySecond(T_first_second);
  equations.add(said.second, said.second, information);
  equations.add(said.first, said.first, of_first.transpose() * information * of_first);
  equations.add(said.first, said.second, of_first.transpose() * information);
  equations.add(said.second, said.first, information * of_first);
  equations.pull(said.second, pull);
  equations.pull(said.first, of_first.transpose() * pull);
}

}  // namespace

Eigen::Isometry3d motion(const Vector6d& xi) {
  const Eigen::Vector3d turn = xi.tail<3>();
  const double angle_rad = turn.norm();
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  if (angle_rad > 0) T.linear() = Eigen::AngleAxisd(angle_rad, turn / angle_rad).toRotationMatrix();
  T.translation() = xi.head<3>();
  return T;
}

Vector6d smallMotion(const Eigen::Isometry3d& T) {
  const Eigen::AngleAxisd turn(T.linear());
  Vector6d xi;
  xi << T.translation(), turn.angle() * turn.axis();
  return xi;
}

std::vector<Eigen::Isometry3d> solvePoseGraph(const std::vector<Eigen::Isometry3d>& given,
                                              const std::vector<Eigen::Isometry3d>& start,
                                              const std::vector<PoseConstraint>& constraints,
                                              const PoseGraphParams& params) {
  constexpr int kMaxSteps = 10;
  constexpr double kSettled = 1e-7;
  std::vector<bool> is_bound(given.size(), false);
  for (const PoseConstraint& said : constraints) is_bound[said.first] = is_bound[said.second] = true;
  std::vector<Eigen::Isometry3d> now = start;
  for (int step = 0; step < kMaxSteps; ++step) {
    NormalEquations equations(given.size());
    for (std::size_t i = 0; i < given.size(); ++i) addPrior(equations, i, given[i], now[i], params);
    for (const PoseConstraint& said : constraints) addConstraint(equations, said, now, params);
    const Eigen::VectorXd change = equations.solve();
    double largest = 0;
    for (std::size_t i = 0; i < given.size(); ++i) {
      if (!is_bound[i]) continue;
      const Vector6d xi = change.segment<6>(static_cast<Eigen::Index>(6 * i));
      now[i] = now[i] * motion(xi);
      largest = std::max(largest, xi.cwiseAbs().maxCoeff());
    }
    if (largest < kSettled) break;
  }
  return now;
}

}  // namespace cluxel::scan
