#include "rays.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "../color.h"
#include "random.h"

namespace oclair::bench {
namespace {

constexpr float far_away = 1e30f;

Ray ray_of(const glm::dvec3& origin, const glm::dvec3& direction, double t_max) {
  Ray ray{};
  ray.origin = pack(origin);
  ray.direction = pack(direction);
  ray.t_max = static_cast<float>(t_max);
  ray.skip = NONE;
  ray.target = NONE;
  return ray;
}

// A point on a surface, already off it, and the normal on the side that the ray came from.
struct Bounce {
  glm::dvec3 point, normal;
};

std::vector<Bounce> bounces_of(const Scene& scene, const std::vector<Ray>& rays, const std::vector<Hit>& hits) {
  std::vector<Bounce> bounces;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (hits[i].primitive == NONE) continue;
    const packed_uint3 t = scene.triangles[hits[i].primitive];
    const glm::dvec3 a = unpack(scene.positions[t.x]), b = unpack(scene.positions[t.y]), c = unpack(scene.positions[t.z]);
    const glm::dvec3 d = unpack(rays[i].direction);
    glm::dvec3 normal = glm::normalize(glm::cross(b - a, c - a));
    if (glm::dot(normal, d) > 0.0) normal = -normal;
    const glm::dvec3 point = unpack(rays[i].origin) + static_cast<double>(hits[i].t) * d;
    bounces.push_back({point + surface_gap * normal, normal});
  }
  return bounces;
}

glm::dvec3 cosine_direction(const glm::dvec3& normal, double u, double v) {
  const double r = std::sqrt(u), azimuth = glm::two_pi<double>() * v;
  const glm::dvec3 other = std::abs(normal.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 x = glm::normalize(glm::cross(other, normal)), y = glm::cross(normal, x);
  return glm::normalize(r * std::cos(azimuth) * x + r * std::sin(azimuth) * y + std::sqrt(1.0 - u) * normal);
}

// The middle quarter of the top of the scene's box (+y is up), a little below it.
glm::dvec3 light_point(const Bounds& box, double u, double v) {
  const glm::dvec3 size = box.high - box.low;
  return {box.low.x + size.x * (0.375 + 0.25 * u), box.high.y - 0.03125 * size.y, box.low.z + size.z * (0.375 + 0.25 * v)};
}

Bounds box_of(const Scene& scene) {
  Bounds box;
  for (const packed_float3& p : scene.positions) box.include(unpack(p));
  return box;
}

}  // namespace

std::vector<Ray> camera_rays(const Scene& scene) {
  const Camera& camera = scene.camera;
  std::vector<Ray> rays;
  rays.reserve(std::size_t{rays_across} * rays_across);
  for (uint i = 0; i < rays_across * rays_across; ++i) {
    const uint tile = i / WORK_GROUP_SIZE, within = i % WORK_GROUP_SIZE, tiles = rays_across / TILE_WIDTH;
    const double x = (tile % tiles * TILE_WIDTH + within % TILE_WIDTH + 0.5) * scene.settings.film_width / rays_across;
    const double y = (tile / tiles * TILE_WIDTH + within / TILE_WIDTH + 0.5) * scene.settings.film_height / rays_across;
    glm::dvec3 along = unpack(camera.corner) + x * unpack(camera.step_x) + y * unpack(camera.step_y);
    glm::dvec3 origin = unpack(camera.origin);
    if (camera.orthographic) {
      origin += along;
      along = unpack(camera.axis);
    }
    const glm::dvec3 d = glm::normalize(along);
    double enter = camera.near_clip * glm::length(along);
    for (int axis = 0; axis < 3; ++axis)
      if (d[axis] != 0.0) enter = std::max(enter, (-std::copysign(1.0, d[axis]) - origin[axis]) / d[axis]);
    // A ray that misses the box starts where its last slab begins: outside, and hits nothing.
    rays.push_back(ray_of(origin + enter * d, d, far_away));
  }
  return rays;
}

std::vector<RaySet> ray_sets(const Scene& scene, const Trace& trace) {
  const std::vector<Ray> primary = camera_rays(scene);
  const std::vector<Bounce> bounces = bounces_of(scene, primary, trace(primary));
  const Bounds box = box_of(scene);
  std::vector<Ray> diffuse, shadow, ao;
  for (std::size_t i = 0; i < bounces.size(); ++i) {
    const auto& [point, normal] = bounces[i];
    diffuse.push_back(ray_of(point, cosine_direction(normal, random_unit(i, 0), random_unit(i, 1)), far_away));
    const glm::dvec3 to_light = light_point(box, random_unit(i, 2), random_unit(i, 3)) - point;
    const double distance = glm::length(to_light);
    shadow.push_back(ray_of(point, to_light / distance, distance));
    ao.push_back(ray_of(point, cosine_direction(normal, random_unit(i, 4), random_unit(i, 5)), ao_distance));
  }
  return {{"primary", false, true, primary},
          {"diffuse", false, false, diffuse},
          {"shadow", true, true, shadow},
          {"ao", true, false, ao}};
}

}  // namespace oclair::bench
