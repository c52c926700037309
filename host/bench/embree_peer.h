// Embree on the same triangles and the same rays, quality medium: what our traversal is compared with.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "../embree.h"
#include "../scene.h"
#include "rays.h"

namespace oclair::bench {

class EmbreePeer {
 public:
  // config: of rtcNewDevice, for example "threads=1". Copies the triangles; commit() builds.
  EmbreePeer(const Scene& scene, bool robust, const std::string& config);
  EmbreePeer(const EmbreePeer&) = delete;
  EmbreePeer& operator=(const EmbreePeer&) = delete;
  ~EmbreePeer();

  void commit();  // rtcCommitScene
  RTCScene scene() const { return scene_; }

 private:
  RTCDevice device_;
  RTCScene scene_;
};

// Rays in Embree's own layout, so that no copying is timed. reset() undoes what a query writes into them.
class SingleRays {
 public:
  explicit SingleRays(const std::vector<Ray>& rays);
  void reset();
  void closest(RTCScene scene);
  void any(RTCScene scene);
  Hit hit(std::size_t i) const;       // after closest(): t and primitive
  bool blocked(std::size_t i) const;  // after any()

 private:
  const std::vector<Ray>& rays_;
  std::vector<RTCRayHit> queries_;
};

// The same in packets of 8.
class PacketRays {
 public:
  PacketRays(const std::vector<Ray>& rays, bool coherent);
  void reset();
  void closest(RTCScene scene);
  void any(RTCScene scene);

 private:
  const std::vector<Ray>& rays_;
  bool coherent_;
  std::vector<RTCRayHit8> packets_;
};

// Denormals are zero while it lives, as Embree recommends. Of the calling thread only.
class FlushDenormals {
 public:
  FlushDenormals();
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;
  ~FlushDenormals();

 private:
  unsigned before_;
};

// "3.13.5, AVX2": its version and the instructions that it chose.
std::string embree_description();

}  // namespace oclair::bench
