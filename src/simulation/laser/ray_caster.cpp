// SPDX-License-Identifier: Apache-2.0
// Embree's scene of the campus: one geometry per mesh, sharing its buffers.
#include "simulation/laser/ray_caster.hpp"

#include <embree3/rtcore.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <string>
#include <type_traits>
#include <utility>

#include "cluxel/error.hpp"

namespace cluxel::simulation {
namespace {

using Eigen::Vector3d;

struct DeviceDeleter {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct SceneDeleter {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using Device = std::shared_ptr<std::remove_pointer_t<RTCDevice>>;
using EmbreeScene = std::unique_ptr<std::remove_pointer_t<RTCScene>, SceneDeleter>;

/// One building thread and one instruction set: the same tree on every machine and in every run.
constexpr const char* kDeviceConfig = "threads=1,isa=sse4.2";

/// All scenes share one device, as long as there are any: Embree starts no more than some 1000, as each takes one of
/// the keys that a process has for data of its threads.
Device sharedDevice() {
  static std::mutex mutex;
  static std::weak_ptr<Device::element_type> shared;
  const std::scoped_lock lock(mutex);
  if (Device device = shared.lock()) return device;
  const RTCDevice made = rtcNewDevice(kDeviceConfig);
  if (made == nullptr)
    throw Error(ErrorKind::StoreUnavailable,
                "Embree, which casts the laser's rays, does not start (its error code is " +
                    std::to_string(rtcGetDeviceError(nullptr)) + "): it needs a processor with SSE 4.2");
  Device device(made, DeviceDeleter());
  shared = device;
  return device;
}

void attach(RTCDevice device, RTCScene scene, const CampusMesh& mesh, unsigned number) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  // Embree reads 16 bytes from each vertex, so the last one cannot be shared: copies are the simple way.
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                               3 * sizeof(float), mesh.vertices.size()));
  auto* triangles = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                   3 * sizeof(unsigned), mesh.triangles.size()));
  for (const auto& vertex : mesh.vertices)
    for (int axis = 0; axis < 3; ++axis) *vertices++ = vertex[axis];
  for (const auto& triangle : mesh.triangles)
    for (const unsigned corner : triangle) *triangles++ = corner;
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene, geometry, number);
  rtcReleaseGeometry(geometry);
}

/// Embree's ranges stray by less than this share: by the processor's approximate reciprocals, and by rounding where a
/// ray grazes a surface.
constexpr double kRangeTolerance = 1e-3;

float beyond(double range_m) {
  return static_cast<float>(range_m * (1 + kRangeTolerance));
}

RTCRayHit rayFrom(const Vector3d& origin, const Vector3d& direction, double max_range_m) {
  RTCRayHit ray{};
  ray.ray.org_x = static_cast<float>(origin.x());
  ray.ray.org_y = static_cast<float>(origin.y());
  ray.ray.org_z = static_cast<float>(origin.z());
  ray.ray.dir_x = static_cast<float>(direction.x());
  ray.ray.dir_y = static_cast<float>(direction.y());
  ray.ray.dir_z = static_cast<float>(direction.z());
  ray.ray.tfar = beyond(max_range_m);
  ray.ray.mask = ~0U;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  return ray;
}

/// Where the ray meets the triangle's plane.
RayHit exactHit(const Campus& campus, const RTCHit& hit, const Vector3d& origin, const Vector3d& direction) {
  const CampusMesh& mesh = campus.meshes[hit.geomID];
  const auto& corners = mesh.triangles[hit.primID];
  const Vector3d a = mesh.vertices[corners[0]].cast<double>();
  const Vector3d normal =
      (mesh.vertices[corners[1]].cast<double>() - a).cross(mesh.vertices[corners[2]].cast<double>() - a).normalized();
  const double along = normal.dot(direction);
  return {.range_m = normal.dot(a - origin) / along,
          .cos_incidence = std::abs(along),
          .mesh = hit.geomID,
          .triangle = hit.primID};
}

/// A search for the nearest surface. Embree passes it to the filter in the place of its context.
struct NearestHit {
  RTCIntersectContext context;
  const Campus& campus;
  Vector3d origin, direction;  ///< of the ray as Embree sees it
  double max_range_m;
  RTCHit hit{};
  double range_m = std::numeric_limits<double>::infinity();

  /// False for the range of a plane that the ray lies in, which is no number.
  bool isNearer(const RTCHit& other, double other_m) const {
    if (!(other_m <= std::min(range_m, max_range_m))) return false;
    return other_m < range_m || std::pair(other.geomID, other.primID) < std::pair(hit.geomID, hit.primID);
  }
};

/// Keeps the nearest hit by exact ranges, and lets Embree search as far as its own ranges may stray from them.
void filterHit(const RTCFilterFunctionNArguments* found) {
  auto& nearest = *reinterpret_cast<NearestHit*>(found->context);
  const RTCHit hit = rtcGetHitFromHitN(found->hit, found->N, 0);
  const double range_m = exactHit(nearest.campus, hit, nearest.origin, nearest.direction).range_m;
  if (!nearest.isNearer(hit, range_m)) {
    found->valid[0] = 0;
    return;
  }
  nearest.hit = hit;
  nearest.range_m = range_m;
  RTCRayN_tfar(found->ray, found->N, 0) = beyond(range_m);
}

}  // namespace

struct RayCaster::Embree {
  Device device;
  EmbreeScene scene;
};

RayCaster::RayCaster(const Campus& campus) : embree_(std::make_unique<Embree>()), campus_(campus) {
  embree_->device = sharedDevice();
  RTCDevice device = embree_->device.get();
  embree_->scene.reset(rtcNewScene(device));
  rtcSetSceneFlags(embree_->scene.get(), RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
  for (std::size_t i = 0; i < campus.meshes.size(); ++i)
    attach(device, embree_->scene.get(), campus.meshes[i], static_cast<unsigned>(i));
  rtcCommitScene(embree_->scene.get());
}

RayCaster::~RayCaster() = default;

std::optional<RayHit> RayCaster::cast(const Vector3d& origin_map, const Vector3d& direction_map,
                                      double max_range_m) const {
  RTCRayHit ray = rayFrom(origin_map, direction_map, max_range_m);
  NearestHit nearest{.context = {},
                     .campus = campus_,
                     .origin = {ray.ray.org_x, ray.ray.org_y, ray.ray.org_z},
                     .direction = {ray.ray.dir_x, ray.ray.dir_y, ray.ray.dir_z},
                     .max_range_m = max_range_m};
  rtcInitIntersectContext(&nearest.context);
  nearest.context.filter = filterHit;
  rtcIntersect1(embree_->scene.get(), &nearest.context, &ray);
  if (std::isinf(nearest.range_m)) return std::nullopt;
  return exactHit(campus_, nearest.hit, origin_map, direction_map);
}

}  // namespace cluxel::simulation
