// The camera against a pinhole in double, and the entry of far rays into the box of the scene.
#include <set>

#include "extremes.h"
#include "random.h"
#include "statistics.h"
#include "worlds.h"

using namespace oclair;
using namespace oclair::test;

namespace {

World view(const glm::dvec3& from, const glm::dvec3& to, double tan_half_fov, uint width, uint height) {
  World world;
  add_box(add_shape(world, diffuse(0.5), Sides::both).mesh, {-0.9, -0.9, -0.9}, {0.9, 0.9, 0.9});  // the identity frame
  look(world, from, to, {0, 0, 1}, tan_half_fov, width, height);
  world.camera.near_clip = 1e-3;
  return world;
}

std::vector<Ray> rays(const Scene& scene, const std::vector<float>& x, const std::vector<float>& y) {
  std::vector<Ray> result(x.size());
  run("camera_test.cl", "rays", x.size(), std::vector<Camera>{scene.camera}, x, y, out(result));
  return result;
}

// Direction, with component 1 along the view, through film position (x, y): Mitsuba's convention, +x to the left, +y up.
glm::dvec3 pinhole(const WorldCamera& camera, const WorldFilm& film, double x, double y) {
  const double aspect = static_cast<double>(film.height) / film.width;
  const glm::dvec2 ndc(x / film.width + camera.principal_point_offset.x, y / film.height + camera.principal_point_offset.y);
  const glm::dvec3 local((1.0 - 2.0 * ndc.x) * camera.tan_half_fov_x, (1.0 - 2.0 * ndc.y) * camera.tan_half_fov_x * aspect, 1.0);
  return glm::dmat3(camera.to_world) * local;
}

std::vector<Ray> entered(std::vector<Ray> rays) {
  run("camera_test.cl", "enter", rays.size(), out(rays));
  return rays;
}

}  // namespace

// Direction: corner, two steps and sums err by 6 u of the largest of them, at most sqrt(3) (1 + tan) here; normalising adds 4 u.
TEST(camera_test, rays_are_those_of_the_pinhole_with_principal_point_and_clip_planes) {
  for (const glm::dvec2& offset : {glm::dvec2(0.0), glm::dvec2(0.25, -0.125)}) {
    World world = view({0.1, -0.2, 0.3}, {0.7, 0.5, 0.1}, 0.8, 64, 48);
    world.camera.principal_point_offset = offset;
    world.camera.near_clip = 0.01;
    world.camera.far_clip = 0.4;
    const Scene scene = place_scene(world);
    ASSERT_EQ(scene.frame.exponent, 0);
    std::vector<float> x, y;
    for (int i = 0; i <= 64; i += 4)
      for (int j = 0; j <= 48; j += 3) {
        x.push_back(static_cast<float>(i) + 0.25f);
        y.push_back(static_cast<float>(j));
      }
    const std::vector<Ray> all = rays(scene, x, y);
    for (std::size_t i = 0; i < all.size(); ++i) {
      const glm::dvec3 along = pinhole(world.camera, world.film, x[i], y[i]);
      const double stretch = glm::length(along);
      EXPECT_LE(glm::length(unpacked(all[i].direction) - along / stretch), 24 * unit_roundoff);
      EXPECT_NEAR(glm::length(unpacked(all[i].direction)), 1.0, 4 * unit_roundoff);
      EXPECT_LE(glm::length(unpacked(all[i].origin) - (glm::dvec3(0.1, -0.2, 0.3) + 0.01 * along)), 8 * unit_roundoff);
      EXPECT_NEAR(all[i].t_max, (0.4 - 0.01) * stretch, 24 * unit_roundoff);
      EXPECT_EQ(all[i].skip, NONE);
      EXPECT_EQ(all[i].target, NONE);
      EXPECT_EQ(all[i].t_min, 0.0f);
      EXPECT_EQ(all[i].passed, 0u);
    }
  }
}

// The frame's scale is taken out of the clip planes and of the position, not of the direction.
TEST(camera_test, scaling_the_world_by_a_power_of_two_changes_no_ray) {
  for (const int k : {-20, 20}) {
    World world = view({0.1, -0.2, 0.3}, {0.7, 0.5, 0.1}, 0.8, 16, 16), scaled = world;
    for (glm::dvec3& p : scaled.shapes[0].mesh.positions) p *= std::ldexp(1.0, k);
    scaled.camera.to_world[3] = glm::dvec4(std::ldexp(1.0, k) * glm::dvec3(world.camera.to_world[3]), 1.0);
    scaled.camera.near_clip = std::ldexp(world.camera.near_clip, k);
    scaled.camera.far_clip = std::ldexp(world.camera.far_clip, k);
    const std::vector<float> x = {0.0f, 3.5f, 16.0f}, y = {16.0f, 0.25f, 8.0f};
    const std::vector<Ray> a = rays(place_scene(world), x, y), b = rays(place_scene(scaled), x, y);
    EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(Ray)), 0);
  }
}

// From outside: the origin moves along the ray to just before the box, and nothing in the box is passed over. What is left in
// front of the box is below 2^-15, so that float32 resolves the box as well as from inside.
TEST(camera_test, rays_from_far_away_start_at_the_box_and_never_inside_it) {
  Random random(1);
  for (const double distance : {1.001, 1.5, 4.0, 100.0, 1e4, 1e6, 3e7}) {
    std::vector<Ray> far;
    for (std::size_t i = 0; i < count_or_small(20000, 20); ++i) {
      glm::dvec3 origin = random.direction();
      origin *= distance / std::max({std::abs(origin.x), std::abs(origin.y), std::abs(origin.z)});
      const packed_float3 o = packed(origin);
      far.push_back({o, static_cast<float>(2 * distance + 4), packed(glm::normalize(random.in_cube(1.0) - unpacked(o))), NONE, NONE, 0.0f, 0});
    }
    const std::vector<Ray> near = entered(far);
    std::size_t passed = 0, outside = 0;
    for (std::size_t i = 0; i < far.size(); ++i) {
      const glm::dvec3 o = unpacked(far[i].origin), d = unpacked(far[i].direction), moved = unpacked(near[i].origin);
      EXPECT_EQ(std::memcmp(&near[i].direction, &far[i].direction, sizeof(packed_float3)), 0);
      double enter = 0.0, leave = 1e30;
      for (int a = 0; a < 3; ++a) {
        if (d[a] == 0.0) continue;
        enter = std::max(enter, ((d[a] > 0 ? -1.0 : 1.0) - o[a]) / d[a]);
        leave = std::min(leave, ((d[a] > 0 ? 1.0 : -1.0) - o[a]) / d[a]);
      }
      if (enter > leave) continue;  // the exact float ray misses the box
      const double done = glm::dot(moved - o, d) / glm::dot(d, d);
      const double largest = std::max({std::abs(moved.x), std::abs(moved.y), std::abs(moved.z)});
      // On the ray: the fma rounds each coordinate once in the end, and once where the first step stops, 2^-20 of the way short.
      EXPECT_LE(glm::length(moved - (o + done * d)), 2 * std::sqrt(3.0) * unit_roundoff * (largest + 2 * distance * 0x1p-20));
      passed += done > enter;
      outside += largest > 1.0 + 0x1p-15;
      // t_max goes down by what was gone, to its own rounding.
      EXPECT_NEAR(near[i].t_max, far[i].t_max - done, 4 * unit_roundoff * far[i].t_max);
    }
    EXPECT_EQ(passed, 0u) << "rays that start behind the side of the box, distance " << distance;
    EXPECT_EQ(outside, 0u) << "distance " << distance;
  }
}

TEST(camera_test, rays_from_inside_the_box_are_left_alone) {
  Random random(2);
  std::vector<Ray> inside;
  for (int i = 0; i < 1000; ++i) {
    packed_float3 d = packed(random.direction());
    if (i % 5 == 0) d = {0.0f, -0.0f, i % 2 ? 1.0f : -1.0f};
    inside.push_back({packed(random.in_cube(1.0)), 2.0f, d, NONE, NONE, 0.0f, 0});
  }
  inside.push_back({{0.5f, -0.25f, 0.0f}, 2.0f, {1, 0, 0}, NONE, NONE, 0.0f, 0});
  const std::vector<Ray> after = entered(inside);
  EXPECT_EQ(std::memcmp(after.data(), inside.data(), inside.size() * sizeof(Ray)), 0);
}

// Extreme X47: 1024 pixels over 0.01 degrees.
TEST(camera_test, neighbouring_pixels_of_a_view_of_a_hundredth_degree_have_distinct_directions) {
  for (const glm::dvec3& to : {glm::dvec3(0.5, 0.5, 0.5), glm::dvec3(0.9, 0.0, 0.0), glm::dvec3(0.3, -0.8, 0.1)}) {
    const Scene scene = place_scene(view({0, 0, 0}, to, std::tan(0.005 * std::acos(-1.0) / 180.0), 1024, 1024));
    std::vector<float> x, y;
    for (int i = 0; i < 1024; ++i) {
      x.push_back(static_cast<float>(i) + 0.5f);
      y.push_back(512.0f);
    }
    std::set<std::array<float, 3>> directions;
    for (const Ray& ray : rays(scene, x, y)) directions.insert({ray.direction.x, ray.direction.y, ray.direction.z});
    EXPECT_EQ(directions.size(), 1024u);
  }
  record_law("X47");
}

// Extreme X48, and the truncation at the film's edge: with the film's own filter no sample leaves the crop window, unless asked to.
TEST(camera_test, samples_stay_in_the_window_unless_the_border_is_sampled) {
  World world = view({0, 0, 0}, {1, 0, 0}, 1.0, 8, 8);
  world.film.crop_x = 2;
  world.film.crop_y = 3;
  world.film.crop_width = 1;
  world.film.crop_height = 4;
  world.film.filter = FilterKind::tent;
  world.film.filter_radius = 2.0;
  for (const bool border : {false, true}) {
    world.film.sample_border = border;
    const Scene scene = place_scene(world);
    std::vector<Ray> all(count_or_small(5000, 500));  // P(none within reach of an end) = (1 - reach^2 / 8)^n <= 2e-3, 1e-7
    run("camera_test.cl", "samples", all.size(), std::vector<Camera>{scene.camera}, std::vector<Settings>{scene.settings}, scene.filter, cl_uint{2}, cl_uint{4}, out(all));
    double low_x = 1e9, high_x = -1e9, low_y = 1e9, high_y = -1e9, xx = 0, yy = 0, xy = 0;
    for (const Ray& ray : all) {  // the view is along +x, left is +y, up is +z, tan 1: back to the film
      const double x = 4.0 * (1.0 - ray.direction.y / ray.direction.x), y = 4.0 * (1.0 - ray.direction.z / ray.direction.x);
      low_x = std::min(low_x, x), high_x = std::max(high_x, x);
      low_y = std::min(low_y, y), high_y = std::max(high_y, y);
      const double dx = x - 2.5, dy = y - (border ? 4.5 : 4.75);  // means, to less than the error: cut on one side the tent's is .25 off
      xx += dx * dx, yy += dy * dy, xy += dx * dy;
    }
    EXPECT_LE(std::abs(xy) / std::sqrt(xx * yy), sidak_z / std::sqrt(static_cast<double>(all.size())));  // x and y are independent
    const double slack = 1e-5, reach = small_inputs() ? 0.5 : 0.1;
    const double x0 = border ? 0.5 : 2.0, x1 = border ? 4.5 : 3.0, y0 = border ? 2.5 : 3.0, y1 = border ? 6.5 : 6.5;
    EXPECT_GE(low_x, x0 - slack);
    EXPECT_LE(high_x, x1 + slack);
    EXPECT_GE(low_y, y0 - slack);
    EXPECT_LE(high_y, y1 + slack);
    EXPECT_LE(low_x, x0 + reach);
    EXPECT_GE(high_x, x1 - reach);
    EXPECT_LE(low_y, y0 + reach);
    EXPECT_GE(high_y, y1 - reach);
  }
}
