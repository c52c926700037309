#include "../cl/diffuse.h"

__kernel void sample(uint count, __global const Material *materials, __global const float2 *u, __global float4 *direction_pdf,
                     __global float4 *weight_eta) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  const Material material = materials[i];
  const Scatter s = diffuse_sample(u[i]);
  direction_pdf[i] = (float4)(s.wi, s.pdf);
  weight_eta[i] = (float4)(s.weight * lambert_factor(&material), s.eta);
}

// x, y, z: the value; w: the density.
__kernel void evaluate(uint count, __global const Material *materials, __global const float4 *wi, __global float4 *result) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  const Material material = materials[i];
  result[i] = (float4)(diffuse_eval(lambert_factor(&material), wi[i].xyz), diffuse_pdf(wi[i].xyz));
}
