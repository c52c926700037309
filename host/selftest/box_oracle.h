// A ray and a box in long double on the same float inputs, and pairs of them that are hard for a slab test.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "../bvh.h"
#include "random.h"

namespace oclair::test {

struct Box {
  packed_float3 low, high;
};

struct Interval {
  long double near, far;
  bool hit() const { return near <= far; }
};

// Where the exact ray runs inside the box moved outwards by `margin` on every side, for t_min <= t <= t_max.
inline Interval exact_slab(const Box& box, const Ray& ray, long double margin) {
  const float low[3] = {box.low.x, box.low.y, box.low.z}, high[3] = {box.high.x, box.high.y, box.high.z};
  const float o[3] = {ray.origin.x, ray.origin.y, ray.origin.z}, d[3] = {ray.direction.x, ray.direction.y, ray.direction.z};
  Interval result{ray.t_min, ray.t_max};
  for (int axis = 0; axis < 3; ++axis) {
    const long double below = low[axis] - margin - o[axis], above = high[axis] + margin - o[axis];
    if (d[axis] == 0.0f) {
      if (below > 0.0L || above < 0.0L) return {1.0L, 0.0L};
      continue;
    }
    const long double a = below / d[axis], b = above / d[axis];
    result.near = std::max(result.near, std::min(a, b));
    result.far = std::min(result.far, std::max(a, b));
  }
  return result;
}

template <int W>
void set_child(BvhNode<W>& node, int lane, const Box& box) {
  const float low[3] = {box.low.x, box.low.y, box.low.z}, high[3] = {box.high.x, box.high.y, box.high.z};
  for (int axis = 0; axis < 3; ++axis) {  // as host/bvh.cpp pads
    node.bounds[2 * axis][lane] = low[axis] - box_padding;
    node.bounds[2 * axis + 1][lane] = high[axis] + box_padding;
  }
}

// A box in [-1, 1]^3: tiny or large, often flat or thinner than the padding, often touching the frame's side.
inline Box random_box(Random& random) {
  glm::dvec3 low, high;
  for (int axis = 0; axis < 3; ++axis) {
    const double size = random.below(4) == 0 ? 0.0 : random.log_between(1e-8, 2.0);
    low[axis] = random.below(8) == 0 ? -1.0 : random.between(-1.0, 1.0 - size);
    high[axis] = random.below(8) == 0 ? 1.0 : std::min(1.0, low[axis] + size);
  }
  return {packed(low), packed(high)};
}

// A point of the box: a corner, a point of an edge, of a face, or inside.
inline glm::dvec3 point_of(const Box& box, Random& random) {
  const glm::dvec3 low = unpacked(box.low), high = unpacked(box.high);
  glm::dvec3 p;
  for (int axis = 0; axis < 3; ++axis) {
    const double s = random.below(3) == 0 ? random.unit() : static_cast<double>(random.below(2));
    p[axis] = low[axis] + s * (high[axis] - low[axis]);
  }
  return p;
}

inline Ray random_ray(const glm::dvec3& target, Random& random) {
  glm::dvec3 origin = random.in_cube(1.0);
  for (int axis = 0; axis < 3; ++axis) {
    if (random.below(8) == 0) origin[axis] = random.sign();
    if (random.below(8) == 0) origin[axis] = target[axis];  // zero or tiny components
    if (random.below(32) == 0) origin[axis] += 1e-9 * random.sign();
  }
  if (origin == target) origin.x = -origin.x + 0.5;
  Ray ray{packed(origin), 1e30f, packed(glm::normalize(target - origin)), NONE, NONE, 0.0f, 0};
  for (float* component : {&ray.direction.x, &ray.direction.y, &ray.direction.z})
    if (*component == 0.0f) *component = random.below(2) ? -0.0f : random.below(2) ? 0.0f : 1e-30f;
  return ray;
}

// What comes within this of the box, the displacement of the sheared vertices of the triangle test, must be found, and no
// later than there (host/bvh.h, box_padding).
inline constexpr long double guaranteed_margin = 10 * unit_roundoff;

// Rays along the axes: origins {-1, -.5, 0, .5, 1}^3, six ways, four signs of the two zeros, a box and a flat box; all
// coordinates exact.
struct AxisCases {
  std::vector<Box> boxes;
  std::vector<Ray> rays;
};

inline AxisCases axis_cases() {
  AxisCases cases;
  for (const bool flat : {false, true})
    for (int grid = 0; grid < 125; ++grid)
      for (int way = 0; way < 6; ++way)
        for (int zeros = 0; zeros < 4; ++zeros) {
          float d[3];
          d[way / 2] = way % 2 ? -1.0f : 1.0f;
          d[(way / 2 + 1) % 3] = zeros & 1 ? -0.0f : 0.0f;
          d[(way / 2 + 2) % 3] = zeros & 2 ? -0.0f : 0.0f;
          cases.rays.push_back({{0.5f * (grid % 5 - 2), 0.5f * (grid / 5 % 5 - 2), 0.5f * (grid / 25 - 2)},
                                1e30f,
                                {d[0], d[1], d[2]},
                                NONE,
                                NONE,
                                0.0f,
                                0});
          cases.boxes.push_back(flat ? Box{{-0.5f, -0.5f, 0.5f}, {0.5f, 0.5f, 0.5f}}
                                     : Box{{-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.5f}});
        }
  return cases;
}

}  // namespace oclair::test
