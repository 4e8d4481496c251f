// SPDX-License-Identifier: Apache-2.0
// Objects and points as JSON values. Lengths are in metres of the map frame, rounded to millimetres; angles in radians.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "cluxel/object.hpp"
#include "cluxel/point_cloud.hpp"
#include "rdf/ontology/class_names.hpp"
#include "rdf/store/quad_store.hpp"

namespace cluxel::serve {

using ObjectJson = nlohmann::ordered_json;

/// With what the map tells of the object beside its measures: whether it is gone.
ObjectJson objectJson(const Object& object, const rdf::QuadReader& quads, const rdf::ClassNames& names);
/// One array for each of x, y, z, label, and intensity when all scans have it.
ObjectJson pointsJson(const PointCloud& points);
/// A coordinate with three decimals.
std::string metres(double value_m);

}  // namespace cluxel::serve
