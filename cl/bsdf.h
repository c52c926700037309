// The one switch over the scattering models. Local frame, wo.z > 0; front says which side of the surface wo is on.
#ifndef OCLAIR_BSDF_H
#define OCLAIR_BSDF_H

#include "dielectric.h"
#include "diffuse.h"
#include "features.h"
#include "mirror.h"

// Where only deltas are compiled in this is a constant: light sampling and its traversal are removed.
INLINE bool bsdf_is_delta(const Material *material) { return !HAS(DIFFUSE) || material->kind != MATERIAL_DIFFUSE; }

INLINE Scatter bsdf_sample(const Material *material, float3 wo, bool front, float2 u) {
  if (HAS(DIFFUSE) && material->kind == MATERIAL_DIFFUSE) return diffuse_sample(material, u);
  if (HAS(MIRROR) && material->kind == MATERIAL_MIRROR) return mirror_sample(material, wo);
  if (HAS(CONDUCTOR) && material->kind == MATERIAL_CONDUCTOR) return conductor_sample(material, wo);
  if (HAS(DIELECTRIC) && material->kind == MATERIAL_DIELECTRIC) return dielectric_sample(material, wo, front, u.x);
  Scatter none = {(float3)(0.0f, 0.0f, 1.0f), (float3)(0.0f), 0.0f, 1.0f};
  return none;
}

// f times the cosine of wi; 0 for a delta.
INLINE float3 bsdf_eval(const Material *material, float3 wi) {
  if (HAS(DIFFUSE) && material->kind == MATERIAL_DIFFUSE) return diffuse_eval(material, wi);
  return (float3)(0.0f);
}

// Solid-angle density of bsdf_sample; 0 for a delta.
INLINE float bsdf_pdf(const Material *material, float3 wi) {
  if (HAS(DIFFUSE) && material->kind == MATERIAL_DIFFUSE) return diffuse_pdf(wi);
  return 0.0f;
}

#endif
