#include "../cl/fresnel.h"

// One row for each combination: reflectance, transmittance, cosine of the transmitted direction, relative index.
__kernel void dielectric(uint count, __global const float *cosine, __global const float *eta, __global const uint *front,
                         __global float4 *result) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  const Interface between = interface_from_eta(eta[i], front[i] != 0);
  const Fresnel fresnel = fresnel_dielectric(cosine[i], between);
  result[i] = (float4)(fresnel.reflectance, fresnel.transmittance, fresnel.cos_t, between.eta);
}

__kernel void interfaces(uint count, __global const float *eta, __global const uint *front, __global float4 *result) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  const Interface between = interface_from_eta(eta[i], front[i] != 0);
  result[i] = (float4)(between.eta, between.eta2, between.eta2_minus_one, 0.0f);
}

__kernel void conductor(uint count, __global const float *cosine, __global const float *eta, __global const float *k,
                        __global float *reflectance) {
  size_t i = get_global_id(0);
  if (i < count) reflectance[i] = fresnel_conductor(cosine[i], eta[i], k[i]);
}

__kernel void conductor_rgb(uint count, __global const float *cosine, __global const float4 *eta, __global const float4 *k,
                            __global float4 *reflectance) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  const float3 f = fresnel_conductor_rgb(cosine[i], eta[i].xyz, k[i].xyz);
  reflectance[i] = (float4)(f, 0.0f);
}
