// Diffuse reflection: Lambert, and what the other diffuse models share with it. Each is a factor pi f, which is the albedo for
// Lambert, under cosine-weighted sampling. Local frame, wo.z > 0.
#ifndef OCLAIR_DIFFUSE_H
#define OCLAIR_DIFFUSE_H

#include "scatter.h"
#include "warp.h"

INLINE float diffuse_pdf(float3 wi) { return warp_cosine_hemisphere_pdf(wi.z); }

// f times the cosine of wi, of a model whose factor pi f at wi is given.
INLINE float3 diffuse_eval(float3 factor, float3 wi) { return factor * warp_cosine_hemisphere_pdf(wi.z); }

// A direction; the weight is the factor there, which the caller puts in: the cosine and pi cancel against the density, and no
// division can fail.
INLINE Scatter diffuse_sample(float2 u) {
  Scatter s;
  s.wi = warp_cosine_hemisphere(u);
  s.weight = (float3)(1.0f);
  s.pdf = diffuse_pdf(s.wi);
  s.eta = 1.0f;
  return s;
}

// pi f of a Lambert surface.
INLINE float3 lambert_factor(const Material *material) { return unpack3(material->reflectance); }

#endif
