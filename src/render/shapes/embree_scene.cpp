// SPDX-License-Identifier: Apache-2.0
#include "reflectree/render/shapes/embree_scene.hpp"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "flat.hpp"
#include "reflectree/error.hpp"
#include "reflectree/render/integrators/profile.hpp"

namespace reflectree::render {

namespace {

constexpr std::size_t lanes = 8;           // rays that Embree traces at once
constexpr std::size_t stream_length = 64;  // shadow rays that it gets at once, to form packets itself

// Rays and hits are written in place: what is put together elsewhere and copied waits for its own stores.
void put(RTCRay& ray, const Ray& r) {
  ray.org_x = r.origin.x, ray.org_y = r.origin.y, ray.org_z = r.origin.z, ray.tnear = r.near;
  ray.dir_x = r.direction.x, ray.dir_y = r.direction.y, ray.dir_z = r.direction.z, ray.tfar = r.far;
  ray.time = 0, ray.mask = 0xffffffffU, ray.id = 0, ray.flags = 0;
}

// Embree ends the program on a ray that is no number or comes from beyond 1.8e18; such a ray meets nothing
// and brings no light.
bool is_sound(const Ray& r) {
  const Point &o = r.origin, &d = r.direction;
  const float size = abs(o.x) + abs(o.y) + abs(o.z) + abs(d.x) + abs(d.y) + abs(d.z);
  return size < 1e18f && !std::isnan(r.near) && !std::isnan(r.far);
}

struct Lanes {
  alignas(32) int mask[lanes];  // -1: in use
};
Lanes put(RTCRay8& packet, std::span<const Ray> rays) {
  Lanes used;
  for (std::size_t i = 0; i < lanes; ++i) {
    used.mask[i] = i < rays.size() && is_sound(rays[i]) ? -1 : 0;
    const Ray& r = rays[std::min(i, rays.size() - 1)];
    packet.org_x[i] = r.origin.x, packet.org_y[i] = r.origin.y, packet.org_z[i] = r.origin.z;
    packet.dir_x[i] = r.direction.x, packet.dir_y[i] = r.direction.y, packet.dir_z[i] = r.direction.z;
    packet.tnear[i] = r.near, packet.tfar[i] = r.far;
    packet.time[i] = 0, packet.mask[i] = 0xffffffffU, packet.id[i] = 0, packet.flags[i] = 0;
  }
  return used;
}

RTCIntersectContext context_of(bool coherent) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  if (coherent) context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  return context;
}

template <class T>
T* buffer(RTCGeometry geometry, RTCBufferType type, RTCFormat format, std::size_t stride, std::size_t count) {
  // Embree's own buffers are padded as its SIMD loads need.
  void* memory = rtcSetNewGeometryBuffer(geometry, type, 0, format, stride, count);
  if (!memory) throw Error("no memory for the triangles", "Embree", "use a smaller mesh");
  return static_cast<T*>(memory);
}

// Where the line meets the sphere, nearest first, in double precision: the distances of the feet of the
// perpendicular plus and minus the half chord (Haines et al. 2019, Ray Tracing Gems, 7), free of cancellation.
bool sphere_distance(const Sphere& s, Point o, Direction d, float near, float far, float& distance) {
  const Vec3<double> from = to_double(o) - s.centre, along = to_double(d);
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

// The same for the line's part where z is in [0, 1], in the cylinder's coordinates.
bool cylinder_distance(const Cylinder& c, Point o, Direction d, float near, float far, float& distance) {
  const Vec3<double> from = to_double(o) - c.base, along = to_double(d);
  const double over_r2 = 1 / dot(c.s, c.s), over_l2 = 1 / dot(c.axis, c.axis);
  const double ox = dot(from, c.s) * over_r2, oy = dot(from, c.t) * over_r2, oz = dot(from, c.axis) * over_l2;
  const double dx = dot(along, c.s) * over_r2, dy = dot(along, c.t) * over_r2,
               dz = dot(along, c.axis) * over_l2;
  const double over = 1 / (dx * dx + dy * dy), b = -(ox * dx + oy * dy) * over;
  const double fx = ox + b * dx, fy = oy + b * dy, rest = 1 - fx * fx - fy * fy;
  if (!(rest >= 0)) return false;
  const double chord = sqrt(rest * over);
  for (const double t : {b - chord, b + chord}) {
    const double z = oz + t * dz;
    if (t > double(near) && t < double(far) && z >= 0 && z <= 1) return distance = float(t), true;
  }
  return false;
}

const Flat& flat(const Scene& scene, Hit::Kind kind, unsigned index) {
  return kind == Hit::Kind::rectangle ? scene.rectangles[index] : scene.disks[index];
}

// Of a packet's ray i.
template <Hit::Kind kind>
bool distance_to(const Scene& scene, unsigned index, RTCRayN* r, unsigned n, unsigned i, float& distance) {
  const Point o{RTCRayN_org_x(r, n, i), RTCRayN_org_y(r, n, i), RTCRayN_org_z(r, n, i)};
  const Direction d{RTCRayN_dir_x(r, n, i), RTCRayN_dir_y(r, n, i), RTCRayN_dir_z(r, n, i)};
  const float near = RTCRayN_tnear(r, n, i), far = RTCRayN_tfar(r, n, i);
  if constexpr (kind == Hit::Kind::sphere) {
    return sphere_distance(scene.spheres[index], o, d, near, far, distance);
  } else if constexpr (kind == Hit::Kind::cylinder) {
    return cylinder_distance(scene.cylinders[index], o, d, near, far, distance);
  } else {
    const auto [t, x, y] = crossing(flat(scene, kind, index), o, d);
    const bool within = kind == Hit::Kind::rectangle ? in_rectangle(x, y) : in_disk(x, y);
    if (!(within && t > double(near) && t < double(far))) return false;
    return distance = float(t), true;
  }
}

// A place on a flat shape in double precision, as it was met.
REFLECTREE_INLINE void put(std::optional<Hit>& out, const Scene& scene, const Ray& ray, unsigned geometry,
                           unsigned primitive, float distance, float u, float v) {
  if (geometry == RTC_INVALID_GEOMETRY_ID) return out.reset();
  Hit& hit = out.emplace();
  hit.kind = Hit::Kind(geometry), hit.index = primitive, hit.distance = distance;
  if (hit.kind == Hit::Kind::triangle) {
    hit.u = double(u), hit.v = double(v);
  } else if (hit.kind != Hit::Kind::sphere && hit.kind != Hit::Kind::cylinder) {
    const auto [t, x, y] = crossing(flat(scene, hit.kind, hit.index), ray.origin, ray.direction);
    hit.distance = float(t), hit.u = x, hit.v = y;
  }
}

// Embree's callbacks, for single rays and packets.
template <Hit::Kind kind>
void bounds(const RTCBoundsFunctionArguments* a) {
  const auto& scene = *static_cast<const Scene*>(a->geometryUserPtr);
  Vec3<double> middle, reach;
  if constexpr (kind == Hit::Kind::sphere) {
    const Sphere& s = scene.spheres[a->primID];
    middle = s.centre, reach = {s.radius, s.radius, s.radius};
  } else if constexpr (kind == Hit::Kind::cylinder) {
    const Cylinder& c = scene.cylinders[a->primID];
    const auto far = [](double s, double t, double l) { return std::hypot(s, t) + std::abs(l) / 2; };
    middle = c.base + .5 * c.axis;
    reach = {far(c.s.x, c.t.x, c.axis.x), far(c.s.y, c.t.y, c.axis.y), far(c.s.z, c.t.z, c.axis.z)};
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
  RTCRayN* rays = RTCRayHitN_RayN(a->rayhit, a->N);
  RTCHitN* hits = RTCRayHitN_HitN(a->rayhit, a->N);
  const auto& scene = *static_cast<const Scene*>(a->geometryUserPtr);
  for (unsigned i = 0; i < a->N; ++i) {
    float distance = 0;
    if (!a->valid[i] || !distance_to<kind>(scene, a->primID, rays, a->N, i, distance)) continue;
    RTCRayN_tfar(rays, a->N, i) = distance;
    RTCHitN_geomID(hits, a->N, i) = a->geomID, RTCHitN_primID(hits, a->N, i) = a->primID;
  }
}

template <Hit::Kind kind>
void block(const RTCOccludedFunctionNArguments* a) {
  const auto& scene = *static_cast<const Scene*>(a->geometryUserPtr);
  for (unsigned i = 0; i < a->N; ++i) {
    float distance = 0;
    if (!a->valid[i] || !distance_to<kind>(scene, a->primID, a->ray, a->N, i, distance)) continue;
    RTCRayN_tfar(a->ray, a->N, i) = -std::numeric_limits<float>::infinity();
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
  attach_ours<Hit::Kind::cylinder>(device, world, scene, scene.cylinders.size());
  rtcCommitScene(world);
}

std::optional<Hit> EmbreeScene::intersect(const Ray& ray) const {
  const InPhase traversing(Phase::traversal);
  if (!is_sound(ray)) return std::nullopt;
  RTCRayHit query;
  put(query.ray, ray);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context = context_of(false);
  rtcIntersect1(static_cast<RTCScene>(scene_.get()), &context, &query);
  std::optional<Hit> hit;
  put(hit, shapes_, ray, query.hit.geomID, query.hit.primID, query.ray.tfar, query.hit.u, query.hit.v);
  return hit;
}

bool EmbreeScene::occluded(const Ray& ray) const {
  const InPhase traversing(Phase::traversal);
  if (!is_sound(ray)) return true;
  RTCRay query;
  put(query, ray);
  RTCIntersectContext context = context_of(false);
  rtcOccluded1(static_cast<RTCScene>(scene_.get()), &context, &query);
  return query.tfar < 0;
}

void EmbreeScene::intersect(std::span<const Ray> rays, bool coherent,
                            std::span<std::optional<Hit>> out) const {
  const InPhase traversing(Phase::traversal);
  RTCIntersectContext context = context_of(coherent);
  alignas(32) RTCRayHit8 packet;
  for (std::size_t begin = 0; begin < rays.size(); begin += lanes) {
    const std::span<const Ray> some = rays.subspan(begin, std::min(lanes, rays.size() - begin));
    const Lanes valid = put(packet.ray, some);
    for (unsigned& id : packet.hit.geomID) id = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect8(valid.mask, static_cast<RTCScene>(scene_.get()), &context, &packet);
    for (std::size_t i = 0; i < some.size(); ++i) {
      put(out[begin + i], shapes_, some[i], packet.hit.geomID[i], packet.hit.primID[i], packet.ray.tfar[i],
          packet.hit.u[i], packet.hit.v[i]);
    }
  }
}

void EmbreeScene::occluded(std::span<const Ray> rays, std::span<std::uint8_t> out) const {
  const InPhase traversing(Phase::traversal);
  RTCIntersectContext context = context_of(false);
  std::array<RTCRay, stream_length> queries;
  const Ray nothing{{0, 0, 0}, {0, 0, 1}, 1, 0};  // near beyond far: Embree leaves it out
  for (std::size_t begin = 0; begin < rays.size(); begin += stream_length) {
    const std::size_t n = std::min(stream_length, rays.size() - begin);
    for (std::size_t i = 0; i < n; ++i)
      put(queries[i], is_sound(rays[begin + i]) ? rays[begin + i] : nothing);
    rtcOccluded1M(static_cast<RTCScene>(scene_.get()), &context, queries.data(), unsigned(n),
                  sizeof queries[0]);
    for (std::size_t i = 0; i < n; ++i) out[begin + i] = queries[i].tfar < 0 || !is_sound(rays[begin + i]);
  }
}

}  // namespace reflectree::render
