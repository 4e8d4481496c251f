// SPDX-License-Identifier: Apache-2.0
// Asks PROJ, which knows the IRIs, URNs and codes of OGC and EPSG.
#include "base/proj_reference_system.hpp"

#include <proj.h>

#include <memory>
#include <numbers>
#include <string_view>

namespace cluxel {
namespace {

struct DropContext {
  void operator()(PJ_CONTEXT* context) const { proj_context_destroy(context); }
};
struct DropObject {
  void operator()(PJ* object) const { proj_destroy(object); }
};
using Object = std::unique_ptr<PJ, DropObject>;

/// The horizontal part of a compound system; the system below a datum shift.
Object horizontal(PJ_CONTEXT* context, Object crs) {
  if (crs && proj_get_type(crs.get()) == PJ_TYPE_COMPOUND_CRS) crs.reset(proj_crs_get_sub_crs(context, crs.get(), 0));
  if (crs && proj_get_type(crs.get()) == PJ_TYPE_BOUND_CRS) crs.reset(proj_get_source_crs(context, crs.get()));
  return crs;
}

struct Axis {
  std::string direction;
  double factor = 0;  ///< to metres or radians
};

Axis axisOf(PJ_CONTEXT* context, const PJ* axes, int index) {
  Axis axis;
  const char* direction = nullptr;
  if (proj_cs_get_axis_info(context, axes, index, nullptr, nullptr, &direction, &axis.factor, nullptr, nullptr,
                            nullptr) == 1)
    axis.direction = direction;
  return axis;
}

bool readEllipsoid(PJ_CONTEXT* context, const PJ* crs, ReferenceSystem& system) {
  const Object ellipsoid(proj_get_ellipsoid(context, crs));
  return ellipsoid && proj_ellipsoid_get_parameters(context, ellipsoid.get(), &system.semi_major_axis_m, nullptr,
                                                    nullptr, &system.inverse_flattening) == 1;
}

ReferenceSystem described(PJ_CONTEXT* context, const PJ* crs) {
  ReferenceSystem system;
  const PJ_TYPE type = proj_get_type(crs);
  const bool is_geographic = type == PJ_TYPE_GEOGRAPHIC_2D_CRS || type == PJ_TYPE_GEOGRAPHIC_3D_CRS;
  if (!is_geographic && type != PJ_TYPE_PROJECTED_CRS) return system;
  const Object axes(proj_crs_get_coordinate_system(context, crs));
  if (!axes) return system;
  const Axis first = axisOf(context, axes.get(), 0), second = axisOf(context, axes.get(), 1);
  if (first.factor <= 0 || first.factor != second.factor) return system;
  if (!is_geographic) {
    system.kind = ReferenceSystem::Kind::Projected;
    system.metres_per_unit = first.factor;
  } else if (readEllipsoid(context, crs, system)) {
    system.kind = ReferenceSystem::Kind::Geographic;
    system.degrees_per_unit = first.factor * 180 / std::numbers::pi;
    system.latitude_first = first.direction == "north" || first.direction == "south";
  }
  return system;
}

}  // namespace

ReferenceSystem referenceSystem(const std::string& name) {
  std::string_view bare = name;
  if (bare.starts_with('<')) bare.remove_prefix(1);
  if (bare.ends_with('>')) bare.remove_suffix(1);
  const std::unique_ptr<PJ_CONTEXT, DropContext> context(proj_context_create());
  proj_log_level(context.get(), PJ_LOG_NONE);  // the library never prints
  const Object crs = horizontal(context.get(), Object(proj_create(context.get(), std::string(bare).c_str())));
  return crs ? described(context.get(), crs.get()) : ReferenceSystem{};
}

}  // namespace cluxel
