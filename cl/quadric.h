// Spheres, disks and open cylinders as unit quadrics in a local frame (types.h). Compiled only if a scene has one.
#ifndef OCLAIR_QUADRIC_H
#define OCLAIR_QUADRIC_H

#include "features.h"
#include "vector.h"

INLINE float3 quadric_to_local(const Quadric *quadric, float3 v) {
  return (float3)(dot(unpack3(quadric->axis_x), v), dot(unpack3(quadric->axis_y), v), dot(unpack3(quadric->axis_z), v));
}

// The axes are orthogonal, so the inverse divides each by its squared length.
INLINE float3 quadric_to_world(const Quadric *quadric, float3 q) {
  float3 x = unpack3(quadric->axis_x), y = unpack3(quadric->axis_y), z = unpack3(quadric->axis_z);
  return x * (q.x / dot(x, x)) + y * (q.y / dot(y, y)) + z * (q.z / dot(z, z));
}

// Roots of |o + t d| = 1 in dimensions 2 or 3 given a = d.d, without the cancellation of b^2 - 4ac: the distance of the ray
// from the centre is formed as a vector (Haines, Guenther, Akenine-Moeller 2019, Ray Tracing Gems ch. 7). False: no root.
INLINE bool quadric_roots(float3 o, float3 d, float *near, float *far) {
  float a = dot(d, d);
  if (!(a > 0.0f)) return false;
  float b = -dot(o, d);
  float3 closest = fma(d, (float3)(b / a), o);
  float discriminant = 1.0f - dot(closest, closest);
  if (!(discriminant >= 0.0f)) return false;
  float root = sqrt(a * discriminant);
  float q = b + copysign(root, b);
  float c = dot(o, o) - 1.0f;
  float t0 = q / a;
  float t1 = q == 0.0f ? t0 : c / q;
  *near = fmin(t0, t1);
  *far = fmax(t0, t1);
  return true;
}

// Smallest t > 0 in [t_min, t_max] at which the ray meets the quadric, or INFINITE_DISTANCE. A ray that starts on it (starts) has a root at
// 0 up to rounding, which is left out whatever its sign; a ray that ends on it at t_max (ends) likewise has one there. Nothing of a
// disk, or of a sphere whose front is outside, can be in the way of a ray that ends on its front; a near wall can.
INLINE float quadric_intersect(const Quadric *quadric, float3 origin, float3 direction, float t_min, float t_max, bool starts,
                               bool ends) {
  float3 o = quadric_to_local(quadric, origin - unpack3(quadric->center));
  float3 d = quadric_to_local(quadric, direction);
  if (HAS(DISKS) && quadric->kind == QUADRIC_DISK) {
    float t = -o.z / d.z;
    float2 q = fma(d.xy, (float2)(t), o.xy);
    bool hit = !starts && !ends && t > 0.0f && t >= t_min && t <= t_max && dot(q, q) <= 1.0f;
    return hit ? t : INFINITE_DISTANCE;
  }
  bool cylinder = HAS(CYLINDERS) && quadric->kind == QUADRIC_CYLINDER;
  if (ends && !cylinder && quadric->flip > 0.0f) return INFINITE_DISTANCE;
  float3 across = cylinder ? (float3)(1.0f, 1.0f, 0.0f) : (float3)(1.0f);
  float root[2];
  if (!quadric_roots(o * across, d * across, &root[0], &root[1])) return INFINITE_DISTANCE;
  int own = starts ? (fabs(root[0]) < fabs(root[1]) ? 0 : 1) : -1;
  int end = ends ? (fabs(root[0] - t_max) < fabs(root[1] - t_max) ? 0 : 1) : -1;
  for (int i = 0; i < 2; ++i) {
    float t = root[i];
    float z = fma(d.z, t, o.z);
    bool in_range = !cylinder || (z >= 0.0f && z <= 1.0f);
    if (t > 0.0f && t >= t_min && t <= t_max && i != own && i != end && in_range) return t;
  }
  return INFINITE_DISTANCE;
}

// The point of the quadric nearest to a computed hit, in local coordinates: takes out the rounding of origin + t direction.
INLINE float3 quadric_project(const Quadric *quadric, float3 q) {
  if (HAS(DISKS) && quadric->kind == QUADRIC_DISK) return (float3)(q.x, q.y, 0.0f);
  if (HAS(CYLINDERS) && quadric->kind == QUADRIC_CYLINDER) return (float3)(normalize(q.xy), q.z);
  return normalize(q);
}

// Error bound of center + offset, a point of the quadric: projection and the map to the world take fewer than 16 roundings of the
// offset's length, the sum one of the centre.
INLINE float3 quadric_error(float3 center, float3 offset) { return 16.0f * 0x1p-24f * (fabs(center) + length(offset)); }

// Unit normal on the front side at the local point q: normals go with the transposed map.
INLINE float3 quadric_normal(const Quadric *quadric, float3 q) {
  float3 n = q;
  if (HAS(DISKS) && quadric->kind == QUADRIC_DISK) n = (float3)(0.0f, 0.0f, 1.0f);
  if (HAS(CYLINDERS) && quadric->kind == QUADRIC_CYLINDER) n = (float3)(q.x, q.y, 0.0f);
  float3 world = unpack3(quadric->axis_x) * n.x + unpack3(quadric->axis_y) * n.y + unpack3(quadric->axis_z) * n.z;
  return quadric->flip * normalize(world);
}

#endif
