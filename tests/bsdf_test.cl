#include "../cl/bsdf.h"

__kernel void sample(uint count, __global const Material *materials, __global const float4 *wo, __global const uint *front,
                     __global const float2 *u, __global float4 *direction_pdf, __global float4 *weight_eta) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  const Material material = materials[i];
  const Scatter s = bsdf_sample(&material, wo[i].xyz, front[i] != 0, u[i]);
  direction_pdf[i] = (float4)(s.wi, s.pdf);
  weight_eta[i] = (float4)(s.weight, s.eta);
}

__kernel void evaluate(uint count, __global const Material *materials, __global const float4 *wo, __global const float4 *wi,
                       __global float4 *value_pdf,
                       __global uint *is_delta) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  const Material material = materials[i];
  value_pdf[i] = (float4)(bsdf_eval(&material, wo[i].xyz, wi[i].xyz), bsdf_pdf(&material, wi[i].xyz));
  is_delta[i] = bsdf_is_delta(&material);
}
