// Lambert diffuse reflection: f = albedo / pi. Local frame, wo.z > 0.
#ifndef OCLAIR_DIFFUSE_H
#define OCLAIR_DIFFUSE_H

#include "scatter.h"
#include "warp.h"

INLINE float diffuse_pdf(float3 wi) { return warp_cosine_hemisphere_pdf(wi.z); }

// f times the cosine of wi.
INLINE float3 diffuse_eval(const Material *material, float3 wi) {
  return unpack3(material->reflectance) * warp_cosine_hemisphere_pdf(wi.z);
}

// The cosine and pi cancel against the density: the weight is the albedo, and no division can fail.
INLINE Scatter diffuse_sample(const Material *material, float2 u) {
  Scatter s;
  s.wi = warp_cosine_hemisphere(u);
  s.weight = unpack3(material->reflectance);
  s.pdf = diffuse_pdf(s.wi);
  s.eta = 1.0f;
  return s;
}

#endif
