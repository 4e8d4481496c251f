// SPDX-License-Identifier: Apache-2.0
// What Cluxel takes from PCL. PCL comes with some fifty libraries, and loading them took half of each start. So the
// code that uses PCL is a module of its own, which the first call loads.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scan/formats/point_fields.hpp"

namespace cluxel::scan {

class SurfaceCloud;

/// The plane through the neighbours of a point.
struct SurfacePlane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double flatness = 0;  ///< in [0, 1]: 1 for neighbours that fill a disc, 0 for a line or a ball
};

/// Thread-safe.
class PclFunctions {
 public:
  virtual ~PclFunctions() = default;

  /// Packed records of `fields` from the body of a binary PCD. `compressed`: PCL's LZF form. Throws InputError
  /// when PCL cannot decode it.
  virtual std::string pcdRecords(std::string_view body, const std::vector<PointField>& fields, std::size_t count,
                                 bool compressed, const std::string& file) const = 0;

  /// Packed little-endian records of `fields` from the vertices of a binary PLY in either byte order.
  virtual std::string plyRecords(std::string_view body, const std::vector<PointField>& fields, std::size_t count,
                                 bool big_endian, const std::string& file) const = 0;

  /// The bytes of a binary PCD file with these packed records and VIEWPOINT from `T_map_sensor`.
  virtual std::string pcdFile(std::string_view records, const std::vector<PointField>& fields, std::size_t count,
                              const Eigen::Isometry3d& T_map_sensor) const = 0;

  /// For each of the points `chosen` the plane through its 20 nearest ones.
  virtual std::vector<SurfacePlane> planesAt(const std::vector<Eigen::Vector3f>& points,
                                             const std::vector<std::size_t>& chosen) const = 0;

  /// Where generalised ICP (Segal, Haehnel, Thrun 2009, as PCL has it) moves `source`, from a first guess; absent when
  /// it fails. It may end on its last iteration, a hair from rest: whether to believe it is for evidenceOf to say.
  /// Points further than `reach_m` from the other cloud do not count.
  virtual std::optional<Eigen::Isometry3d> alignedByGicp(const SurfaceCloud& target, const SurfaceCloud& source,
                                                         const Eigen::Isometry3d& T_target_source,
                                                         double reach_m) const = 0;
};

/// Loads the module at its first call, which took some 50 ms on a slow machine. Throws Error (FaultyInput) when the
/// module does not lie in the installation or build folder around the program, or a library of PCL is missing.
const PclFunctions& pcl();

/// The function that the module exports under kPclEntryName.
using PclEntry = const PclFunctions* (*)();
inline constexpr const char* kPclEntryName = "cluxelPclFunctions";

}  // namespace cluxel::scan
