// SPDX-License-Identifier: Apache-2.0
#include "reflectree/render/embree_scene.hpp"

#include <embree3/rtcore.h>

#include <limits>

#include "reflectree/error.hpp"

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

}  // namespace

EmbreeScene::EmbreeScene(const Scene& scene) {
  const RTCDevice device = rtcNewDevice(nullptr);
  if (!device) throw Error("cannot start", "Embree", "check the installation");
  device_ = {device, [](void* p) { rtcReleaseDevice(static_cast<RTCDevice>(p)); }};
  const RTCScene world = rtcNewScene(device);
  scene_ = {world, [](void* p) { rtcReleaseScene(static_cast<RTCScene>(p)); }};
  rtcSetSceneFlags(world, RTC_SCENE_FLAG_ROBUST);
  if (scene.triangles.empty()) {
    rtcCommitScene(world);
    return;
  }
  const RTCGeometry mesh = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  const std::shared_ptr<void> keep(mesh, [](void* p) { rtcReleaseGeometry(static_cast<RTCGeometry>(p)); });
  auto* points =
      buffer<float>(mesh, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, 3 * sizeof(float), scene.points.size());
  for (const Point p : scene.points) *points++ = p.x, *points++ = p.y, *points++ = p.z;
  auto* corners = buffer<std::uint32_t>(mesh, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3,
                                        3 * sizeof(std::uint32_t), scene.triangles.size());
  for (const Triangle& t : scene.triangles) {
    for (const std::uint32_t c : t.corner) *corners++ = c;
  }
  rtcCommitGeometry(mesh);
  rtcAttachGeometry(world, mesh);
  rtcCommitScene(world);
  if (rtcGetDeviceError(device) != RTC_ERROR_NONE) {
    throw Error("cannot hold the triangles", "Embree", "use a smaller mesh");
  }
}

std::optional<Hit> EmbreeScene::intersect(Point origin, Direction direction, float near) const {
  RTCRayHit query{};
  query.ray = ray_from(origin, direction, near, std::numeric_limits<float>::infinity());
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(static_cast<RTCScene>(scene_.get()), &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  return Hit{query.hit.primID, query.ray.tfar};
}

bool EmbreeScene::occluded(Point origin, Direction direction, float near, float far) const {
  RTCRay ray = ray_from(origin, direction, near, far);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(static_cast<RTCScene>(scene_.get()), &context, &ray);
  return ray.tfar < 0;
}

}  // namespace reflectree::render
