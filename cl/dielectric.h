// Smooth dielectric interface: reflection or refraction, chosen with the probability of the exact Fresnel reflectance, so that
// the weight of either is exactly its colour. Local frame, wo.z > 0.
#ifndef OCLAIR_DIELECTRIC_H
#define OCLAIR_DIELECTRIC_H

#include "fresnel.h"
#include "mirror.h"
#include "scatter.h"

// Snell's law with the cosine that the Fresnel equations used: sin_t / sin_i = 1 / eta. Unit length to 1e-6 (u eta).
INLINE float3 dielectric_refract(float3 wo, float cos_t, float eta) {
  float inverse_eta = 1.0f / eta;
  return renormalize((float3)(-wo.x * inverse_eta, -wo.y * inverse_eta, -cos_t));
}

// u in [0, 1) chooses: reflection below the reflectance. Radiance that crosses into a medium scales with 1 / eta^2 along the
// path as it is traced, from the eye (Veach 1997, 5.2): radiance over the squared index is what is conserved.
INLINE Scatter dielectric_sample(const Material *material, float3 wo, bool front, float u) {
  Interface interface = interface_from_eta(material->eta, front);
  Fresnel fresnel = fresnel_dielectric(fmin(wo.z, 1.0f), interface);
  Scatter s;
  s.pdf = 0.0f;
  if (u < fresnel.reflectance) {
    s.wi = mirror_direction(wo);
    s.weight = unpack3(material->reflectance);
    s.eta = 1.0f;
  } else {
    s.wi = dielectric_refract(wo, fresnel.cos_t, interface.eta);
    s.weight = unpack3(material->transmittance) / interface.eta2;
    s.eta = interface.eta;
  }
  return s;
}

// What it reflects and lets through at normal incidence, in all: the same from both sides.
INLINE float3 dielectric_albedo(const Material *material) {
  float reflectance = fresnel_dielectric_exact(1.0f, interface_from_eta(material->eta, true)).reflectance;
  return mix(unpack3(material->transmittance), unpack3(material->reflectance), reflectance);
}

#endif
