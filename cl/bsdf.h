// The one switch over the scattering models. Local frame, wo.z > 0; front says which side of the surface wo is on. Blends have been
// resolved and textures looked up (material.h).
#ifndef OCLAIR_BSDF_H
#define OCLAIR_BSDF_H

#include "dielectric.h"
#include "diffuse.h"
#include "disney_diffuse.h"
#include "features.h"
#include "mirror.h"
#include "oren_nayar.h"
#include "thin_dielectric.h"

// Where only deltas are compiled in this is a constant: light sampling and its traversal are removed.
INLINE bool bsdf_is_delta(const Material *material) {
  bool deltas = HAS_DELTAS;
  return !HAS_NON_DELTAS || (deltas && material->kind >= MATERIAL_MIRROR);
}

// pi f of the diffuse models; 0 for what the kernel is not compiled for.
INLINE float3 bsdf_diffuse_factor(const Material *material, float3 wo, float3 wi) {
  if (HAS(DIFFUSE) && material->kind == MATERIAL_DIFFUSE) return lambert_factor(material);
  if (HAS(OREN_NAYAR) && material->kind == MATERIAL_OREN_NAYAR) return oren_nayar_factor(material, wo, wi);
  if (HAS(OREN_NAYAR_FAST) && material->kind == MATERIAL_OREN_NAYAR_FAST) return oren_nayar_fast_factor(material, wo, wi);
  if (HAS(DISNEY) && material->kind == MATERIAL_DISNEY) return disney_diffuse_factor(material, wo, wi);
  return (float3)(0.0f);
}

INLINE Scatter bsdf_sample(const Material *material, float3 wo, bool front, float2 u) {
  if (HAS(MIRROR) && material->kind == MATERIAL_MIRROR) return mirror_sample(material, wo);
  if (HAS(CONDUCTOR) && material->kind == MATERIAL_CONDUCTOR) return conductor_sample(material, wo);
  if (HAS(DIELECTRIC) && material->kind == MATERIAL_DIELECTRIC) return dielectric_sample(material, wo, front, u.x);
  if (HAS(THIN_DIELECTRIC) && material->kind == MATERIAL_THIN_DIELECTRIC) return thin_dielectric_sample(material, wo, u.x);
  Scatter s = diffuse_sample(u);
  s.weight = bsdf_diffuse_factor(material, wo, s.wi);
  return s;
}

// f times the cosine of wi; 0 for a delta.
INLINE float3 bsdf_eval(const Material *material, float3 wo, float3 wi) {
  if (bsdf_is_delta(material)) return (float3)(0.0f);
  return diffuse_eval(bsdf_diffuse_factor(material, wo, wi), wi);
}

// Solid-angle density of bsdf_sample; 0 for a delta.
INLINE float bsdf_pdf(const Material *material, float3 wi) { return bsdf_is_delta(material) ? 0.0f : diffuse_pdf(wi); }

// The material as one colour, whatever the directions: the reflectance of a diffuse kind or of a mirror; of the kinds with Fresnel
// terms what they send on at normal incidence, in all.
INLINE float3 bsdf_albedo(const Material *material) {
  if (HAS(CONDUCTOR) && material->kind == MATERIAL_CONDUCTOR) return conductor_albedo(material);
  if (HAS(DIELECTRIC) && material->kind == MATERIAL_DIELECTRIC) return dielectric_albedo(material);
  if (HAS(THIN_DIELECTRIC) && material->kind == MATERIAL_THIN_DIELECTRIC) return thin_dielectric_albedo(material);
  return unpack3(material->reflectance);
}

#endif
