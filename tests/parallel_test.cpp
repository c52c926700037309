// Loops over all cores, and what rests on them: nothing depends on how many there are.
#include "../host/parallel.h"

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "../host/mesh.h"
#include "environment_maps.h"
#include "trace.h"

using namespace oclair;
using namespace oclair::test;

namespace {

// On that many threads, whatever the machine has.
template <class Work>
auto on_threads(int threads, const Work& work) {
  const tbb::global_control allowed(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  return tbb::task_arena(threads).execute(work);
}

template <class A, class B>
bool same_bytes(const A& a, const B& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0);
}

// What comes out of a bent mesh without normals, spheres around it and a lamp whose texture is random.
struct Loaded {
  Scene scene;
  Bvh bvh;
};
Loaded load(int threads) {
  return on_threads(threads, [] {
    World world;
    const Mesh ball = icosphere(6, 0.02, 3);  // 81 920 triangles
    ObjectMesh bent;
    bent.positions = ball.positions;
    bent.triangles = ball.triangles;
    add_shape(world, diffuse(0.5), Sides::both).mesh = to_world(std::move(bent), {});
    // As many times the same triangle as make a fallback of the builder split by number.
    add_shape(world, diffuse(0.5), Sides::both).mesh.positions = {{0, 0, 3}, {1, 0, 3}, {0, 1, 3}};
    world.shapes.back().mesh.triangles.assign(5000, {0, 1, 2});
    for (int i = 0; i < 300; ++i) {
      WorldShape& sphere = add_shape(world, diffuse(0.5), Sides::both);
      sphere.geometry = Geometry::sphere;
      sphere.to_world = glm::dmat4(0.01);
      sphere.to_world[3] = {0.01 * i, 2, 0, 1};
    }
    world.textures.emplace_back().image = random_image(300, 200, 3);
    WorldShape& lamp = add_shape(world, diffuse(0.0), Sides::both, 1.0);
    lamp.radiance_texture = 1;
    add_quad(lamp.mesh, {-1, -1, 4}, {0, 2, 0}, {2, 0, 0});
    lamp.mesh.uvs = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};
    Loaded loaded{place_scene(std::move(world)), {}};
    loaded.bvh = build_bvh(loaded.scene, 8);
    return loaded;
  });
}

}  // namespace

TEST(parallel_test, every_index_is_visited_once) {
  for (const std::size_t count : {0, 1, 4096, 4097, 100000})
    for (const int threads : {1, 2, 5}) {
      std::vector<std::atomic<int>> visits(count);
      on_threads(threads, [&] {
        parallel_pieces(count, [&](std::size_t first, std::size_t end) {
          for (std::size_t i = first; i < end; ++i) ++visits[i];
        });
      });
      EXPECT_EQ(std::count(visits.begin(), visits.end(), 1), static_cast<std::ptrdiff_t>(count));
    }
}

TEST(parallel_test, of_several_faults_the_first_is_told) {
  for (int repetition = 0; repetition < 20; ++repetition) {
    std::string told;
    try {
      parallel_pieces(100000, [&](std::size_t first, std::size_t end) {
        for (std::size_t i = first; i < end; ++i)
          if (i % 10000 == 7777) throw std::runtime_error(std::to_string(i));
      });
    } catch (const std::runtime_error& error) {
      told = error.what();
    }
    EXPECT_EQ(told, "7777");
  }
}

TEST(parallel_test, the_scene_and_its_tree_do_not_depend_on_the_number_of_threads) {
  const Loaded one = load(1);
  ASSERT_GT(one.scene.normals.size(), 40000u);
  ASSERT_GT(one.scene.lights.size(), 1000u);
  for (const int threads : {2, 3, 8}) {
    const Loaded more = load(threads);
    EXPECT_TRUE(same_bytes(one.bvh.nodes, more.bvh.nodes));
    EXPECT_TRUE(same_bytes(one.bvh.blocks, more.bvh.blocks));
    EXPECT_TRUE(same_bytes(one.scene.positions, more.scene.positions));
    EXPECT_TRUE(same_bytes(one.scene.triangles, more.scene.triangles));
    EXPECT_TRUE(same_bytes(one.scene.triangle_shape, more.scene.triangle_shape));
    EXPECT_TRUE(same_bytes(one.scene.triangle_vertices, more.scene.triangle_vertices));
    EXPECT_TRUE(same_bytes(one.scene.normals, more.scene.normals));
    EXPECT_TRUE(same_bytes(one.scene.uvs, more.scene.uvs));
    EXPECT_TRUE(same_bytes(one.scene.lights, more.scene.lights));
    EXPECT_TRUE(same_bytes(one.scene.light_cdf, more.scene.light_cdf));
  }
}
