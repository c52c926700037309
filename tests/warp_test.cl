#include "../cl/warp.h"

__kernel void circle(uint count, __global const float *u, __global float2 *result) {
  size_t i = get_global_id(0);
  if (i < count) result[i] = warp_circle(u[i]);
}

__kernel void disk(uint count, __global const float2 *u, __global float2 *result) {
  size_t i = get_global_id(0);
  if (i < count) result[i] = warp_disk(u[i]);
}

__kernel void cosine_hemisphere(uint count, __global const float2 *u, __global float4 *result) {
  size_t i = get_global_id(0);
  if (i < count) result[i] = (float4)(warp_cosine_hemisphere(u[i]), 0.0f);
}

__kernel void cone(uint count, __global const float2 *u, float one_minus_cos, __global float4 *result) {
  size_t i = get_global_id(0);
  if (i < count) result[i] = (float4)(warp_cone(u[i], one_minus_cos), 0.0f);
}

__kernel void sphere(uint count, __global const float2 *u, __global float4 *result) {
  size_t i = get_global_id(0);
  if (i < count) result[i] = (float4)(warp_sphere(u[i]), 0.0f);
}

__kernel void triangle(uint count, __global const float2 *u, __global float2 *result) {
  size_t i = get_global_id(0);
  if (i < count) result[i] = warp_triangle(u[i]);
}

// Densities: x the cosine hemisphere's at this cosine, y the cone's of this size, z the disk's, w the sphere's.
__kernel void densities(uint count, __global const float *argument, __global float4 *result) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  result[i] = (float4)(warp_cosine_hemisphere_pdf(argument[i]), warp_cone_pdf(argument[i]), warp_disk_pdf(), warp_sphere_pdf());
}
