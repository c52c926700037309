// The orthographic camera: parallel rays from the points of a film that stands in the scene.
#include <cstring>
#include <set>

#include "random.h"
#include "worlds.h"

using namespace oclair;
using namespace oclair::test;

namespace {

World view(const glm::dmat4& to_world, double half_width, uint width, uint height) {
  World world;
  add_box(add_shape(world, diffuse(0.5), Sides::both).mesh, {-0.9, -0.9, -0.9}, {0.9, 0.9, 0.9});  // the identity frame
  world.camera.to_world = to_world;
  world.camera.orthographic = true;
  world.camera.tan_half_fov_x = half_width;
  world.film.width = world.film.crop_width = width;
  world.film.height = world.film.crop_height = height;
  return world;
}

// Looks from `from` at `to`, up is +z.
glm::dmat4 pose(const glm::dvec3& from, const glm::dvec3& to) {
  World world;
  look(world, from, to, {0, 0, 1}, 1.0, 1, 1);
  return world.camera.to_world;
}

std::vector<Ray> rays(const World& world, const std::vector<float>& x, const std::vector<float>& y) {
  const Scene scene = place_scene(world);
  EXPECT_EQ(scene.frame.exponent, 0);
  std::vector<Ray> result(x.size());
  run("orthographic_test.cl", "rays", x.size(), std::vector<Camera>{scene.camera}, x, y, out(result));
  return result;
}

// Film position in world space: Mitsuba's convention, +x to the left, +y up.
glm::dvec3 film_point(const World& world, double x, double y) {
  const double half_x = world.camera.tan_half_fov_x, half_y = half_x * world.film.height / world.film.width;
  return glm::dvec3(world.camera.to_world * glm::dvec4((1.0 - 2.0 * x / world.film.width) * half_x,
                                                       (1.0 - 2.0 * y / world.film.height) * half_y, 0.0, 1.0));
}

struct Film2 {
  std::vector<float> x, y;
};

Film2 positions(const World& world, std::size_t n, std::uint64_t seed) {
  Random random(seed);
  Film2 film;
  for (std::size_t i = 0; i < n; ++i) {
    film.x.push_back(static_cast<float>(world.film.width) * random.unit24());
    film.y.push_back(static_cast<float>(world.film.height) * random.unit24());
  }
  return film;
}

}  // namespace

TEST(orthographic_test, rays_are_parallel_to_the_axis) {
  const World world = view(pose({0.1, -0.2, 0.3}, {0.7, 0.5, 0.1}), 0.5, 64, 48);
  const Film2 film = positions(world, count_or_small(2000, 50), 1);
  const std::vector<Ray> all = rays(world, film.x, film.y);
  for (const Ray& ray : all) EXPECT_EQ(std::memcmp(&ray.direction, &all[0].direction, sizeof(packed_float3)), 0);
  EXPECT_LE(glm::length(unpacked(all[0].direction) - glm::dvec3(world.camera.to_world[2])), 4 * unit_roundoff);
}

// Everything is a multiple of 2^-6: nothing is rounded but the depth, whose start is not observable.
TEST(orthographic_test, pixels_have_exactly_their_place_and_spacing) {
  glm::dmat4 to_world(1.0);
  to_world[3] = {0.25, -0.125, -0.5, 1.0};
  const World world = view(to_world, 0.5, 32, 16);
  std::vector<float> x, y;
  for (int j = 0; j < 16; ++j)
    for (int i = 0; i < 32; ++i) x.push_back(static_cast<float>(i) + 0.5f), y.push_back(static_cast<float>(j) + 0.5f);
  const std::vector<Ray> all = rays(world, x, y);
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i].origin.x, 0.25f + 0.5f - x[i] / 32.0f);
    EXPECT_EQ(all[i].origin.y, -0.125f + 0.25f - y[i] / 32.0f);
    EXPECT_EQ(all[i].direction.x, 0.0f);
    EXPECT_EQ(all[i].direction.y, 0.0f);
    EXPECT_EQ(all[i].direction.z, 1.0f);
  }
}

// However far the camera is, and however small: the film point is rounded 6 times at the size of the film and of the scene,
// the depth is at most 4 there and moves a ray by 4 u of it.
TEST(orthographic_test, rays_pass_their_film_points_from_near_and_from_a_million_away) {
  for (const double away : {0.0, 0.3, 5.0, 1e6, 1e9})
    for (const double half : {0.005, 0.7, 3.0}) {
      const glm::dvec3 direction = glm::normalize(glm::dvec3(0.48, 0.64, -0.6));
      World world =
          view(pose(glm::dvec3(0.1, 0.2, -0.1) - away * direction, glm::dvec3(0.1, 0.2, -0.1) + direction), half, 64, 48);
      world.camera.far_clip = 1e10;
      const Film2 film = positions(world, count_or_small(1000, 20), 2);
      const std::vector<Ray> all = rays(world, film.x, film.y);
      for (std::size_t i = 0; i < all.size(); ++i) {
        // In double the far film point itself is known to 2^-53 of its distance; the axis of the ray to u over the scene.
        const glm::dvec3 exact = film_point(world, film.x[i], film.y[i]);
        const glm::dvec3 axis(world.camera.to_world[2]);
        const glm::dvec3 start = exact + axis * glm::dot(unpacked(all[i].origin) - exact, axis);
        EXPECT_LE(glm::length(unpacked(all[i].origin) - start), unit_roundoff * (6 * half + 24) + 1e-15 * away)
            << away << " " << half;
        EXPECT_LE(glm::length(unpacked(all[i].direction) - axis), 4 * unit_roundoff);
      }
    }
}

TEST(orthographic_test, neighbouring_pixels_of_a_film_of_a_hundredth_have_distinct_rays) {
  const World world = view(pose({0.3, 0.2, 0.1}, {0.9, 0.5, 0.4}), 0.005, 1024, 1);
  std::vector<float> x, y(1024, 0.5f);
  for (int i = 0; i < 1024; ++i) x.push_back(static_cast<float>(i) + 0.5f);
  std::set<std::array<float, 3>> origins;
  for (const Ray& ray : rays(world, x, y)) origins.insert({ray.origin.x, ray.origin.y, ray.origin.z});
  EXPECT_EQ(origins.size(), 1024u);
}

// Whatever of a ray lies between the clip planes and in the scene's box is on it, also for rays that begin beside the box,
// and nothing before the near plane or behind the far one is.
TEST(orthographic_test, rays_that_begin_outside_the_scene_keep_all_of_it_between_the_clip_planes) {
  Random random(3);
  std::size_t met = 0;
  for (int k = 0; k < 60; ++k) {
    const glm::dvec3 from = random.in_cube(k % 3 == 0 ? 1.0 : k % 3 == 1 ? 4.0 : 300.0);
    glm::dvec3 d = glm::normalize(random.in_cube(1.0) - from);
    if (k % 5 == 0) d = {k % 2 ? 1.0 : -1.0, 0.0, 0.0};
    World world = view(pose(from, from + d), 6.0, 16, 16);
    if (k % 4 == 1)  // the film leans: its points lie at different depths
      for (int column = 0; column < 2; ++column) world.camera.to_world[column] += 0.7 * world.camera.to_world[2];
    world.camera.near_clip = random.log_between(1e-3, 10.0);
    world.camera.far_clip = world.camera.near_clip + random.log_between(0.1, 1e3);
    const Film2 film = positions(world, count_or_small(500, 10), 100 + static_cast<unsigned>(k));
    const std::vector<Ray> all = rays(world, film.x, film.y);
    for (std::size_t i = 0; i < all.size(); ++i) {
      const glm::dvec3 p = film_point(world, film.x[i], film.y[i]), axis(world.camera.to_world[2]);
      double enter = world.camera.near_clip, leave = world.camera.far_clip;
      for (int a = 0; a < 3; ++a) {
        const double low = (-1.0 - p[a]) / axis[a], high = (1.0 - p[a]) / axis[a];
        enter = std::max(enter, std::min(low, high));
        leave = std::min(leave, std::max(low, high));
      }
      const double slack = 1e-4;  // rays that graze the box, and rounding: the film is 12 wide, 300 away
      if (enter > leave - slack) continue;
      ++met;
      const double start = glm::dot(unpacked(all[i].origin) - p, axis), end = start + static_cast<double>(all[i].t_max);
      EXPECT_LE(start, enter + 1e-5);
      EXPECT_GE(start, world.camera.near_clip - 1e-5);
      EXPECT_GE(end, leave - 1e-3);
      EXPECT_LE(end, world.camera.far_clip + 1e-3);
      EXPECT_LE(std::max({std::abs(all[i].origin.x), std::abs(all[i].origin.y), std::abs(all[i].origin.z)}),
                1.0f + 0x1p-14f);
    }
  }
  EXPECT_GE(met, count_or_small(300, 3));
}

// Measured in Mitsuba 3.9.1: 8x4 pixels; film (0, 0), (1, 0) and (0, 1) under a to_world that scales by 3 and moves to (1,
// 2, 3), one that shears, and one that leans the rays. The reader has multiplied near_clip by the scale, see reader_test.
TEST(orthographic_test, rays_are_those_of_mitsuba) {
  struct Row {
    glm::dmat4 to_world;
    double near_clip, far_clip;
    glm::dvec3 origins[3], direction;
  };
  glm::dmat4 scaled(3.0), sheared(1.0), leaning(1.0);
  scaled[3] = {1, 2, 3, 1};
  sheared[1][0] = 0.5;
  leaning[2][0] = 0.5;
  const Row rows[] = {{scaled, 3.0, 7.0, {{4, 3.5, 6}, {-2, 3.5, 6}, {4, 0.5, 6}}, {0, 0, 1}},
                      {sheared, 0.01, 1e4, {{1.25, 0.5, 0.01}, {-0.75, 0.5, 0.01}, {0.75, -0.5, 0.01}}, {0, 0, 1}},
                      {leaning,
                       0.01 * std::sqrt(1.25),
                       1e4,
                       {{1.005, 0.5, 0.01}, {-0.995, 0.5, 0.01}, {1.005, -0.5, 0.01}},
                       {0.4472136, 0, 0.8944272}}};
  for (const Row& row : rows) {
    World world = view(row.to_world, 1.0, 8, 4);
    for (glm::dvec3& p : world.shapes[0].mesh.positions)
      p *= 16.0;  // all of it lies within: no ray begins later than its near plane
    world.camera.near_clip = row.near_clip;
    world.camera.far_clip = row.far_clip;
    const Scene scene = place_scene(world);
    ASSERT_EQ(scene.frame.exponent, 4);
    std::vector<Ray> all(3);
    run("orthographic_test.cl", "rays", 3, std::vector<Camera>{scene.camera}, std::vector<float>{0, 8, 0},
        std::vector<float>{0, 0, 4}, out(all));
    for (int i = 0; i < 3; ++i) {
      EXPECT_LE(glm::length(unpacked(all[i].direction) - row.direction), 1e-6);
      EXPECT_LE(glm::length(16.0 * unpacked(all[i].origin) - row.origins[i]), 2e-6) << i;
      EXPECT_NEAR(16.0 * all[i].t_max, row.far_clip - row.near_clip, 1e-6 * row.far_clip);
    }
  }
}

TEST(orthographic_test, scaling_the_world_by_a_power_of_two_changes_no_ray) {
  const World world = view(pose({0.1, -0.2, 0.3}, {0.7, 0.5, 0.1}), 0.4, 16, 16);
  const Film2 film = positions(world, 50, 4);
  const std::vector<Ray> expected = rays(world, film.x, film.y);
  for (const int k : {-20, 20}) {
    World scaled = world;
    for (glm::dvec3& p : scaled.shapes[0].mesh.positions) p *= std::ldexp(1.0, k);
    for (double* length : {&scaled.camera.near_clip, &scaled.camera.far_clip, &scaled.camera.tan_half_fov_x})
      *length = std::ldexp(*length, k);
    scaled.camera.to_world[3] = glm::dvec4(std::ldexp(1.0, k) * glm::dvec3(world.camera.to_world[3]), 1.0);
    const Scene scene = place_scene(scaled);
    EXPECT_EQ(scene.frame.exponent, k);
    EXPECT_TRUE(scene.features & FEATURE_ORTHOGRAPHIC);
    std::vector<Ray> result(film.x.size());
    run("orthographic_test.cl", "rays", film.x.size(), std::vector<Camera>{scene.camera}, film.x, film.y, out(result));
    EXPECT_EQ(std::memcmp(expected.data(), result.data(), expected.size() * sizeof(Ray)), 0);
  }
}
