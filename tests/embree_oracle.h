// Embree's own traversal over the scene's triangles, in its robust mode.
#pragma once

#include "../host/embree.h"
#include "trace.h"

namespace oclair::test {

class EmbreeScene {
 public:
  explicit EmbreeScene(const Scene& scene) : device_(rtcNewDevice(nullptr)), scene_(rtcNewScene(device_)) {
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<packed_float3*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(packed_float3), scene.positions.size()));
    std::copy(scene.positions.begin(), scene.positions.end(), vertices);
    auto* indices = static_cast<packed_uint3*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(packed_uint3), scene.triangles.size()));
    std::copy(scene.triangles.begin(), scene.triangles.end(), indices);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
  }
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;
  ~EmbreeScene() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  Hit closest(const Ray& ray) const {
    RTCRayHit query{};
    query.ray = {ray.origin.x, ray.origin.y, ray.origin.z, 0.0f, ray.direction.x, ray.direction.y, ray.direction.z, 0.0f, ray.t_max, ~0u, 0u, 0u};
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    EmbreeQuery(false).closest(scene_, query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {ray.t_max, 0.0f, 0.0f, NONE, 0u};
    return {query.ray.tfar, query.hit.u, query.hit.v, query.hit.primID, 0u};
  }

 private:
  RTCDevice device_;
  RTCScene scene_;
};

}  // namespace oclair::test
