// SPDX-License-Identifier: Apache-2.0
// The scans of a set as registration needs them: thinned, posed, in an order that follows from their content.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <string>
#include <vector>

#include "scan/registration/pose_registration.hpp"
#include "scan/registration/surface_cloud.hpp"

namespace cluxel::scan {

/// In the order of the scans' ids, so that sums are independent of the order given and of file names.
struct RegistrationScans {
  std::vector<SurfaceCloud> clouds;
  std::vector<Eigen::Isometry3d> given;  ///< T_map_sensor
  std::vector<std::size_t> index;        ///< in the ScanSet
  std::vector<std::string> path;

  /// The scans in natural order of their paths.
  std::vector<std::size_t> byPath() const;
};

/// Loads and thins up to `threads` scans at a time. Throws InputError for a scan that cannot be read, has no pose, or
/// is given with two poses.
RegistrationScans loadForRegistration(const ScanSet& set, const RegistrationParams& params, unsigned threads,
                                      ProgressSink& sink);

}  // namespace cluxel::scan
