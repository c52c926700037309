// Watertight ray-triangle intersection, BVH_WIDTH triangles at a time (Woop, Benthin, Wald 2013, JCGT 2(1)).
// The ray becomes the z axis by a shear that is the same for every triangle; a shared vertex is then the same pair of floats
// in all its triangles, and the edge function of a shared edge changes only its sign: no ray passes between them. This rests on
// FP_CONTRACT OFF (types.h). The paper's fall-back to double for an edge function of exactly 0 changes nothing here: 0 counts as inside.
#ifndef OCLAIR_TRIANGLE_H
#define OCLAIR_TRIANGLE_H

#include "ray.h"

// stop_early: whether to look first if the ray is inside any lane's edges. Worth it where the answer can be predicted, as for rays
// that stop at their nearest hit. Bit i of the result is set where lane i is hit at 0 < t <= t_max; for those lanes *t, *b1, *b2 hold the parameter and the
// barycentric coordinates of vertices 1 and 2.
INLINE uint triangle_block_intersect(__global const TriangleBlock *block, const Shear *ray, float t_max, bool stop_early,
                                     Lanes *t, Lanes *b1, Lanes *b2) {
#define VERTEX(i, axis) load_lanes(block->vertex[i][axis])
  floatw az = VERTEX(0, ray->kz) - ray->origin_z;
  floatw bz = VERTEX(1, ray->kz) - ray->origin_z;
  floatw cz = VERTEX(2, ray->kz) - ray->origin_z;
  floatw ax = fma((floatw)(-ray->shear_x), az, VERTEX(0, ray->kx) - ray->origin_x);
  floatw ay = fma((floatw)(-ray->shear_y), az, VERTEX(0, ray->ky) - ray->origin_y);
  floatw bx = fma((floatw)(-ray->shear_x), bz, VERTEX(1, ray->kx) - ray->origin_x);
  floatw by = fma((floatw)(-ray->shear_y), bz, VERTEX(1, ray->ky) - ray->origin_y);
  floatw cx = fma((floatw)(-ray->shear_x), cz, VERTEX(2, ray->kx) - ray->origin_x);
  floatw cy = fma((floatw)(-ray->shear_y), cz, VERTEX(2, ray->ky) - ray->origin_y);
#undef VERTEX
  floatw u = cx * by - cy * bx;
  floatw v = ax * cy - ay * cx;
  floatw w = bx * ay - by * ax;
  intw inside = ((u >= 0.0f) & (v >= 0.0f) & (w >= 0.0f)) | ((u <= 0.0f) & (v <= 0.0f) & (w <= 0.0f));
  if (stop_early && !lane_mask(inside)) return 0;
  floatw det = u + v + w;
  floatw inverse_det = 1.0f / det;  // det == 0 gives infinity or NaN, and the comparisons below fail
  floatw distance = (u * az + v * bz + w * cz) * ray->shear_z * inverse_det;
  t->vector = distance;
  b1->vector = v * inverse_det;
  b2->vector = w * inverse_det;
  return lane_mask(inside & (distance > 0.0f) & (distance <= t_max));
}

// Edge function of the directed edge from a to b, vertices in the plane across the ray as above, and, where it is 0, the sign that it
// takes when the ray is moved by an infinitesimal step along +x and one infinitely smaller along -y.
INLINE float triangle_edge_side(float2 a, float2 b) {
  float side = b.x * a.y - b.y * a.x;
  if (side == 0.0f) side = b.y - a.y;
  return side == 0.0f ? b.x - a.x : side;
}

// A ray that meets an edge or a vertex within rounding hits every triangle there. One of those on a sheet owns the hit: the one that
// the ray would meet if it were moved as above (simulation of simplicity, Edelsbrunner and Muecke 1990). For a lane that is hit.
INLINE bool triangle_owns_hit(__global const TriangleBlock *block, uint lane, const Shear *ray) {
  float2 across[3];
  for (uint i = 0; i < 3; ++i) {
    float z = block->vertex[i][ray->kz][lane] - ray->origin_z;
    across[i].x = fma(-ray->shear_x, z, block->vertex[i][ray->kx][lane] - ray->origin_x);
    across[i].y = fma(-ray->shear_y, z, block->vertex[i][ray->ky][lane] - ray->origin_y);
  }
  float u = triangle_edge_side(across[1], across[2]);
  float v = triangle_edge_side(across[2], across[0]);
  float w = triangle_edge_side(across[0], across[1]);
  return (u > 0.0f && v > 0.0f && w > 0.0f) || (u < 0.0f && v < 0.0f && w < 0.0f);
}

#endif
