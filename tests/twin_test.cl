// Compiled twice by twin_test.cpp: in float, and with -DDOUBLE_PRECISION=1, where `float` below is double (precision.h).
// Inputs are floats for both; a row of results for each.
#include "../cl/bsdf.h"
#include "../cl/camera.h"
#include "../cl/light.h"
#include "../cl/normal_map.h"
#include "../cl/triangle.h"

INLINE void put3(__global float* to, float3 v) {
  to[0] = v.x;
  to[1] = v.y;
  to[2] = v.z;
}

// z: 1 - cos of the cone.
__kernel void warps(uint count, __global const stored_float3* points, __global float* result) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  float3 p = unpack3(points[i]);
  __global float* to = result + 12 * i;
  float2 circle = warp_circle(p.y), triangle = warp_triangle(p.xy);
  to[0] = circle.x;
  to[1] = circle.y;
  put3(to + 2, warp_cosine_hemisphere(p.xy));
  put3(to + 5, warp_cone(p.xy, p.z));
  to[8] = warp_cone_pdf(p.z);
  to[9] = triangle.x;
  to[10] = triangle.y;
  to[11] = warp_cosine_hemisphere_pdf(p.x);
}

__kernel void dielectrics(uint count, __global const stored_float3* wo, __global const stored_float* eta,
                          __global const uint* front, __global float* result) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  float3 w = unpack3(wo[i]);
  const Interface between = interface_from_eta(eta[i], front[i] != 0);
  const Fresnel fresnel = fresnel_dielectric_exact(fmin(w.z, 1.0f), between);
  __global float* to = result + 6 * i;
  to[0] = fresnel.reflectance;
  to[1] = fresnel.transmittance;
  to[2] = fresnel.cos_t;
  put3(to + 3, fresnel.cos_t > 0.0f ? dielectric_refract(w, fresnel.cos_t, between.eta) : w);
}

// x: cosine, y: eta, z: k.
__kernel void conductors(uint count, __global const stored_float3* arguments, __global float* result) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  float3 a = unpack3(arguments[i]);
  result[2 * i] = fresnel_conductor_exact(a.x, a.y, a.z);
  result[2 * i + 1] = fresnel_conductor_normal(a.y, a.z);
}

// Red of f times the cosine of wi: Lambert, Oren-Nayar (full, qualitative), Disney.
__kernel void diffuses(uint count, __global const Material* materials, __global const stored_float3* wo,
                       __global const stored_float3* wi, __global float* result) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  const Material m = materials[i];
  float3 o = unpack3(wo[i]), w = unpack3(wi[i]);
  __global float* to = result + 4 * i;
  to[0] = diffuse_eval(lambert_factor(&m), w).x;
  to[1] = diffuse_eval(oren_nayar_factor(&m, o, w), w).x;
  to[2] = diffuse_eval(oren_nayar_fast_factor(&m, o, w), w).x;
  to[3] = diffuse_eval(disney_diffuse_factor(&m, o, w), w).x;
}

__kernel void powers(uint count, __global const stored_float2* densities, __global float* result) {
  size_t i = get_global_id(0);
  if (i < count) result[i] = mis_power(densities[i].x, densities[i].y);
}

// Lane 0 of block i: t, b1, b2, or of a miss -1, 0, 0.
__kernel void triangles(uint count, __global const TriangleBlock* blocks, __global const stored_float3* origins,
                        __global const stored_float3* directions, __global float* result) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  Ray ray = {.origin = pack3(unpack3(origins[i])), .direction = pack3(unpack3(directions[i])), .t_max = INFINITE_DISTANCE};
  const Shear shear = shear_from_ray(&ray);
  Lanes t, b1, b2;
  t.vector = b1.vector = b2.vector = (floatw)(0.0f);
  uint mask = triangle_block_intersect(blocks + i, &shear, INFINITE_DISTANCE, true, &t, &b1, &b2);
  __global float* to = result + 3 * i;
  to[0] = mask & 1u ? t.lane[0] : -1.0f;
  to[1] = mask & 1u ? b1.lane[0] : 0.0f;
  to[2] = mask & 1u ? b2.lane[0] : 0.0f;
}

__kernel void normals(uint count, __global const stored_float3* edge1, __global const stored_float3* edge2,
                      __global float* result) {
  size_t i = get_global_id(0);
  if (i < count) put3(result + 3 * i, triangle_normal(unpack3(edge1[i]), unpack3(edge2[i])));
}

// Direction, distance, weight of red, density.
__kernel void lights(uint count, __global const Light* all, __global const Quadric* quadrics,
                     __global const stored_float3* from, __global const ulong* bits, __global float* result) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  Scene scene = {.quadrics = quadrics};
  const Light light = all[i];
  const LightSample s = light_sample(&scene, &light, unpack3(from[i]), bits[i]);
  __global float* to = result + 6 * i;
  put3(to, s.direction);
  to[3] = s.distance;
  to[4] = s.weight.x;
  to[5] = s.pdf;
}

// x, y: on the film; z, w: on the lens. Origin, direction, t_max.
__kernel void cameras(uint count, __global const Camera* all, __global const stored_float4* points, __global float* result) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  const Camera camera = all[i];
  float4 p = load4(points[i]);
  const Ray ray = camera_ray(&camera, p.x, p.y, p.zw);
  __global float* to = result + 7 * i;
  put3(to, unpack3(ray.origin));
  put3(to + 3, unpack3(ray.direction));
  to[6] = ray.t_max;
}

// Decoded colour; columns x and y of the tangent frame; bump normal.
__kernel void reliefs(uint count, __global const stored_float3* colors, __global const stored_float3* normals,
                      __global const stored_float3* dp_du, __global const stored_float3* dp_dv,
                      __global const stored_float2* slopes, __global float* result) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  float3 n = unpack3(normals[i]), du = unpack3(dp_du[i]), dv = unpack3(dp_dv[i]);
  const Frame frame = tangent_frame(n, du);
  __global float* to = result + 12 * i;
  put3(to, normal_map_decode(unpack3(colors[i])));
  put3(to + 3, frame.x);
  put3(to + 6, frame.y);
  put3(to + 9, bump_normal(n, du, dv, load2(slopes[i])));
}
