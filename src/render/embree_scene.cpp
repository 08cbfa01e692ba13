// SPDX-License-Identifier: Apache-2.0
#include "reflectree/render/embree_scene.hpp"

#include <embree3/rtcore.h>

#include <cmath>
#include <limits>

#include "flat.hpp"
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

const Flat& flat(const Scene& scene, Hit::Kind kind, unsigned index) {
  return kind == Hit::Kind::rectangle ? scene.rectangles[index] : scene.disks[index];
}

template <Hit::Kind kind>
bool distance_to(const Scene& scene, unsigned index, const RTCRay& r, float& distance) {
  const Point o{r.org_x, r.org_y, r.org_z};
  const Direction d{r.dir_x, r.dir_y, r.dir_z};
  if constexpr (kind == Hit::Kind::sphere) {
    return sphere_distance(scene.spheres[index], o, d, r.tnear, r.tfar, distance);
  } else {
    const auto [t, x, y] = crossing(flat(scene, kind, index), o, d);
    const bool within = kind == Hit::Kind::rectangle ? in_rectangle(x, y) : in_disk(x, y);
    if (!(within && t > double(r.tnear) && t < double(r.tfar))) return false;
    return distance = float(t), true;
  }
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
    const Flat& f = flat(scene, kind, a->primID);
    const auto far = [](double s, double t) {
      return kind == Hit::Kind::rectangle ? std::abs(s) + std::abs(t) : std::hypot(s, t);
    };
    middle = f.centre, reach = {far(f.s.x, f.t.x), far(f.s.y, f.t.y), far(f.s.z, f.t.z)};
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
  if (!distance_to<kind>(*static_cast<const Scene*>(a->geometryUserPtr), a->primID, query.ray, distance))
    return;
  query.ray.tfar = distance;
  query.hit.geomID = a->geomID, query.hit.primID = a->primID;
}

template <Hit::Kind kind>
void block(const RTCOccludedFunctionNArguments* a) {
  if (!a->valid[0]) return;
  auto& ray = *reinterpret_cast<RTCRay*>(a->ray);
  float distance = 0;
  if (distance_to<kind>(*static_cast<const Scene*>(a->geometryUserPtr), a->primID, ray, distance)) {
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

EmbreeScene::EmbreeScene(const Scene& scene) : shapes_(scene) {
  const RTCDevice device = rtcNewDevice(nullptr);
  if (!device) throw Error("cannot start", "Embree", "check the installation");
  device_ = {device, [](void* p) { rtcReleaseDevice(static_cast<RTCDevice>(p)); }};
  const RTCScene world = rtcNewScene(device);
  scene_ = {world, [](void* p) { rtcReleaseScene(static_cast<RTCScene>(p)); }};
  rtcSetSceneFlags(world, RTC_SCENE_FLAG_ROBUST);
  attach_triangles(device, world, scene);
  attach_ours<Hit::Kind::sphere>(device, world, scene, scene.spheres.size());
  attach_ours<Hit::Kind::rectangle>(device, world, scene, scene.rectangles.size());
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
  const auto kind = Hit::Kind(query.hit.geomID);
  Hit hit{kind, query.hit.primID, query.ray.tfar, double(query.hit.u), double(query.hit.v)};
  if (kind == Hit::Kind::rectangle || kind == Hit::Kind::disk) {
    const auto [distance, x, y] = crossing(flat(shapes_, kind, hit.index), origin, direction);
    hit.distance = float(distance), hit.u = x, hit.v = y;
  }
  return hit;
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
