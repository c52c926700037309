#include "../bvh.h"
#include "aimed_rays.h"
#include "groups.h"
#include "meshes.h"

namespace oclair::selftest {
namespace {

Scene scene_of(const Mesh& mesh) {
  World world;
  world.materials.push_back({});
  WorldShape& shape = world.shapes.emplace_back();
  shape.mesh = mesh;
  shape.material_front = shape.material_back = 0;
  return place_scene(world);
}

constexpr std::size_t judged_by_brute_force = 1500;

struct Counts {
  std::size_t rays = 0, leaks = 0, not_blocked = 0, wrong = 0;
};

void trace(const Session& session, const Mesh& mesh, Random& random, Counts& counts) {
  const Scene scene = scene_of(mesh);
  const Bvh bvh = build_bvh(scene, session.device.bvh_width);
  const std::vector<Ray> rays = aimed_rays(scene, 8, 20000, random);
  std::vector<Hit> hits(rays.size());
  std::vector<cl_uint> blocked(rays.size());
  run(session, "closest", rays.size(), bvh.nodes, bvh.blocks, rays, out(hits), out(blocked));
  counts.rays += rays.size();
  counts.leaks += missed(hits);
  counts.not_blocked += static_cast<std::size_t>(std::count(blocked.begin(), blocked.end(), 0u));
  for (std::size_t i = 0; i < rays.size(); i += rays.size() / judged_by_brute_force)
    counts.wrong += !disagreement(scene, rays[i], hits[i]).empty();
}

}  // namespace

// Rays from inside two closed meshes, at every vertex, at points of every edge from both its triangles, and anywhere: none
// gets out. What some of them hit is judged by all triangles in double, with a bound of what float32 may make of each.
void check_triangles(const Session& session, Group& group) {
  Random random(12);
  Counts counts;
  trace(session, icosphere(3, 0.1, 3), random, counts);
  trace(session, grid_cube(12), random, counts);
  group.measure("rays", static_cast<double>(counts.rays));
  group.bound("leaks", static_cast<double>(counts.leaks), 0);
  group.bound("shadow rays let out", static_cast<double>(counts.not_blocked), 0);
  // The bound of brute force is one of correctly rounded division.
  if (rounds_correctly(session.device))
    group.bound("unlike brute force", static_cast<double>(counts.wrong), 0);
  else
    group.measure("unlike brute force", static_cast<double>(counts.wrong));
}

}  // namespace oclair::selftest
