#include "embree_peer.h"

#include <algorithm>
#include <iostream>
#include <limits>
#include <sstream>

#if defined(__SSE__)
#include <xmmintrin.h>
#endif

#include "../error.h"

namespace oclair::bench {
namespace {

constexpr std::size_t packet = 8;

alignas(32) constexpr int all_valid[packet] = {-1, -1, -1, -1, -1, -1, -1, -1};

// The line of what a verbose Embree said that ends with the mark.
std::string line_of(const std::string& text, const std::string& mark) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (line.find(mark) != std::string::npos) return line.substr(0, line.find(mark)) + " ";
  return "";
}

}  // namespace

EmbreePeer::EmbreePeer(const Scene& scene, bool robust, const std::string& config)
    : device_(rtcNewDevice(config.c_str())), scene_(nullptr) {
  if (!device_) throw Error(Exit::render_failed, "Embree: no device; expected a CPU that Embree supports");
  scene_ = rtcNewScene(device_);
  rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_MEDIUM);
  rtcSetSceneFlags(scene_, robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
  RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* positions = static_cast<packed_float3*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(packed_float3), scene.positions.size()));
  auto* triangles = static_cast<packed_uint3*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                       sizeof(packed_uint3), scene.triangles.size()));
  std::copy(scene.positions.begin(), scene.positions.end(), positions);
  std::copy(scene.triangles.begin(), scene.triangles.end(), triangles);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene_, geometry);
  rtcReleaseGeometry(geometry);
}

EmbreePeer::~EmbreePeer() {
  rtcReleaseScene(scene_);
  rtcReleaseDevice(device_);
}

void EmbreePeer::commit() { rtcCommitScene(scene_); }

SingleRays::SingleRays(const std::vector<Ray>& rays) : rays_(rays), queries_(rays.size()) {}

void SingleRays::reset() {
  for (std::size_t i = 0; i < queries_.size(); ++i) {
    const Ray& r = rays_[i];
    RTCRayHit& query = queries_[i];
    query = RTCRayHit{};
    query.ray.org_x = r.origin.x, query.ray.org_y = r.origin.y, query.ray.org_z = r.origin.z;
    query.ray.dir_x = r.direction.x, query.ray.dir_y = r.direction.y, query.ray.dir_z = r.direction.z;
    query.ray.tfar = r.t_max;
    query.ray.mask = ~0u;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.primID = RTC_INVALID_GEOMETRY_ID;
  }
}

void SingleRays::closest(RTCScene scene) {
  EmbreeQuery query(false);
  for (RTCRayHit& ray : queries_) query.closest(scene, ray);
}

void SingleRays::any(RTCScene scene) {
  EmbreeQuery query(false);
  for (RTCRayHit& ray : queries_) query.any(scene, ray.ray);
}

Hit SingleRays::hit(std::size_t i) const {
  const RTCRayHit& query = queries_[i];
  const bool missed = query.hit.geomID == RTC_INVALID_GEOMETRY_ID;
  return {query.ray.tfar, query.hit.u, query.hit.v, missed ? NONE : query.hit.primID, 0u};
}

bool SingleRays::blocked(std::size_t i) const { return queries_[i].ray.tfar < 0.0f; }

PacketRays::PacketRays(const std::vector<Ray>& rays, bool coherent)
    : rays_(rays), coherent_(coherent), packets_((rays.size() + packet - 1) / packet) {}

// The last packet repeats the last ray.
void PacketRays::reset() {
  for (std::size_t p = 0; p < packets_.size(); ++p) {
    RTCRayHit8& query = packets_[p];
    query = RTCRayHit8{};
    for (std::size_t lane = 0; lane < packet; ++lane) {
      const Ray& r = rays_[std::min(p * packet + lane, rays_.size() - 1)];
      query.ray.org_x[lane] = r.origin.x, query.ray.org_y[lane] = r.origin.y, query.ray.org_z[lane] = r.origin.z;
      query.ray.dir_x[lane] = r.direction.x, query.ray.dir_y[lane] = r.direction.y, query.ray.dir_z[lane] = r.direction.z;
      query.ray.tfar[lane] = r.t_max;
      query.ray.mask[lane] = ~0u;
      query.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
      query.hit.primID[lane] = RTC_INVALID_GEOMETRY_ID;
    }
  }
}

void PacketRays::closest(RTCScene scene) {
  EmbreeQuery query(coherent_);
  for (RTCRayHit8& rays : packets_) query.closest8(scene, all_valid, rays);
}

void PacketRays::any(RTCScene scene) {
  EmbreeQuery query(coherent_);
  for (RTCRayHit8& rays : packets_) query.any8(scene, all_valid, rays.ray);
}

// Bits 15 and 6 of MXCSR: results and operands that are denormal count as zero.
FlushDenormals::FlushDenormals() : before_(0) {
#if defined(__SSE__)
  before_ = _mm_getcsr();
  _mm_setcsr(before_ | 0x8040u);
#endif
}

FlushDenormals::~FlushDenormals() {
#if defined(__SSE__)
  _mm_setcsr(before_);
#endif
}

// Embree tells its instruction set only where it is verbose, on std::cout.
std::string embree_description() {
  std::ostringstream said;
  std::streambuf* const before = std::cout.rdbuf(said.rdbuf());
  RTCDevice device = rtcNewDevice("verbose=1");
  std::cout.rdbuf(before);
  std::string isa = "unknown instruction set";
  const std::string supported = line_of(said.str(), "(supported)"), compiled = line_of(said.str(), "(compile time enabled)");
  for (const std::string name : {"SSE2", "SSE4.2", "AVX", "AVX2", "AVX512"})
    if (supported.find(" " + name + " ") != std::string::npos && compiled.find(" " + name + " ") != std::string::npos)
      isa = name;
  const auto part = [device](RTCDeviceProperty property) { return std::to_string(rtcGetDeviceProperty(device, property)); };
  const std::string version = part(RTC_DEVICE_PROPERTY_VERSION_MAJOR) + "." + part(RTC_DEVICE_PROPERTY_VERSION_MINOR) + "." +
                              part(RTC_DEVICE_PROPERTY_VERSION_PATCH);
  rtcReleaseDevice(device);
  return version + ", " + isa;
}

}  // namespace oclair::bench
