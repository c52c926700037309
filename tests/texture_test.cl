#include "../cl/texture.h"

// The texels around a coordinate: first, second and the bits of the weight.
__kernel void spans(uint count, __global const float *u, uint n, uint wrap, uint nearest, __global uint *first, __global uint *second,
                    __global float *weight) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  TexelSpan s = texel_span(u[i], n, wrap, nearest != 0u);
  first[i] = s.first;
  second[i] = s.second;
  weight[i] = s.weight;
}

// Value, number (w) and gradient of textures[which[i]] at uv[i].
__kernel void evaluate(uint count, __global const Texture *textures, __global const uchar *texels, __global const float *srgb,
                       __global const uint *which, __global const float2 *uv, __global float4 *value, __global float2 *gradient) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  Scene scene = {.textures = textures, .texels = texels, .srgb = srgb};
  TexturePoint at = {uv[i], 0.0f, 0.0f, NONE, 0u};
  value[i] = (float4)(texture_eval(&scene, which[i] + 1u, &at), texture_number(&scene, which[i] + 1u, &at));
  gradient[i] = texture_gradient(&scene, which[i] + 1u, &at);
}

// Attributes of a mesh whose first triangle is `first_triangle`, at barycentric coordinates of the triangles.
__kernel void attributes(uint count, __global const Texture *textures, __global const uchar *texels,
                         __global const packed_uint3 *triangle_vertices, uint first_triangle, __global const uint *which,
                         __global const uint *triangle, __global const float2 *b, __global float4 *value) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  Scene scene = {.textures = textures, .texels = texels, .triangle_vertices = triangle_vertices};
  TexturePoint at = {(float2)(0.0f), b[i].x, b[i].y, triangle[i], triangle[i] - first_triangle};
  value[i] = (float4)(texture_eval(&scene, which[i] + 1u, &at), texture_number(&scene, which[i] + 1u, &at));
}

__kernel void wrapped(uint count, __global const float* u, uint wrap, __global float* result) {
  size_t i = get_global_id(0);
  if (i < count) result[i] = texture_wrapped(u[i], wrap);
}

__kernel void neighbours(uint count, __global const int* texel, uint n, uint wrap, __global uint* result) {
  size_t i = get_global_id(0);
  if (i < count) result[i] = texel_neighbour(texel[i], n, wrap);
}

__kernel void curves(uint count, __global const float4* colour, __global float* gray, __global float* linear) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  gray[i] = luminance(colour[i].xyz);
  linear[i] = srgb_decoded(colour[i].w);
}
