// How many rays a render says that it has traced: on scenes where each sample traces the same number.
#include "worlds.h"

using namespace oclair;
using namespace oclair::test;

namespace {

constexpr uint side = 8, samples = 20;

// A floor from above through a narrow pinhole, under light from one direction; `sheets` small half-transparent ones lie in the light's way
// to what the camera sees. A sample traces the camera ray, the shadow ray, once more for each sheet, and the scattered ray, which escapes: it
// meets a sheet of 0.01 at a distance of 0.3 or more with a probability below 4e-4 times the number of sheets, and the fixed seed
// has none.
World floor_under_sheets(int sheets) {
  World world;
  add_quad(add_shape(world, diffuse(0.5), Sides::both).mesh, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
  const glm::dvec3 to_light = glm::normalize(glm::dvec3(1, 0, 1));
  world.lights.push_back({LIGHT_DIRECTIONAL, glm::dvec3(1.0), -to_light});
  Material sheet = diffuse(0.5);
  sheet.transparency = 0.5f;
  for (int i = 0; i < sheets; ++i)
    add_quad(add_shape(world, sheet, Sides::both).mesh, to_light * (0.3 + 0.1 * i) - glm::dvec3(0.005, 0.005, 0), {0.01, 0, 0},
             {0, 0.01, 0});
  look(world, {0, 0, 1}, {0, 0, 0}, {0, 1, 0}, 1e-4, side, side);
  return world;
}

std::uint64_t rays_a_sample(const World& world) {
  const std::uint64_t rays = render(world, samples).rays;
  EXPECT_EQ(rays % (side * side * samples), 0u);
  return rays / (side * side * samples);
}

}  // namespace

TEST(ray_count_image, a_ray_that_escapes_is_one) {
  World world = floor_under_sheets(0);
  look(world, {0, 0, 1}, {0, 0, 2}, {0, 1, 0}, 0.1, side, side);
  EXPECT_EQ(rays_a_sample(world), 1u);
}

TEST(ray_count_image, camera_shadow_and_scattered_rays_count) { EXPECT_EQ(rays_a_sample(floor_under_sheets(0)), 3u); }

TEST(ray_count_image, a_shadow_ray_counts_again_behind_each_sheet) {
  EXPECT_EQ(rays_a_sample(floor_under_sheets(1)), 4u);
  EXPECT_EQ(rays_a_sample(floor_under_sheets(3)), 6u);
}

TEST(ray_count_image, a_film_that_is_restored_brings_its_rays) {
  const Scene scene = place_scene(floor_under_sheets(1));
  const Bvh bvh = build_bvh(scene, device().bvh_width);
  Renderer first = start_render(device(), scene, bvh), second = start_render(device(), scene, bvh);
  render_pass(first, 3);
  render_pass(second, 1);  // dropped by what follows
  restore_film(second, read_film(first));
  EXPECT_EQ(ray_count(second), 3u * 4 * side * side);
  render_pass(second, 2);
  EXPECT_EQ(read_film(second).rays, 5u * 4 * side * side);
}
