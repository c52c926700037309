// A sheet of dielectric too thin to shift what is seen through it: all orders of reflection between its two sides, which are lost
// in no direction but the mirror's and straight through. Local frame, wo.z > 0.
#ifndef OCLAIR_THIN_DIELECTRIC_H
#define OCLAIR_THIN_DIELECTRIC_H

#include "fresnel.h"
#include "mirror.h"

// What is reflected, given R of one side: with T = 1 - R it is R + T^2 R/(1 - R^2) = 2 R/(1 + R); transmitted is T/(1 + R).
INLINE float thin_dielectric_reflectance(float one_side) { return 2.0f * one_side / (1.0f + one_side); }

// u in [0, 1) chooses.
INLINE Scatter thin_dielectric_sample(const Material *material, float3 wo, float u) {
  Fresnel fresnel = fresnel_dielectric(fmin(wo.z, 1.0f), interface_from_eta(material->eta, true));
  float reflectance = thin_dielectric_reflectance(fresnel.reflectance);
  bool reflected = u < reflectance;
  Scatter s = {-wo, unpack3(material->transmittance), 0.0f, 1.0f};
  if (reflected) {
    s.wi = mirror_direction(wo);
    s.weight = unpack3(material->reflectance);
  }
  return s;
}

// What it reflects and lets through at normal incidence, in all.
INLINE float3 thin_dielectric_albedo(const Material *material) {
  float one_side = fresnel_dielectric_exact(1.0f, interface_from_eta(material->eta, true)).reflectance;
  return mix(unpack3(material->transmittance), unpack3(material->reflectance), thin_dielectric_reflectance(one_side));
}

#endif
