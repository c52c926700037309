// The diffuse part of Disney's principled model (Burley 2012, 5.3): a base colour times a product of two Schlick-like factors.
// Local frame, wo.z > 0; roughness in [0, 1].
#ifndef OCLAIR_DISNEY_DIFFUSE_H
#define OCLAIR_DISNEY_DIFFUSE_H

#include "diffuse.h"

// pi f = base (1 + (F90 - 1)(1 - cos_i)^5) (1 + (F90 - 1)(1 - cos_o)^5), F90 = 1/2 + 2 roughness cos^2(theta_d). With the
// half-angle formula 2 cos^2(theta_d) = 1 + wi.wo: no half vector, which would not exist for wi = -wo.
INLINE float3 disney_diffuse_factor(const Material *material, float3 wo, float3 wi) {
  float f90_minus_one = fma(material->roughness, 1.0f + dot(wi, wo), -0.5f);
  float i = fmax(1.0f - wi.z, 0.0f), o = fmax(1.0f - wo.z, 0.0f);
  float i2 = i * i, o2 = o * o;
  return unpack3(material->reflectance) * (fma(f90_minus_one, i2 * i2 * i, 1.0f) * fma(f90_minus_one, o2 * o2 * o, 1.0f));
}

#endif
