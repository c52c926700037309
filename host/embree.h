// Embree 3 (Debian 12) or 4 (Debian 13): the one place that tells them apart. The builder's interface is the same in both.
#pragma once

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace oclair {

// Embree's queries. Coherent: the caller promises rays with similar origins and directions.
class EmbreeQuery {
 public:
#if RTC_VERSION_MAJOR >= 4
  explicit EmbreeQuery(bool coherent) {
    const RTCRayQueryFlags flags = coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
    rtcInitIntersectArguments(&closest_);
    rtcInitOccludedArguments(&any_);
    closest_.flags = flags;
    any_.flags = flags;
  }
  void closest(RTCScene scene, RTCRayHit& ray) { rtcIntersect1(scene, &ray, &closest_); }
  void any(RTCScene scene, RTCRay& ray) { rtcOccluded1(scene, &ray, &any_); }
  void closest8(RTCScene scene, const int* valid, RTCRayHit8& rays) { rtcIntersect8(valid, scene, &rays, &closest_); }
  void any8(RTCScene scene, const int* valid, RTCRay8& rays) { rtcOccluded8(valid, scene, &rays, &any_); }

 private:
  RTCIntersectArguments closest_;
  RTCOccludedArguments any_;
#else
  explicit EmbreeQuery(bool coherent) {
    rtcInitIntersectContext(&context_);
    context_.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  }
  void closest(RTCScene scene, RTCRayHit& ray) { rtcIntersect1(scene, &context_, &ray); }
  void any(RTCScene scene, RTCRay& ray) { rtcOccluded1(scene, &context_, &ray); }
  void closest8(RTCScene scene, const int* valid, RTCRayHit8& rays) { rtcIntersect8(valid, scene, &context_, &rays); }
  void any8(RTCScene scene, const int* valid, RTCRay8& rays) { rtcOccluded8(valid, scene, &context_, &rays); }

 private:
  RTCIntersectContext context_;
#endif
};

}  // namespace oclair
