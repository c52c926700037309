// Mirror reflection: perfect, and of a conductor with the exact Fresnel equations. Local frame, wo.z > 0.
#ifndef OCLAIR_MIRROR_H
#define OCLAIR_MIRROR_H

#include "fresnel.h"
#include "scatter.h"

INLINE float3 mirror_direction(float3 wo) { return (float3)(-wo.x, -wo.y, wo.z); }

INLINE Scatter mirror_sample(const Material *material, float3 wo) {
  Scatter s = {mirror_direction(wo), unpack3(material->reflectance), 0.0f, 1.0f};
  return s;
}

INLINE Scatter conductor_sample(const Material *material, float3 wo) {
  float3 fresnel = fresnel_conductor_rgb(fmin(wo.z, 1.0f), unpack3(material->conductor_eta), unpack3(material->conductor_k));
  Scatter s = {mirror_direction(wo), unpack3(material->reflectance) * fresnel, 0.0f, 1.0f};
  return s;
}

// What it reflects at normal incidence.
INLINE float3 conductor_albedo(const Material *material) {
  float3 eta = unpack3(material->conductor_eta), k = unpack3(material->conductor_k);
  return unpack3(material->reflectance) * (float3)(fresnel_conductor_normal(eta.x, k.x), fresnel_conductor_normal(eta.y, k.y),
                                                   fresnel_conductor_normal(eta.z, k.z));
}

#endif
