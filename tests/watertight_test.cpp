// Rays from inside closed meshes, aimed at every vertex and at points of every edge: no ray may get out (extreme X6).
#include "extremes.h"
#include "trace.h"

using namespace oclair;
using namespace oclair::test;

namespace {

// Surface of a cube of n x n squares a side, two triangles each, all coordinates dyadic.
Mesh grid_cube(int n) {
  Mesh mesh;
  std::map<std::array<int, 3>, unsigned> known;
  const auto vertex = [&](std::array<int, 3> p) {
    const auto [at, fresh] = known.try_emplace(p, static_cast<unsigned>(mesh.positions.size()));
    if (fresh) mesh.positions.push_back(glm::dvec3(p[0], p[1], p[2]) * (2.0 / n) - 1.0);
    return at->second;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {0, n})
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const auto corner = [&](int a, int b) {
            std::array<int, 3> p{};
            p[axis] = side;
            p[(axis + 1) % 3] = i + a;
            p[(axis + 2) % 3] = j + b;
            return vertex(p);
          };
          mesh.triangles.emplace_back(corner(0, 0), corner(1, 0), corner(1, 1));
          mesh.triangles.emplace_back(corner(0, 0), corner(1, 1), corner(0, 1));
        }
  return mesh;
}

Mesh scaled(Mesh mesh, double scale) {
  for (glm::dvec3& p : mesh.positions) p *= scale;
  return mesh;
}

glm::dvec3 origin_inside(Random& random, std::size_t i) {
  glm::dvec3 o = 0.2 * random.in_cube();                   // the meshes reach out to 0.44 at least
  if (i % 4 == 1) o = glm::round(o * 16.0) / 16.0;      // dyadic: rays along axes and diagonals, exact zeros
  if (i % 4 == 2) o = glm::dvec3(0.0);
  if (i % 4 == 3) o = random.below(2) ? glm::dvec3(o.x, 0, 0) : glm::dvec3(o.x, o.y, -0.0);
  return o;
}

// At every vertex from `repeat` origins, at ten points of every edge, and anywhere.
std::vector<Ray> aimed_rays(const Scene& scene, std::size_t repeat, std::size_t random_count, Random& random) {
  std::vector<Ray> rays;
  for (const packed_float3& p : scene.positions)
    for (std::size_t k = 0; k < repeat; ++k) rays.push_back(ray_towards(origin_inside(random, rays.size()), unpacked(p)));
  for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
    const Corners c = corners_of(scene, t);
    for (int e = 0; e < 3; ++e)  // every edge from both its triangles
      for (int k = 0; k < 5; ++k) {
        const double s = k == 0 ? 0.5 : random.unit();
        rays.push_back(ray_towards(origin_inside(random, rays.size()), (1.0 - s) * unpacked(c[e]) + s * unpacked(c[(e + 1) % 3])));
      }
  }
  for (std::size_t i = 0; i < random_count; ++i) {
    const glm::dvec3 o = origin_inside(random, i);
    rays.push_back(ray_towards(o, o + random.direction()));
  }
  return rays;
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
