// SPDX-License-Identifier: Apache-2.0
// Places map positions on the earth by PROJ.
#include "tasks/export/proj_geo_reference.hpp"

#include <proj.h>

#include <cmath>

#include "base/proj_reference_system.hpp"
#include "cluxel/error.hpp"

namespace cluxel::tasks {

namespace {

struct DestroyContext {
  void operator()(PJ_CONTEXT* context) const { proj_context_destroy(context); }
};
struct DestroyObject {
  void operator()(PJ* object) const { proj_destroy(object); }
};
using ProjContext = std::unique_ptr<PJ_CONTEXT, DestroyContext>;
using ProjObject = std::unique_ptr<PJ, DestroyObject>;

[[noreturn]] void refuse(const std::string& crs, const std::string& why) {
  throw Error(ErrorKind::FaultyInput, "the map's coordinate system '" + crs + "' " + why, Remedy::LocalFrame);
}

/// The horizontal system of a compound one, and the projected one below a bound one (with a datum shift).
ProjObject horizontalPart(PJ_CONTEXT* context, ProjObject crs) {
  if (crs && proj_get_type(crs.get()) == PJ_TYPE_COMPOUND_CRS) crs.reset(proj_crs_get_sub_crs(context, crs.get(), 0));
  if (crs && proj_get_type(crs.get()) == PJ_TYPE_BOUND_CRS) crs.reset(proj_get_source_crs(context, crs.get()));
  return crs;
}

bool isProjectedInMetres(const std::string& crs) {
  const ReferenceSystem system = referenceSystem(crs);
  return system.kind == ReferenceSystem::Kind::Projected && system.metres_per_unit == 1;
}

}  // namespace

struct GeoReference::Impl {
  std::string crs;
  Eigen::Vector2d origin;
  ProjContext context;
  ProjObject transformation;
};

GeoReference::GeoReference(const std::string& crs, const Eigen::Vector3d& map_origin)
    : impl_(new Impl{crs, map_origin.head<2>(), ProjContext(proj_context_create()), {}}) {
  PJ_CONTEXT* context = impl_->context.get();
  proj_log_level(context, PJ_LOG_NONE);  // the library never prints
  // A PROJ string is a coordinate system only with this word; without it, it is a conversion.
  const std::string name = crs.starts_with("+proj") ? crs + " +type=crs" : crs;
  const ProjObject source = horizontalPart(context, ProjObject(proj_create(context, name.c_str())));
  if (!source) refuse(crs, "is unknown to PROJ");
  if (!isProjectedInMetres(name)) refuse(crs, "is not a projected one in metres");
  const ProjObject target(proj_create(context, "OGC:CRS84"));
  const ProjObject direct(target ? proj_create_crs_to_crs_from_pj(context, source.get(), target.get(), nullptr, nullptr)
                                 : nullptr);
  // Some systems name the north axis first: x is east all the same.
  if (direct) impl_->transformation.reset(proj_normalize_for_visualization(context, direct.get()));
  if (!impl_->transformation) refuse(crs, "cannot be converted to longitude and latitude");
}

GeoReference::~GeoReference() = default;
GeoReference::GeoReference(GeoReference&&) noexcept = default;

Eigen::Vector2d GeoReference::longitudeLatitude(const Eigen::Vector2d& p_map) const {
  const Eigen::Vector2d p_crs = impl_->origin + p_map;
  const PJ_COORD result =
      proj_trans(impl_->transformation.get(), PJ_FWD, proj_coord(p_crs.x(), p_crs.y(), 0, HUGE_VAL));
  const Eigen::Vector2d lon_lat(result.xy.x, result.xy.y);
  if (!lon_lat.allFinite()) refuse(impl_->crs, "is not defined where the map lies: is its origin right?");
  return lon_lat;
}

}  // namespace cluxel::tasks
