// SPDX-License-Identifier: Apache-2.0
// Entry point of the module: scan::pcl() loads it and calls the function below.
#include "scan/pcl/pcl_functions.hpp"

#include "pcl_module/pcl_alignment.hpp"
#include "pcl_module/pcl_clouds.hpp"

extern "C" __attribute__((visibility("default"))) const cluxel::scan::PclFunctions* cluxelPclFunctions();

namespace {

using namespace cluxel::scan;

class LinkedPcl final : public PclFunctions {
 public:
  std::string pcdRecords(std::string_view body, const std::vector<PointField>& fields, std::size_t count,
                         bool compressed, const std::string& file) const override {
    return cluxel::scan::pcdRecords(body, fields, count, compressed, file);
  }
  std::string plyRecords(std::string_view body, const std::vector<PointField>& fields, std::size_t count,
                         bool big_endian, const std::string& file) const override {
    return cluxel::scan::plyRecords(body, fields, count, big_endian, file);
  }
  std::string pcdFile(std::string_view records, const std::vector<PointField>& fields, std::size_t count,
                      const Eigen::Isometry3d& T_map_sensor) const override {
    return cluxel::scan::pcdFile(records, fields, count, T_map_sensor);
  }
  std::vector<SurfacePlane> planesAt(const std::vector<Eigen::Vector3f>& points,
                                     const std::vector<std::size_t>& chosen) const override {
    return cluxel::scan::planesAt(points, chosen);
  }
  std::optional<Eigen::Isometry3d> alignedByGicp(const SurfaceCloud& target, const SurfaceCloud& source,
                                                 const Eigen::Isometry3d& T_target_source,
                                                 double reach_m) const override {
    return cluxel::scan::alignedByGicp(target, source, T_target_source, reach_m);
  }
};

}  // namespace

extern "C" const cluxel::scan::PclFunctions* cluxelPclFunctions() {
  static const LinkedPcl functions;
  return &functions;
}
