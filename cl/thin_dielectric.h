// A sheet of dielectric too thin to shift what is seen through it: all orders of reflection between its two sides, which are lost
// in no direction but the mirror's and straight through. Local frame, wo.z > 0.
#ifndef OCLAIR_THIN_DIELECTRIC_H
#define OCLAIR_THIN_DIELECTRIC_H

#include "fresnel.h"
#include "mirror.h"

// With R and T = 1 - R of one side: reflected R + T^2 R/(1 - R^2) = 2 R/(1 + R), transmitted T/(1 + R). u in [0, 1) chooses.
INLINE Scatter thin_dielectric_sample(const Material *material, float3 wo, float u) {
  Fresnel fresnel = fresnel_dielectric(fmin(wo.z, 1.0f), interface_from_eta(material->eta, true));
  float reflectance = 2.0f * fresnel.reflectance / (1.0f + fresnel.reflectance);
  bool reflected = u < reflectance;
  Scatter s = {-wo, unpack3(material->transmittance), 0.0f, 1.0f};
  if (reflected) {
    s.wi = mirror_direction(wo);
    s.weight = unpack3(material->reflectance);
  }
  return s;
}

#endif
