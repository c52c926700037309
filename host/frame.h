// The canonical frame: the scene moved and scaled by a power of two so that its geometry fills [-1, 1]^3. There float32 has its
// best resolution everywhere, error bounds are constants, and a scene scaled by 2^k gives the same bits (Ray origins and
// offsets in float32 depend on absolute coordinates: Waechter and Binder 2019).
#pragma once

#include <glm/glm.hpp>

#include "world.h"

namespace oclair {

struct CanonicalFrame {
  glm::dvec3 center{0.0};  // world position of the origin
  int exponent = 0;        // canonical = (world - center) 2^-exponent

  glm::dvec3 place(const glm::dvec3& world) const;
  double place_length(double world) const;
};

// Of all the geometry; the camera and the lights without area may lie outside. Without geometry: the identity.
CanonicalFrame canonical_frame(const World& world);

struct Bounds {
  glm::dvec3 low{std::numeric_limits<double>::infinity()};
  glm::dvec3 high{-std::numeric_limits<double>::infinity()};

  void include(const glm::dvec3& p);
  bool empty() const { return !(low.x <= high.x); }
};

// Box of a unit quadric of cl/types.h under the affine map.
Bounds quadric_bounds(Geometry geometry, const glm::dmat4& to_world);

}  // namespace oclair
