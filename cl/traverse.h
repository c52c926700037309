// Closest-hit and any-hit traversal of the wide BVH.
//   push the root; until the stack is empty: a leaf -> intersect its blocks; a node -> test its boxes, take the nearest child at
//   once and push the others, farthest first, with their distances; a popped child beyond the nearest hit is dropped.
//   Any hit: in whatever order, without distances.
// Equal distances go to the smaller primitive id, so that the result does not depend on the tree.
#ifndef OCLAIR_TRAVERSE_H
#define OCLAIR_TRAVERSE_H

#include "quadric.h"
#include "scene.h"
#include "triangle.h"

#ifndef STACK_SIZE
#define STACK_SIZE 64  // >= (BVH_WIDTH - 1) * depth + 1: host/bvh.h, Bvh::stack_size
#endif

// Bits of the children whose box the ray meets in [t_min, t_max], t_min >= 0; *t_near holds where it enters them. Boxes are padded on the
// host, so that this test is conservative (host/bvh.cpp).
INLINE uint node_intersect(__global const BvhNode *node, const Slabs *ray, float t_min, float t_max, Lanes *t_near) {
#define PLANE(row, axis) \
  fma(load_lanes(node->bounds[row]), (floatw)(ray->reciprocal.axis), (floatw)(ray->offset.axis))
#define LARGER(a, b) ((a) > (b) ? (a) : (b))
#define SMALLER(a, b) ((a) < (b) ? (a) : (b))
  floatw near_x = PLANE(ray->near[0], x), far_x = PLANE(ray->near[0] ^ 1u, x);
  floatw near_y = PLANE(ray->near[1], y), far_y = PLANE(ray->near[1] ^ 1u, y);
  floatw near_z = PLANE(ray->near[2], z), far_z = PLANE(ray->near[2] ^ 1u, z);
  floatw near = LARGER(LARGER(near_x, near_y), LARGER(near_z, (floatw)(t_min)));
  floatw far = SMALLER(SMALLER(far_x, far_y), SMALLER(far_z, (floatw)(t_max)));
#undef PLANE
#undef LARGER
#undef SMALLER
  t_near->vector = near;
  return lane_mask(near <= far);
}

INLINE bool closer(float t, uint primitive, const Hit *hit) {
  return t < hit->t || (t == hit->t && primitive < hit->primitive);
}

// Least t of a hit on the primitive that the ray has not gone through yet.
INLINE float traverse_start(const Ray *ray, uint primitive) {
  if (!HAS_PASSAGES) return 0.0f;
  return primitive > ray->passed ? ray->t_min : nextafter(ray->t_min, INFINITE_DISTANCE);
}

// A child that is still to be visited, and where the ray enters it: not set for any-hit rays.
typedef struct StackEntry {
  float near;
  uint child;
} StackEntry;

// Both traversals: any_hit is a constant at each call. Closest: updates *hit, whose t is the ray's t_max and whose primitive is
// NONE at first. Any: stops at the first hit. Where the ray starts and where it ends is no hit for either.
INLINE void traverse(const Scene *scene, const Ray *ray, Hit *hit, bool any_hit) {
  const Slabs slabs = slabs_from_ray(ray);
  const Shear shear = shear_from_ray(ray);
  StackEntry stack[STACK_SIZE];
  int top = 0;
  uint current = 0;
  while (true) {
    if (!(current & LEAF_BIT)) {
      __global const BvhNode *node = scene->nodes + current;
      Lanes near;
      uint mask = node_intersect(node, &slabs, HAS_PASSAGES ? ray->t_min : 0.0f, hit->t, &near);
      if (mask) {
        uint lane = lowest_lane(mask);
        mask &= mask - 1u;
        current = node->child[lane];
        if (!mask) continue;
        if (any_hit) {
          for (; mask; mask &= mask - 1u) stack[top++].child = node->child[lowest_lane(mask)];
          continue;
        }
        float current_near = near.lane[lane];
        // Insertion sort of the rest on the stack; the nearest stays in `current`.
        int bottom = top;
        while (mask) {
          lane = lowest_lane(mask);
          mask &= mask - 1u;
          uint child = node->child[lane];
          float child_near = near.lane[lane];
          if (child_near < current_near) {
            uint other = current;
            float other_near = current_near;
            current = child;
            current_near = child_near;
            child = other;
            child_near = other_near;
          }
          int i = top++;
          while (i > bottom && stack[i - 1].near < child_near) {
            stack[i] = stack[i - 1];
            --i;
          }
          stack[i].near = child_near;
          stack[i].child = child;
        }
        continue;
      }
    } else {
      uint count = (current & ~LEAF_BIT) >> LEAF_COUNT_SHIFT;
      uint first = current & LEAF_INDEX_MASK;
      if (HAS(TRIANGLES)) {
        for (uint b = first; b < first + count; ++b) {
          __global const TriangleBlock *block = scene->blocks + b;
          Lanes t, b1, b2;
          uint mask = triangle_block_intersect(block, &shear, hit->t, !any_hit, &t, &b1, &b2);
          for (; mask; mask &= mask - 1u) {
            uint lane = lowest_lane(mask);
            uint primitive = block->primitive[lane];
            if (primitive == ray->skip || primitive == ray->target) continue;
            if (HAS_PASSAGES && t.lane[lane] < traverse_start(ray, primitive)) continue;
            if (!any_hit && !closer(t.lane[lane], primitive, hit)) continue;
            hit->t = t.lane[lane];
            hit->b1 = b1.lane[lane];
            hit->b2 = b2.lane[lane];
            hit->primitive = primitive;
            hit->slot = b * BVH_WIDTH + lane;
            if (any_hit) return;
          }
        }
      }
      if (HAS_QUADRICS && count == 0u) {
        Quadric quadric = scene->quadrics[first];
        uint primitive = QUADRIC_BIT | first;
        float t = quadric_intersect(&quadric, unpack3(ray->origin), unpack3(ray->direction), traverse_start(ray, primitive),
                                    hit->t, primitive == ray->skip, primitive == ray->target);
        if (t < INFINITE_DISTANCE && (any_hit || closer(t, primitive, hit))) {
          hit->t = t;
          hit->primitive = primitive;
          if (any_hit) return;
        }
      }
    }
    do {
      if (top == 0) return;
      --top;
    } while (!any_hit && stack[top].near > hit->t);
    current = stack[top].child;
  }
}

// Out of line, so that PoCL does not keep a copy of the stack for each work item of the group, as it does for arrays of kernels.
OUT_OF_LINE Hit traverse_closest(const Scene *scene, const Ray *ray) {
  Hit hit = {ray->t_max, 0.0f, 0.0f, NONE, 0u};
  traverse(scene, ray, &hit, false);
  return hit;
}

// True if something lies strictly between the ray's two ends: the intersection routines take t <= t_max, t < t_max is wanted.
OUT_OF_LINE bool traverse_any(const Scene *scene, const Ray *ray) {
  Hit hit = {nextafter(ray->t_max, 0.0f), 0.0f, 0.0f, NONE, 0u};
  traverse(scene, ray, &hit, true);
  return hit.primitive != NONE;
}

#endif
