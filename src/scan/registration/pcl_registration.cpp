// SPDX-License-Identifier: Apache-2.0
// FLANN's kd-tree, which PCL brings along, and PCL's generalised ICP. Nothing of them leaves this file.
#include "scan/registration/pcl_registration.hpp"

#include <pcl/registration/gicp.h>
#include <pcl/search/kdtree.h>
#include <flann/flann.hpp>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <span>

#include "scan/formats/pcl_clouds.hpp"

namespace cluxel::scan {

namespace {

using Point = pcl::PointXYZ;
using Cloud = pcl::PointCloud<Point>;

using Gicp = pcl::GeneralizedIterativeClosestPoint<Point, Point>;

constexpr int kNeighbours = 20;
constexpr int kMaxIterations = 50;

struct Plane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double flatness = 0;
};

Eigen::Vector3d positionOf(const Point& point) {
  return {point.x, point.y, point.z};
}

Plane planeThrough(const Cloud& cloud, std::span<const std::size_t> indices) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const std::size_t i : indices) mean += positionOf(cloud[i]);
  mean /= static_cast<double>(indices.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const std::size_t i : indices) {
    const Eigen::Vector3d d = positionOf(cloud[i]) - mean;
    spread += d * d.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread);
  const Eigen::Vector3d size = axes.eigenvalues().cwiseMax(0);
  if (size.z() <= 0) return {};
  const double flatness = (std::sqrt(size.y()) - std::sqrt(size.x())) / std::sqrt(size.z());
  return {axes.eigenvectors().col(0), flatness};
}

/// The plane of each point through its nearest points. PCL's own search starts a team of OpenMP for each query, which
/// takes longer than the query; FLANN answers all of them in one.
std::vector<Plane> planesOf(const Cloud& cloud, std::vector<Eigen::Vector3f> points) {
  constexpr int kLeafSize = 15;
  const std::size_t count = std::min<std::size_t>(kNeighbours, points.size());
  const flann::Matrix<float> rows(points.front().data(), points.size(), 3);
  flann::KDTreeSingleIndex<flann::L2_Simple<float>> tree(rows, flann::KDTreeSingleIndexParams(kLeafSize));
  tree.buildIndex();
  std::vector<std::size_t> indices(points.size() * count);
  std::vector<float> squared(indices.size());
  flann::Matrix<std::size_t> found(indices.data(), points.size(), count);
  flann::Matrix<float> distances(squared.data(), points.size(), count);
  tree.knnSearch(rows, found, distances, count, flann::SearchParams(flann::FLANN_CHECKS_UNLIMITED));
  std::vector<Plane> planes;
  planes.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    planes.push_back(planeThrough(cloud, std::span(indices).subspan(i * count, count)));
  return planes;
}

}  // namespace

struct SurfaceCloud::Parts {
  Cloud::Ptr cloud{new Cloud};
  std::vector<Plane> planes;

  /// The kd-tree of generalised ICP.
  pcl::search::KdTree<Point>::Ptr tree() const {
    const pcl::search::KdTree<Point>::Ptr made(new pcl::search::KdTree<Point>);
    made->setInputCloud(cloud);
    return made;
  }

  /// The covariances of generalised ICP: thin along the normal, wide across.
  Gicp::MatricesVectorPtr covariances() const {
    constexpr double kThin = 0.001;
    const Gicp::MatricesVectorPtr all(new Gicp::MatricesVector);
    all->reserve(planes.size());
    for (const Plane& plane : planes)
      all->push_back(Eigen::Matrix3d::Identity() - (1 - kThin) * plane.normal * plane.normal.transpose());
    return all;
  }
};

SurfaceCloud::SurfaceCloud(const std::vector<Eigen::Vector3f>& p_sensor)
    : grid_(p_sensor, kMaxReach_m), parts_(std::make_unique<Parts>()) {
  silencePcl();
  for (const Eigen::Vector3f& p : p_sensor) parts_->cloud->emplace_back(p.x(), p.y(), p.z());
  if (p_sensor.empty()) return;
  parts_->planes = planesOf(*parts_->cloud, p_sensor);
}

SurfaceCloud::~SurfaceCloud() = default;
SurfaceCloud::SurfaceCloud(SurfaceCloud&&) noexcept = default;
SurfaceCloud& SurfaceCloud::operator=(SurfaceCloud&&) noexcept = default;

std::size_t SurfaceCloud::size() const {
  return parts_->cloud->size();
}
Eigen::Vector3d SurfaceCloud::point(std::size_t i) const {
  return positionOf((*parts_->cloud)[i]);
}
Eigen::Vector3d SurfaceCloud::normal(std::size_t i) const {
  return parts_->planes[i].normal;
}
double SurfaceCloud::flatness(std::size_t i) const {
  return parts_->planes[i].flatness;
}

std::optional<Eigen::Isometry3d> alignedByGicp(const SurfaceCloud& target, const SurfaceCloud& source,
                                               const Eigen::Isometry3d& T_target_source, double reach_m) {
  if (std::min(target.size(), source.size()) < static_cast<std::size_t>(kNeighbours)) return std::nullopt;
  Gicp gicp;
  gicp.setSearchMethodSource(source.parts().tree(), true);
  gicp.setSearchMethodTarget(target.parts().tree(), true);
  gicp.setInputSource(source.parts().cloud);
  gicp.setInputTarget(target.parts().cloud);
  gicp.setSourceCovariances(source.parts().covariances());
  gicp.setTargetCovariances(target.parts().covariances());
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
