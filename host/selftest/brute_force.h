// Rays through all triangles of a scene in double, whatever a tree would do.
#pragma once

#include <string>

#include "../scene.h"
#include "triangle_oracle.h"

namespace oclair::test {

inline Corners corners_of(const Scene& scene, std::size_t triangle) {
  const packed_uint3 t = scene.triangles[triangle];
  return {scene.positions[t.x], scene.positions[t.y], scene.positions[t.z]};
}

// From one point towards another, canonical; the direction is normalised and then rounded.
inline Ray ray_towards(const glm::dvec3& origin, const glm::dvec3& target) {
  const packed_float3 o = packed(origin);
  return {o, 1e30f, packed(glm::normalize(target - unpacked(o))), NONE, NONE, 0.0f, 0};
}

inline std::size_t missed(const std::vector<Hit>& hits) {
  return static_cast<std::size_t>(std::count_if(hits.begin(), hits.end(), [](const Hit& h) { return h.primitive == NONE; }));
}

// What every triangle says about the ray, whatever a tree would do.
struct BruteForce {
  double t_upper = std::numeric_limits<double>::infinity();  // a certain hit lies before this
  double t_lower = std::numeric_limits<double>::infinity();  // no possible hit lies before this
  bool certain_hit() const { return t_upper < std::numeric_limits<double>::infinity(); }
};

inline BruteForce brute_force(const Scene& scene, const Ray& ray) {
  BruteForce nearest;
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    if (i == ray.skip) continue;
    const auto exact = exact_intersection<double>(ray, corners_of(scene, i));
    if (exact.certain_miss || exact.t - exact.t_error > ray.t_max) continue;
    nearest.t_lower = std::min(nearest.t_lower, exact.t - exact.t_error);
    if (exact.certain_hit && exact.t + exact.t_error < ray.t_max) nearest.t_upper = std::min(nearest.t_upper, exact.t + exact.t_error);
  }
  return nearest;
}

// What closest-hit traversal may return, given brute force. Empty: right.
inline std::string disagreement(const Scene& scene, const Ray& ray, const Hit& hit) {
  const BruteForce exact = brute_force(scene, ray);
  if (hit.primitive == NONE) return exact.certain_hit() ? "misses a certain hit" : "";
  if (hit.t > exact.t_upper) return "is behind a certain hit";
  if (hit.t < exact.t_lower) return "is before every possible hit";
  const auto own = exact_intersection<double>(ray, corners_of(scene, hit.primitive));
  if (own.certain_miss) return "names a triangle that is certainly missed";
  if (std::abs(hit.t - own.t) > own.t_error) return "has a parameter that is not that of its triangle";
  return "";
}

}  // namespace oclair::test
