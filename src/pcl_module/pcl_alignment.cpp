// SPDX-License-Identifier: Apache-2.0
// FLANN's kd-tree, which PCL brings along, and PCL's generalised ICP. Nothing of them leaves this file.
#include "pcl_module/pcl_alignment.hpp"

#include <pcl/registration/gicp.h>
#include <pcl/search/kdtree.h>
#include <flann/flann.hpp>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <span>

#include "pcl_module/pcl_clouds.hpp"

namespace cluxel::scan {

namespace {

using Point = pcl::PointXYZ;
using Cloud = pcl::PointCloud<Point>;
using Gicp = pcl::GeneralizedIterativeClosestPoint<Point, Point>;

constexpr int kNeighbours = 20;
constexpr int kMaxIterations = 50;

SurfacePlane planeThrough(const std::vector<Eigen::Vector3f>& points, std::span<const std::size_t> indices) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const std::size_t i : indices) mean += points[i].cast<double>();
  mean /= static_cast<double>(indices.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const std::size_t i : indices) {
    const Eigen::Vector3d d = points[i].cast<double>() - mean;
    spread += d * d.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread);
  const Eigen::Vector3d size = axes.eigenvalues().cwiseMax(0);
  if (size.z() <= 0) return {};
  const double flatness = (std::sqrt(size.y()) - std::sqrt(size.x())) / std::sqrt(size.z());
  return {axes.eigenvectors().col(0), flatness};
}

/// A cloud as generalised ICP takes it.
struct GicpCloud {
  Cloud::Ptr points{new Cloud};
  pcl::search::KdTree<Point>::Ptr tree{new pcl::search::KdTree<Point>};
  Gicp::MatricesVectorPtr covariances{new Gicp::MatricesVector};  ///< thin along the normal, wide across

  explicit GicpCloud(const SurfaceCloud& cloud) {
    constexpr double kThin = 0.001;
    for (const Eigen::Vector3f& p : cloud.points()) points->emplace_back(p.x(), p.y(), p.z());
    tree->setInputCloud(points);
    covariances->reserve(cloud.size());
    for (std::size_t i = 0; i < cloud.size(); ++i)
      covariances->push_back(Eigen::Matrix3d::Identity() - (1 - kThin) * cloud.normal(i) * cloud.normal(i).transpose());
  }
};

}  // namespace

/// PCL's own search starts a team of OpenMP for each query, which takes longer than the query; FLANN answers all of
/// them in one.
std::vector<SurfacePlane> planesAt(const std::vector<Eigen::Vector3f>& points, const std::vector<std::size_t>& chosen) {
  constexpr int kLeafSize = 15;
  if (chosen.empty()) return {};
  const std::size_t count = std::min<std::size_t>(kNeighbours, points.size());
  std::vector<Eigen::Vector3f> searched = points;  // FLANN takes no constant points
  const flann::Matrix<float> rows(searched.front().data(), searched.size(), 3);
  flann::KDTreeSingleIndex<flann::L2_Simple<float>> tree(rows, flann::KDTreeSingleIndexParams(kLeafSize));
  tree.buildIndex();
  std::vector<Eigen::Vector3f> asked;
  for (const std::size_t i : chosen) asked.push_back(points[i]);
  const flann::Matrix<float> queries(asked.front().data(), asked.size(), 3);
  std::vector<std::size_t> indices(asked.size() * count);
  std::vector<float> squared(indices.size());
  flann::Matrix<std::size_t> found(indices.data(), asked.size(), count);
  flann::Matrix<float> distances(squared.data(), asked.size(), count);
  tree.knnSearch(queries, found, distances, count, flann::SearchParams(flann::FLANN_CHECKS_UNLIMITED));
  std::vector<SurfacePlane> planes;
  planes.reserve(asked.size());
  for (std::size_t i = 0; i < asked.size(); ++i)
    planes.push_back(planeThrough(points, std::span(indices).subspan(i * count, count)));
  return planes;
}

std::optional<Eigen::Isometry3d> alignedByGicp(const SurfaceCloud& target, const SurfaceCloud& source,
                                               const Eigen::Isometry3d& T_target_source, double reach_m) {
  if (std::min(target.size(), source.size()) < static_cast<std::size_t>(kNeighbours)) return std::nullopt;
  silencePcl();
  const GicpCloud from(source), to(target);
  Gicp gicp;
  gicp.setSearchMethodSource(from.tree, true);
  gicp.setSearchMethodTarget(to.tree, true);
  gicp.setInputSource(from.points);
  gicp.setInputTarget(to.points);
  gicp.setSourceCovariances(from.covariances);
  gicp.setTargetCovariances(to.covariances);
  gicp.setMaxCorrespondenceDistance(reach_m);
  gicp.setMaximumIterations(kMaxIterations);
  Cloud moved;
  gicp.align(moved, T_target_source.matrix().cast<float>());
  if (!gicp.hasConverged() || !gicp.getFinalTransformation().allFinite()) return std::nullopt;
  const Eigen::Matrix4d found = gicp.getFinalTransformation().cast<double>();
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::Quaterniond(found.topLeftCorner<3, 3>()).normalized().toRotationMatrix();
  T.translation() = found.topRightCorner<3, 1>();
  return T;
}

}  // namespace cluxel::scan
