// Rays from inside closed meshes, aimed at every vertex and at points of every edge: no ray may get out (extreme X6).
#include "aimed_rays.h"
#include "extremes.h"
#include "trace.h"

using namespace oclair;
using namespace oclair::test;

namespace {

Mesh scaled(Mesh mesh, double scale) {
  for (glm::dvec3& p : mesh.positions) p *= scale;
  return mesh;
}

void no_ray_leaves(const Mesh& mesh, std::size_t repeat, std::uint64_t seed) {
  for (const double scale : {1.0, 0x1p-20, 0x1p20}) {
    if (small_inputs() && scale != 1.0) break;
    const Scene scene = place_scene(world_of(scaled(mesh, scale)));
    ASSERT_EQ(scene.triangles.size(), mesh.triangles.size());
    Random random(seed);
    const std::vector<Ray> rays = aimed_rays(scene, repeat, count_or_small(100000, 10), random);
    for (const int width : {4, 8}) {
      const std::vector<Hit> hits = trace_closest(scene, build_bvh(scene, width), rays);
      EXPECT_EQ(missed(hits), 0u) << "of " << rays.size() << ", scale " << scale << ", width " << width;
    }
  }
}

}  // namespace

TEST(watertight_test, no_ray_leaves_a_displaced_icosphere) {
  no_ray_leaves(icosphere(small_inputs() ? 1 : 5, 0.1, 3), count_or_small(12, 1), 1);
  record_law("X6");
  record_law("X12");
}

TEST(watertight_test, no_ray_leaves_a_dyadic_grid_cube) {
  no_ray_leaves(grid_cube(small_inputs() ? 1 : 32), count_or_small(8, 1), 2);
  record_law("X6");
}

// The same with a long needle and a plate, whose triangles are slivers of 1 : 1000.
TEST(watertight_test, no_ray_leaves_a_stretched_mesh_of_slivers) {
  Mesh mesh = icosphere(small_inputs() ? 1 : 4, 0.05, 5);
  for (glm::dvec3& p : mesh.positions) p *= glm::dvec3(1.0, 1e-3, 1.0);
  const Scene scene = place_scene(world_of(mesh));
  Random random(3);
  std::vector<Ray> rays;
  for (const Ray& ray : aimed_rays(scene, count_or_small(4, 1), count_or_small(20000, 10), random)) {
    const glm::dvec3 target = unpacked(ray.origin) + unpacked(ray.direction);
    rays.push_back(ray_towards(unpacked(ray.origin) * glm::dvec3(1.0, 1e-3, 1.0), target));
  }
  for (const int width : {4, 8}) EXPECT_EQ(missed(trace_closest(scene, build_bvh(scene, width), rays)), 0u) << "of " << rays.size();
  record_law("X6");
}
