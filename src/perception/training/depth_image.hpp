// SPDX-License-Identifier: Apache-2.0
// What a sensor sees of a scanned place: the nearest point of each direction.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "perception/training/virtual_sensor.hpp"

namespace cluxel::perception {

/// All points of all scans in the map frame [m], with the truth.
struct PlaceCloud {
  std::vector<Eigen::Vector3d> point;
  std::vector<std::int8_t> primitive;
};

PlaceCloud placeCloud(std::span<const scan::Scan> scans, std::span<const scan::PointTruth> truth);

/// The sensor's positions: above the ground point nearest to the centre of each cell that is mostly ground.
std::vector<Eigen::Vector3d> standsOf(const PlaceCloud& cloud, const VirtualSensor& sensor);

/// Indices of the nearest point of each direction, by direction.
std::vector<std::size_t> nearestPoints(const PlaceCloud& cloud, const Eigen::Vector3d& stand,
                                       const VirtualSensor& sensor);

}  // namespace cluxel::perception
