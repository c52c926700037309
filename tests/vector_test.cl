#include "../cl/vector.h"

__kernel void pack(uint count, __global const float4 *v, __global packed_float3 *packed) {
  size_t i = get_global_id(0);
  if (i < count) packed[i] = pack3(v[i].xyz);
}

__kernel void unpack(uint count, __global const packed_float3 *packed, __global float4 *v) {
  size_t i = get_global_id(0);
  if (i < count) v[i] = (float4)(unpack3(packed[i]), 0.0f);
}

__kernel void difference(uint count, __global const float4 *abcd, __global float *result) {
  size_t i = get_global_id(0);
  if (i < count) result[i] = difference_of_products(abcd[i].x, abcd[i].y, abcd[i].z, abcd[i].w);
}

__kernel void cross_product(uint count, __global const float4 *a, __global const float4 *b, __global float4 *result) {
  size_t i = get_global_id(0);
  if (i < count) result[i] = (float4)(cross_exact(a[i].xyz, b[i].xyz), 0.0f);
}

__kernel void renormalized(uint count, __global const float4 *d, __global float4 *result) {
  size_t i = get_global_id(0);
  if (i < count) result[i] = (float4)(renormalize(d[i].xyz), 0.0f);
}

__kernel void largest(uint count, __global const float4 *v, __global float *result) {
  size_t i = get_global_id(0);
  if (i < count) result[i] = max_component(v[i].xyz);
}

__kernel void frame(uint count, __global const float4 *n, __global float4 *x, __global float4 *y, __global float4 *z) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  const Frame f = frame_from_normal(n[i].xyz);
  x[i] = (float4)(f.x, 0.0f);
  y[i] = (float4)(f.y, 0.0f);
  z[i] = (float4)(f.z, 0.0f);
}

__kernel void change_frame(uint count, __global const float4 *x, __global const float4 *y, __global const float4 *z,
                           __global const float4 *v, __global float4 *to_local, __global float4 *to_world) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  Frame f;
  f.x = x[i].xyz;
  f.y = y[i].xyz;
  f.z = z[i].xyz;
  to_local[i] = (float4)(frame_to_local(f, v[i].xyz), 0.0f);
  to_world[i] = (float4)(frame_to_world(f, v[i].xyz), 0.0f);
}
