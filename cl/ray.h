// What the intersection routines precompute of a ray, and the vectors of BVH_WIDTH lanes that they work on.
#ifndef OCLAIR_RAY_H
#define OCLAIR_RAY_H

#include "vector.h"

#if BVH_WIDTH == 8
typedef float8 floatw;
typedef int8 intw;
typedef uint8 uintw;
#define load_lanes(place) load8(*(__global const stored_float8 *)(place))
#elif BVH_WIDTH == 4
typedef float4 floatw;
typedef int4 intw;
typedef uint4 uintw;
#define load_lanes(place) load4(*(__global const stored_float4 *)(place))
#else
#error "BVH_WIDTH must be 4 or 8"
#endif

// What x86 does in one instruction and OpenCL C has no word for: only where the compiler knows it (oclgrind's does not).
#if defined(__x86_64__) && defined(__has_builtin)
#define HAS_BUILTIN(name) __has_builtin(name)
#else
#define HAS_BUILTIN(name) 0
#endif

// Bit i is set where lane i of a comparison's result is true (-1).
INLINE uint lane_mask(intw m) {
#if BVH_WIDTH == 8 && !DOUBLE_PRECISION && defined(__AVX__) && HAS_BUILTIN(__builtin_ia32_movmskps256)
  return (uint)__builtin_ia32_movmskps256(as_float8(m));
#elif BVH_WIDTH == 8
  return (m.s0 & 1) | (m.s1 & 2) | (m.s2 & 4) | (m.s3 & 8) | (m.s4 & 16) | (m.s5 & 32) | (m.s6 & 64) | (m.s7 & 128);
#else
  return (m.s0 & 1) | (m.s1 & 2) | (m.s2 & 4) | (m.s3 & 8);
#endif
}

// A vector and its lanes by number.
typedef union Lanes {
  floatw vector;
  float lane[BVH_WIDTH];
} Lanes;

// Number of the lowest bit of a mask that is not 0.
INLINE uint lowest_lane(uint mask) {
#if HAS_BUILTIN(__builtin_ctz)
  return (uint)__builtin_ctz(mask);
#else
  return 31u - clz(mask & -mask);
#endif
}

// A ray as the triangle test wants it: axis kz is the one along which the direction is longest.
typedef struct Shear {
  uint kx, ky, kz;
  float origin_x, origin_y, origin_z;   // in the order kx, ky, kz
  float shear_x, shear_y, shear_z;      // d.kx / d.kz, d.ky / d.kz, 1 / d.kz
} Shear;

INLINE Shear shear_from_ray(const Ray *ray) {
  float d[3] = {ray->direction.x, ray->direction.y, ray->direction.z};
  float o[3] = {ray->origin.x, ray->origin.y, ray->origin.z};
  Shear s;
  s.kz = fabs(d[0]) > fabs(d[1]) ? (fabs(d[0]) > fabs(d[2]) ? 0u : 2u) : (fabs(d[1]) > fabs(d[2]) ? 1u : 2u);
  s.kx = s.kz == 2u ? 0u : s.kz + 1u;
  s.ky = s.kx == 2u ? 0u : s.kx + 1u;
  s.shear_z = 1.0f / d[s.kz];
  s.shear_x = d[s.kx] * s.shear_z;
  s.shear_y = d[s.ky] * s.shear_z;
  s.origin_x = o[s.kx];
  s.origin_y = o[s.ky];
  s.origin_z = o[s.kz];
  return s;
}

// A ray as the slab test wants it: a plane at b is met at t = fma(b, reciprocal, offset).
typedef struct Slabs {
  float3 reciprocal;
  float3 offset;
  uint near[3];  // row of BvhNode::bounds with the plane that is met first, per axis; the other is near ^ 1
} Slabs;

// Direction components below 2^-40 count as +-2^-40: a ray of a scene in [-1, 1]^3 moves by less than 2^-37 along such an axis,
// far below the padding of the boxes (host/bvh.cpp), and no product becomes infinite or NaN.
INLINE Slabs slabs_from_ray(const Ray *ray) {
  float3 d = unpack3(ray->direction);
  d = copysign(fmax(fabs(d), (float3)(0x1p-40f)), d);
  Slabs s;
  s.reciprocal = 1.0f / d;
  s.offset = -unpack3(ray->origin) * s.reciprocal;
  s.near[0] = d.x < 0.0f ? 1u : 0u;
  s.near[1] = d.y < 0.0f ? 3u : 2u;
  s.near[2] = d.z < 0.0f ? 5u : 4u;
  return s;
}

#endif
