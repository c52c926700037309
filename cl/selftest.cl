// The kernels of `oclair selftest`: what the renderer rests on, over arrays of inputs that the host judges (host/selftest/).
#include "dielectric.h"
#include "film.h"
#include "layout.h"
#include "mis.h"
#include "sampler.h"
#include "surface.h"
#include "texture.h"
#include "traverse.h"
#include "warp.h"

#define PROBE __kernel __attribute__((reqd_work_group_size(WORK_GROUP_SIZE, 1, 1))) void

PROBE layout(uint count, __global uint *result) {
  if (get_global_id(0) < count) layout_of_structs(result);
}

// x y - z w and x y + z, each product rounded; x y + z rounded once; difference_of_products.
PROBE products(uint count, __global const float4 *xyzw, __global float4 *result) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  float4 v = xyzw[i];
  result[i] =
      (float4)(v.x * v.y - v.z * v.w, v.x * v.y + v.z, fma(v.x, v.y, v.z), difference_of_products(v.x, v.y, v.z, v.w));
}

// x/y, 1/y, sqrt(x), rsqrt(x) of positive numbers.
PROBE quotients(uint count, __global const float2 *xy, __global float4 *result) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  float2 v = xy[i];
  result[i] = (float4)(v.x / v.y, 1.0f / v.y, sqrt(v.x), rsqrt(v.x));
}

// Functions of one number each: sin, cos of x, exp of y, log of z; powr(z, w).
PROBE functions(uint count, __global const float4 *xyzw, __global float4 *result, __global float *power) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  float4 v = xyzw[i];
  result[i] = (float4)(sin(v.x), cos(v.x), exp(v.y), log(v.z));
  power[i] = powr(v.z, v.w);
}

// A product whose result or factor is denormal.
PROBE multiply(uint count, __global const float2 *xy, __global float *result) {
  size_t i = get_global_id(0);
  if (i < count) result[i] = xy[i].x * xy[i].y;
}

// Comparisons, one bit each: x < y, x <= y, x == y, x != y, x > y, x >= y, !(x > y), x != x.
PROBE compare(uint count, __global const float2 *xy, __global uint *result) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  float x = xy[i].x, y = xy[i].y;
  result[i] = (uint)(x < y) | (uint)(x <= y) << 1 | (uint)(x == y) << 2 | (uint)(x != y) << 3 | (uint)(x > y) << 4 |
              (uint)(x >= y) << 5 | (uint)(!(x > y)) << 6 | (uint)(x != x) << 7;
}

// x + y, x - y, x * y, x / y, sqrt(x), fmin, fmax of any two floats; what film_accepts says of x at exponent 0.
PROBE arithmetic(uint count, __global const float2 *xy, __global float8 *result, __global uint *accepted) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  float x = xy[i].x, y = xy[i].y;
  result[i] = (float8)(x + y, x - y, x * y, x / y, sqrt(x), fmin(x, y), fmax(x, y), 0.0f);
  accepted[i] = film_accepts(x, 0);
}

// x y, the high half of x y, x + y + (x & 1) with its carry (film_carry), x << s, x >> s with s = y modulo 64; of the low
// words x y and its high half.
PROBE integers(uint count, __global const ulong2 *xy, __global ulong8 *result) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  ulong x = xy[i].x, y = xy[i].y, carry = x & 1ul;
  ulong sum = film_carry(x, y, &carry);
  result[i] = (ulong8)(x * y, mul_hi(x, y), sum, carry, x << (y & 63ul), x >> (y & 63ul), (uint)x * (uint)y,
                       mul_hi((uint)x, (uint)y));
}

// To integers, with saturation; to floats.
PROBE conversions(uint count, __global const float *x, __global const uint *n, __global int *saturated,
                  __global float4 *result) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  saturated[i] = convert_int_sat(x[i]);
  result[i] = (float4)(floor(x[i]), rint(x[i]), (float)(n[i] >> 8), (float)(int)n[i]);
}

// Adds samples [i per_pixel, (i + 1) per_pixel), numbered from 0, to pixel 2 i: those between are nobody's.
PROBE film_samples(uint count, __global const packed_float3 *samples, uint per_pixel, int exponent,
                   __global FilmPixel *pixels, __global FilmMoments *moments, __global FilmErrors *errors) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  for (uint k = 0; k < per_pixel; ++k) {
    film_add(pixels + 2 * i, moments + 2 * i, unpack3(samples[i * per_pixel + k]), (k & 1u) == 0u, exponent);
    film_end_sample(pixels + 2 * i, errors + 2 * i, k);
  }
}

// Bits as numbers of the unit interval.
PROBE units(uint count, __global const uint *bits, __global float *result) {
  size_t i = get_global_id(0);
  if (i < count) result[i] = rng_unit(bits[i]);
}

// The numbers of one dimension of a sample of a pixel.
PROBE draw(uint count, __global const Settings *settings, __global const uint *pixel, __global const ulong *sample,
           __global const uint *dimension, __global ulong *bits, __global float2 *point) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  const Sampler sampler = sampler_begin(settings, pixel[i], sample[i]);
  bits[i] = sampler_bits(&sampler, dimension[i]);
  point[i] = sampler_2d(&sampler, dimension[i]);
}

PROBE warps(uint count, __global const float2 *u, __global float2 *circle, __global float4 *hemisphere,
            __global float4 *sphere, __global float2 *triangle) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  circle[i] = warp_circle(u[i].y);
  hemisphere[i] = (float4)(warp_cosine_hemisphere(u[i]), 0.0f);
  sphere[i] = (float4)(warp_sphere(u[i]), 0.0f);
  triangle[i] = warp_triangle(u[i]);
}

PROBE mis_weights(uint count, __global const float2 *densities, __global float *weight) {
  size_t i = get_global_id(0);
  if (i < count) weight[i] = mis_power(densities[i].x, densities[i].y);
}

// Reflectance, transmittance and transmitted cosine; the refracted direction of a ray in the plane y = 0.
PROBE fresnel(uint count, __global const float *cosine, __global const float *eta, __global const uint *front,
              __global float4 *result, __global float4 *refracted) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  const Interface between = interface_from_eta(eta[i], front[i] != 0u);
  const Fresnel f = fresnel_dielectric(cosine[i], between);
  result[i] = (float4)(f.reflectance, f.transmittance, f.cos_t, 0.0f);
  float sine = sqrt((1.0f - cosine[i]) * (1.0f + cosine[i]));
  refracted[i] = (float4)(dielectric_refract((float3)(sine, 0.0f, cosine[i]), f.cos_t, between.eta), sine);
}

// The texels around a coordinate.
PROBE texel_spans(uint count, __global const float *u, uint n, uint wrap, uint nearest, __global uint *first,
                  __global uint *second, __global float *weight) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  const TexelSpan s = texel_span(u[i], n, wrap, nearest != 0u);
  first[i] = s.first;
  second[i] = s.second;
  weight[i] = s.weight;
}

// Component i of a texture.
PROBE texels(uint count, __global const Texture *textures, __global const uchar *bytes, __global float *result) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  const Scene scene = {.textures = textures, .texels = bytes};
  const Texture texture = textures[0];
  result[i] = texel_component(&scene, &texture, i);
}

// Node i against ray i.
PROBE boxes(uint count, __global const BvhNode *nodes, __global const Ray *rays, __global uint *mask, __global float *near) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  const Ray ray = rays[i];
  const Slabs slabs = slabs_from_ray(&ray);
  Lanes lanes;
  mask[i] = node_intersect(nodes + i, &slabs, ray.t_min, ray.t_max, &lanes);
  for (uint lane = 0; lane < BVH_WIDTH; ++lane) near[i * BVH_WIDTH + lane] = lanes.lane[lane];
}

PROBE closest(uint count, __global const BvhNode *nodes, __global const TriangleBlock *blocks, __global const Ray *rays,
              __global Hit *hits, __global uint *blocked) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  const Scene scene = {.nodes = nodes, .blocks = blocks};
  const Ray ray = rays[i];
  hits[i] = traverse_closest(&scene, &ray);
  blocked[i] = traverse_any(&scene, &ray);
}

// Rays that leave the triangles at the hits in direction w: where they start, and whether they hit the very triangle again,
// which is not left out here.
PROBE leave(uint count, __global const TriangleBlock *blocks, __global const Shape *shapes,
            __global const uint *triangle_shape, __global const Hit *hits, __global const packed_float3 *w,
            __global packed_float3 *offset, __global uint *again) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  const Scene scene = {.blocks = blocks, .shapes = shapes, .triangle_shape = triangle_shape};
  const Surface s = surface_on_triangle(&scene, hits[i]);
  const float3 origin = surface_offset(s.position, s.error, s.geometric, unpack3(w[i]));
  offset[i] = pack3(origin - s.position);
  const Ray ray = {pack3(origin), INFINITE_DISTANCE, w[i], NONE, NONE, 0.0f, 0};
  const Shear shear = shear_from_ray(&ray);
  Lanes t, b1, b2;
  const uint mask = triangle_block_intersect(blocks + hits[i].slot / BVH_WIDTH, &shear, ray.t_max, true, &t, &b1, &b2);
  again[i] = mask >> (hits[i].slot % BVH_WIDTH) & 1u;
}

// `bounces` diffuse bounces inside a closed scene; returns after how many the path got out, or had no direction any more (what is not
// finite ends nowhere in a tree of boxes), or `bounces`.
PROBE walk(uint count, __global const BvhNode *nodes, __global const TriangleBlock *blocks, __global const Quadric *quadrics,
           __global const Shape *shapes, __global const uint *triangle_shape, __global const Ray *start, uint bounces,
           __global uint *survived) {
  size_t i = get_global_id(0);
  if (i >= count) return;
  const Scene scene = {
      .nodes = nodes, .blocks = blocks, .quadrics = quadrics, .shapes = shapes, .triangle_shape = triangle_shape};
  Ray ray = start[i];
  const ulong key = rng_key(1ul, (uint)i, 0ul);
  uint n = 0;
  for (; n < bounces; ++n) {
    const Hit hit = traverse_closest(&scene, &ray);
    if (hit.primitive == NONE) break;
    const Surface s = surface_from_hit(&scene, &ray, hit);
    const float3 w = renormalize(frame_to_world(s.frame, warp_cosine_hemisphere(rng_point(rng_bits(key, n)))));
    if (!(fabs(dot(w, w) - 1.0f) < 0x1p-10f)) break;
    ray.origin = pack3(surface_offset(s.position, s.error, s.geometric, w));
    ray.direction = pack3(w);
    ray.skip = hit.primitive;
  }
  survived[i] = n;
}
