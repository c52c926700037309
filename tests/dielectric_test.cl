#include "../cl/dielectric.h"

__kernel void sample(uint count, __global const Material *materials, __global const float4 *wo, __global const uint *front,
                     __global const float *u, __global float4 *direction_pdf, __global float4 *weight_eta) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  const Material material = materials[i];
  const Scatter s = dielectric_sample(&material, wo[i].xyz, front[i] != 0, u[i]);
  direction_pdf[i] = (float4)(s.wi, s.pdf);
  weight_eta[i] = (float4)(s.weight, s.eta);
}

// The refracted direction and the cosine that went into it.
__kernel void refracted(uint count, __global const float4 *wo, __global const float *eta, __global const uint *front,
                        __global float4 *result) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  const Interface between = interface_from_eta(eta[i], front[i] != 0);
  const Fresnel fresnel = fresnel_dielectric(wo[i].z, between);
  result[i] = (float4)(dielectric_refract(wo[i].xyz, fresnel.cos_t, between.eta), fresnel.cos_t);
}

// Through a stack of parallel plates: into glass, out of it, and so on, always refracted.
__kernel void cross_plates(uint count, __global const Material *materials, __global const float4 *wo, uint crossings,
                           __global float4 *result) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  const Material material = materials[i];
  float3 d = wo[i].xyz;
  for (uint k = 0; k < crossings; ++k) d = -dielectric_sample(&material, d, (k & 1) == 0, 0x1.fffffep-1f).wi;
  result[i] = (float4)(d, 0.0f);
}
