// SPDX-License-Identifier: Apache-2.0
#include "reflectree/render/embree_scene.hpp"

#include <embree3/rtcore.h>

#include <cmath>
#include <limits>

#include "reflectree/error.hpp"
#include "reflectree/render/profile.hpp"

namespace reflectree::render {

namespace {

RTCRay ray_from(Point o, Direction d, float near, float far) {
  RTCRay ray{};
  ray.org_x = o.x, ray.org_y = o.y, ray.org_z = o.z, ray.tnear = near;
  ray.dir_x = d.x, ray.dir_y = d.y, ray.dir_z = d.z, ray.tfar = far;
  ray.mask = 0xffffffffU;
  return ray;
}

template <class T>
T* buffer(RTCGeometry geometry, RTCBufferType type, RTCFormat format, std::size_t stride, std::size_t count) {
  // Embree's own buffers are padded as its SIMD loads need.
  void* memory = rtcSetNewGeometryBuffer(geometry, type, 0, format, stride, count);
  if (!memory) throw Error("no memory for the triangles", "Embree", "use a smaller mesh");
  return static_cast<T*>(memory);
}

// Where the line meets the sphere, nearest first, in double precision: the distances of the feet of the
// perpendicular plus and minus the half chord (Haines et al. 2019, Ray Tracing Gems, 7), free of
// cancellation.
bool sphere_distance(const Sphere& s, Point o, Direction d, float near, float far, float& distance) {
  const Vec3<double> from = Vec3<double>{o.x, o.y, o.z} - s.centre, along{d.x, d.y, d.z};
  const double over = 1 / dot(along, along), b = -dot(from, along) * over;
  const Vec3<double> foot = from + b * along;
  const double rest = s.radius * s.radius - dot(foot, foot);
  if (!(rest >= 0)) return false;
  const double chord = sqrt(rest * over);
  for (const double t : {b - chord, b + chord}) {
    if (t > double(near) && t < double(far)) return distance = float(t), true;
  }
  return false;
}

bool disk_distance(const Disk& disk, Point o, Direction d, float near, float far, float& distance) {
  const Direction n = cross(disk.s, disk.t);
  const float t = dot(disk.centre - o, n) / dot(d, n);
  if (!(t > near && t < far)) return false;
  const Point from = o + t * d - disk.centre;
  // Solve from = x s + y t in the plane.
  const float ss = dot(disk.s, disk.s), st = dot(disk.s, disk.t), tt = dot(disk.t, disk.t);
  const float fs = dot(from, disk.s), ft = dot(from, disk.t), determinant = ss * tt - st * st;
  const float x = (fs * tt - ft * st) / determinant, y = (ft * ss - fs * st) / determinant;
  if (!(x * x + y * y <= 1)) return false;
  return distance = t, true;
}

bool distance_to(const Scene& scene, Hit::Kind kind, unsigned index, const RTCRay& r, float& distance) {
  const Point o{r.org_x, r.org_y, r.org_z};
  const Direction d{r.dir_x, r.dir_y, r.dir_z};
  return kind == Hit::Kind::sphere ? sphere_distance(scene.spheres[index], o, d, r.tnear, r.tfar, distance)
                                   : disk_distance(scene.disks[index], o, d, r.tnear, r.tfar, distance);
}

// Embree's callbacks; single rays alone are ever traced.
template <Hit::Kind kind>
void bounds(const RTCBoundsFunctionArguments* a) {
  const auto& scene = *static_cast<const Scene*>(a->geometryUserPtr);
  Vec3<double> middle, reach;
  if constexpr (kind == Hit::Kind::sphere) {
    const Sphere& s = scene.spheres[a->primID];
    middle = s.centre, reach = {s.radius, s.radius, s.radius};
  } else {
    const Disk& d = scene.disks[a->primID];
    middle = {d.centre.x, d.centre.y, d.centre.z};
    reach = {std::hypot(d.s.x, d.t.x), std::hypot(d.s.y, d.t.y), std::hypot(d.s.z, d.t.z)};
  }
  const auto put = [](double m, double r, float& low, float& high) {
    const double slack = 1e-6 * (std::abs(m) + r) + 1e-30;
    low = float(m - r - slack), high = float(m + r + slack);
  };
  put(middle.x, reach.x, a->bounds_o->lower_x, a->bounds_o->upper_x);
  put(middle.y, reach.y, a->bounds_o->lower_y, a->bounds_o->upper_y);
  put(middle.z, reach.z, a->bounds_o->lower_z, a->bounds_o->upper_z);
}

template <Hit::Kind kind>
void meet(const RTCIntersectFunctionNArguments* a) {
  if (!a->valid[0]) return;
  auto& query = *reinterpret_cast<RTCRayHit*>(a->rayhit);
  float distance = 0;
  if (!distance_to(*static_cast<const Scene*>(a->geometryUserPtr), kind, a->primID, query.ray, distance)) {
    return;
  }
  query.ray.tfar = distance;
  query.hit.geomID = a->geomID, query.hit.primID = a->primID;
}

template <Hit::Kind kind>
void block(const RTCOccludedFunctionNArguments* a) {
  if (!a->valid[0]) return;
  auto& ray = *reinterpret_cast<RTCRay*>(a->ray);
  float distance = 0;
  if (distance_to(*static_cast<const Scene*>(a->geometryUserPtr), kind, a->primID, ray, distance)) {
    ray.tfar = -std::numeric_limits<float>::infinity();
  }
}

// Geometry ids are the kinds of Hit.
void attach(RTCDevice device, RTCScene world, Hit::Kind kind, RTCGeometry geometry) {
  const std::shared_ptr<void> keep(geometry,
                                   [](void* p) { rtcReleaseGeometry(static_cast<RTCGeometry>(p)); });
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(world, geometry, unsigned(kind));
  if (rtcGetDeviceError(device) != RTC_ERROR_NONE) {
    throw Error("cannot hold the shapes", "Embree", "use a smaller mesh");
  }
}

template <Hit::Kind kind>
void attach_ours(RTCDevice device, RTCScene world, const Scene& scene, std::size_t count) {
  if (count == 0) return;
  const RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(g, unsigned(count));
  rtcSetGeometryUserData(g, const_cast<Scene*>(&scene));
  rtcSetGeometryBoundsFunction(g, bounds<kind>, nullptr);
  rtcSetGeometryIntersectFunction(g, meet<kind>);
  rtcSetGeometryOccludedFunction(g, block<kind>);
  attach(device, world, kind, g);
}

void attach_triangles(RTCDevice device, RTCScene world, const Scene& scene) {
  if (scene.triangles.empty()) return;
  const RTCGeometry mesh = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* points = buffer<float>(mesh, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                               scene.vertices.size());
  for (const Vertex& v : scene.vertices) *points++ = v.at.x, *points++ = v.at.y, *points++ = v.at.z;
  auto* corners = buffer<std::uint32_t>(mesh, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3,
                                        3 * sizeof(std::uint32_t), scene.triangles.size());
  for (const Triangle& t : scene.triangles) {
    for (const std::uint32_t c : t.corner) *corners++ = c;
  }
  attach(device, world, Hit::Kind::triangle, mesh);
}

}  // namespace

EmbreeScene::EmbreeScene(const Scene& scene) {
  const RTCDevice device = rtcNewDevice(nullptr);
  if (!device) throw Error("cannot start", "Embree", "check the installation");
  device_ = {device, [](void* p) { rtcReleaseDevice(static_cast<RTCDevice>(p)); }};
  const RTCScene world = rtcNewScene(device);
  scene_ = {world, [](void* p) { rtcReleaseScene(static_cast<RTCScene>(p)); }};
  rtcSetSceneFlags(world, RTC_SCENE_FLAG_ROBUST);
  attach_triangles(device, world, scene);
  attach_ours<Hit::Kind::sphere>(device, world, scene, scene.spheres.size());
  attach_ours<Hit::Kind::disk>(device, world, scene, scene.disks.size());
  rtcCommitScene(world);
}

std::optional<Hit> EmbreeScene::intersect(Point origin, Direction direction, float near) const {
  const InPhase traversing(Phase::traversal);
  RTCRayHit query;
  query.ray = ray_from(origin, direction, near, std::numeric_limits<float>::infinity());
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(static_cast<RTCScene>(scene_.get()), &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  return Hit{Hit::Kind(query.hit.geomID), query.hit.primID, query.ray.tfar, query.hit.u, query.hit.v};
}

bool EmbreeScene::occluded(Point origin, Direction direction, float near, float far) const {
  const InPhase traversing(Phase::traversal);
  RTCRay ray = ray_from(origin, direction, near, far);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(static_cast<RTCScene>(scene_.get()), &context, &ray);
  return ray.tfar < 0;
}

}  // namespace reflectree::render
