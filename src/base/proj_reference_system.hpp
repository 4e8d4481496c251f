// SPDX-License-Identifier: Apache-2.0
// What is known of a coordinate reference system: its kind, its unit and its ellipsoid.
#pragma once

#include <string>

namespace cluxel {

struct ReferenceSystem {
  enum class Kind {
    Unknown,    ///< not known to PROJ, or neither projected nor geographic
    Projected,  ///< plane coordinates
    Geographic  ///< longitude and latitude
  };
  Kind kind = Kind::Unknown;
  double metres_per_unit = 1;     ///< of a projected one
  double degrees_per_unit = 1;    ///< of a geographic one
  bool latitude_first = false;    ///< EPSG:4326, unlike CRS84
  double semi_major_axis_m = 0;   ///< of the ellipsoid
  double inverse_flattening = 0;  ///< 0: a sphere
};

/// Looks a system up by its name: an IRI, which may stand in angle brackets, "EPSG:25832", WKT or a PROJ string. Cost:
/// some milliseconds.
ReferenceSystem referenceSystem(const std::string& name);

}  // namespace cluxel
