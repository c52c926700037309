// Watertight ray-triangle intersection, BVH_WIDTH triangles at a time (Woop, Benthin, Wald 2013, JCGT 2(1)).
// The ray becomes the z axis by a shear that is the same for every triangle; a shared vertex is then the same pair of floats
// in all its triangles, and the edge function of a shared edge changes only its sign: no ray passes between them. This rests on
// FP_CONTRACT OFF (types.h). The paper's fall-back to double for an edge function of exactly 0 changes nothing here: 0 counts as inside.
#ifndef OCLAIR_TRIANGLE_H
#define OCLAIR_TRIANGLE_H

#include "ray.h"

// Bit i of the result is set where lane i is hit at 0 < t <= t_max; for those lanes *t, *b1, *b2 hold the parameter and the
// barycentric coordinates of vertices 1 and 2.
INLINE uint triangle_block_intersect(__global const TriangleBlock *block, const Shear *ray, float t_max, Lanes *t, Lanes *b1,
                                     Lanes *b2) {
#define VERTEX(i, axis) (*(__global const floatw *)block->vertex[i][axis])
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
  if (!lane_mask(inside)) return 0;
  floatw det = u + v + w;
  floatw inverse_det = 1.0f / det;  // det == 0 gives infinity or NaN, and the comparisons below fail
  floatw distance = (u * az + v * bz + w * cz) * ray->shear_z * inverse_det;
  t->vector = distance;
  b1->vector = v * inverse_det;
  b2->vector = w * inverse_det;
  return lane_mask(inside & (distance > 0.0f) & (distance <= t_max));
}

#endif
