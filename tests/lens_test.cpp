// The thin lens: all light of a film point passes one point of the plane in focus.
#include <cstring>

#include "random.h"
#include "statistics.h"
#include "worlds.h"

using namespace oclair;
using namespace oclair::test;

namespace {

using real3 = glm::tvec3<long double>;
using Square = std::array<float, 2>;

World lens(double aperture_radius, double focus_distance, const glm::dvec3& from = {0.1, -0.2, 0.3},
           const glm::dvec3& to = {0.7, 0.5, 0.1}) {
  World world;
  add_box(add_shape(world, diffuse(0.5), Sides::both).mesh, {-0.9, -0.9, -0.9}, {0.9, 0.9, 0.9});  // the identity frame
  look(world, from, to, {0, 0, 1}, 0.8, 64, 48);
  world.camera.near_clip = 1e-3;
  world.camera.aperture_radius = aperture_radius;
  world.camera.focus_distance = focus_distance;
  return world;
}

struct Inputs {
  std::vector<float> x, y;
  std::vector<Square> u;
};

Inputs random_inputs(std::size_t n, std::uint64_t seed) {
  Random random(seed);
  Inputs in;
  for (std::size_t i = 0; i < n; ++i) {
    in.x.push_back(64.0f * random.unit24());
    in.y.push_back(48.0f * random.unit24());
    in.u.push_back({random.unit24(), random.unit24()});
  }
  in.u[0] = {0.0f, 0.0f};
  in.u[1] = {1.0f - 0x1p-24f, 0.0f};
  in.u[2] = {1.0f - 0x1p-24f, 1.0f - 0x1p-24f};
  return in;
}

std::vector<Ray> rays(const Scene& scene, const Inputs& in) {
  std::vector<Ray> result(in.x.size());
  run("lens_test.cl", "rays", in.x.size(), std::vector<Camera>{scene.camera}, in.x, in.y, in.u, out(result));
  return result;
}

// Along the view, component 1 along the axis, as in camera_test.
glm::dvec3 pinhole(const World& world, double x, double y) {
  const double half_x = world.camera.tan_half_fov_x, half_y = half_x * world.film.height / world.film.width;
  return glm::dmat3(world.camera.to_world) *
         glm::dvec3((1.0 - 2.0 * x / world.film.width) * half_x, (1.0 - 2.0 * y / world.film.height) * half_y, 1.0);
}

// Where the ray is at that depth along the camera's axis.
real3 at_depth(const World& world, const Ray& ray, double depth) {
  const real3 o(unpacked(ray.origin)), d(unpacked(ray.direction)), axis(world.camera.to_world[2]),
      center(world.camera.to_world[3]);
  return o + d * ((static_cast<long double>(depth) - glm::dot(o - center, axis)) / glm::dot(d, axis));
}

// On the lens, in the camera's frame.
glm::dvec2 on_lens(const World& world, const Ray& ray) {
  const real3 p = at_depth(world, ray, 0.0) - real3(world.camera.to_world[3]);
  return {static_cast<double>(glm::dot(p, real3(world.camera.to_world[0]))),
          static_cast<double>(glm::dot(p, real3(world.camera.to_world[1])))};
}

}  // namespace

// What a lens point is rounded to cancels: it is added to the origin and taken from the direction. What is left: the origin,
// rounded four times (8 u of 1 + a); the direction before normalisation, 6 u of its parts (each at most 2 here) as in
// camera_test, the division, subtraction and product 3 u of a / f + 2, normalising 4 u, all times the distance.
TEST(lens_test, all_rays_of_a_film_point_meet_in_the_plane_of_focus) {
  for (const double aperture : {1e-6, 0.01, 0.25})
    for (const double focus : {0.1, 0.6, 1.7, 1000.0}) {
      const World world = lens(aperture, focus);
      const Scene scene = place_scene(world);
      ASSERT_EQ(scene.frame.exponent, 0);
      const Inputs in = random_inputs(count_or_small(5000, 50), 1);
      const std::vector<Ray> all = rays(scene, in);
      double worst = 0.0;
      for (std::size_t i = 0; i < all.size(); ++i) {
        const double f = static_cast<double>(scene.camera.focus_distance);
        const glm::dvec3 along = pinhole(world, in.x[i], in.y[i]);
        const real3 exact = real3(world.camera.to_world[3]) + real3(along) * static_cast<long double>(f);
        const double distance = f * (glm::length(along) + aperture / f);
        // A ray that runs aslant meets the plane later or sooner: by its own slope.
        const double slope = glm::length(along) + aperture / f;
        const double bound = unit_roundoff * slope * (8 * (1 + aperture) + 24 * distance + 3 * aperture);
        const double error = static_cast<double>(glm::length(at_depth(world, all[i], f) - exact));
        worst = std::max(worst, error / bound);
        EXPECT_NEAR(glm::length(unpacked(all[i].direction)), 1.0, 4 * unit_roundoff);
      }
      EXPECT_LE(worst, 1.0) << "aperture " << aperture << ", focus " << focus;
    }
}

// Measured in Mitsuba 3.9.1, scalar_rgb: identity, 60 degrees, 8x4 pixels, aperture_radius 0.1, focus_distance 3, clip
// planes 1 and 5, sample_ray of film (0, 0) and aperture sample (1, 0.5), whose lens point is (0.1, 0). Here +x of the film
// runs to -x.
TEST(lens_test, a_ray_is_that_of_mitsuba) {
  World world = lens(0.1, 3.0);
  world.camera.to_world = glm::dmat4(1.0);
  world.camera.tan_half_fov_x = std::tan(std::acos(-1.0) / 6.0);
  world.camera.near_clip = 1.0;
  world.camera.far_clip = 5.0;
  world.film.width = world.film.crop_width = 8;
  world.film.height = world.film.crop_height = 4;
  const Ray ray = rays(place_scene(world), {{0, 0, 0}, {0, 0, 0}, {{1.0f - 0x1p-24f, 0.5f}, {0.0f, 0.0f}, {0.0f, 0.0f}}})[0];
  const glm::dvec3 origin(0.6440169, 0.28867513, 1.0), direction(0.46321756, 0.24580005, 0.8514764);
  EXPECT_LE(glm::length(unpacked(ray.origin) - origin), 1e-6);
  EXPECT_LE(glm::length(unpacked(ray.direction) - direction), 1e-6);
  EXPECT_NEAR(ray.t_max, 4.6977229, 4e-6);
}

// Depths err like the origin (8 u of 1 + a) and the direction (24 u of the distance).
TEST(lens_test, clip_planes_cut_at_their_depth_wherever_a_ray_passes_the_lens) {
  World world = lens(0.2, 0.5);
  world.camera.near_clip = 0.05;
  world.camera.far_clip = 0.4;
  const Inputs in = random_inputs(count_or_small(5000, 50), 2);
  const glm::dvec3 axis(world.camera.to_world[2]), center(world.camera.to_world[3]);
  for (const Ray& ray : rays(place_scene(world), in)) {
    const glm::dvec3 near = unpacked(ray.origin), far = near + static_cast<double>(ray.t_max) * unpacked(ray.direction);
    EXPECT_NEAR(glm::dot(near - center, axis), 0.05, 24 * unit_roundoff);
    EXPECT_NEAR(glm::dot(far - center, axis), 0.4, 48 * unit_roundoff);
  }
}

TEST(lens_test, without_an_aperture_the_camera_is_the_pinhole_bit_for_bit) {
  const World world = lens(0.0, 0.5);
  const Scene scene = place_scene(world);
  EXPECT_EQ(scene.features & FEATURE_THIN_LENS, 0u);
  const Inputs in = random_inputs(count_or_small(2000, 50), 3);
  std::vector<Ray> pinhole(in.x.size());
  run("camera_test.cl", "rays", in.x.size(), std::vector<Camera>{scene.camera}, in.x, in.y, out(pinhole));
  const std::vector<Ray> closed = rays(scene, in);
  EXPECT_EQ(std::memcmp(closed.data(), pinhole.data(), closed.size() * sizeof(Ray)), 0);
  Inputs middle = in;
  for (Square& u : middle.u) u[0] = 0.0f;  // an open lens, passed in its middle
  const std::vector<Ray> open = rays(place_scene(lens(0.1, 0.5)), middle);
  EXPECT_EQ(std::memcmp(open.data(), pinhole.data(), open.size() * sizeof(Ray)), 0);
}

TEST(lens_test, scaling_the_world_by_a_power_of_two_changes_no_ray) {
  const World world = lens(0.125, 0.6);
  const Inputs in = random_inputs(count_or_small(2000, 50), 4);
  const std::vector<Ray> expected = rays(place_scene(world), in);
  for (const int k : {-20, 20}) {
    World scaled = world;
    for (glm::dvec3& p : scaled.shapes[0].mesh.positions) p *= std::ldexp(1.0, k);
    scaled.camera.to_world[3] = glm::dvec4(std::ldexp(1.0, k) * glm::dvec3(world.camera.to_world[3]), 1.0);
    for (double* length :
         {&scaled.camera.near_clip, &scaled.camera.far_clip, &scaled.camera.aperture_radius, &scaled.camera.focus_distance})
      *length = std::ldexp(*length, k);
    const std::vector<Ray> rays_there = rays(place_scene(scaled), in);
    EXPECT_EQ(std::memcmp(expected.data(), rays_there.data(), expected.size() * sizeof(Ray)), 0);
  }
}

// Of the samples of one pixel: 16 x 16 cells of equal area on the lens; and the four joint halves of film and lens, for each
// pair of their axes. A point on the lens is known to 1e-5 of its radius: fewer than 1 in 10^4 can be in a neighbouring
// cell.
TEST(lens_test, samples_are_uniform_on_the_lens_and_independent_of_the_film_position) {
  World world = lens(0.25, 0.5);
  world.film.width = world.film.crop_width = world.film.height = world.film.crop_height = 1;
  const Scene scene = place_scene(world);
  std::vector<Ray> all(count_or_small(200000, 500));
  run("lens_test.cl", "samples", all.size(), std::vector<Camera>{scene.camera}, std::vector<Settings>{scene.settings},
      scene.filter, cl_uint{0}, cl_uint{0}, out(all));
  std::vector<double> cells(256, 0.0),
      joint[4] = {std::vector<double>(4), std::vector<double>(4), std::vector<double>(4), std::vector<double>(4)};
  const real3 x(world.camera.to_world[0]), y(world.camera.to_world[1]), center(world.camera.to_world[3]);
  for (const Ray& ray : all) {
    const glm::dvec2 p = on_lens(world, ray) / 0.25;
    const double r2 = glm::dot(p, p), turn = std::atan2(p.y, p.x) / (2.0 * std::acos(-1.0)) + 0.5;
    EXPECT_LE(r2, 1.0 + 1e-5);
    const auto cell = [](double v) { return static_cast<std::size_t>(std::clamp(16.0 * v, 0.0, 15.0)); };
    ++cells[16 * cell(r2) + cell(turn)];
    const real3 q = at_depth(world, ray, 0.5) - center;
    const bool film[2] = {glm::dot(q, x) > 0, glm::dot(q, y) > 0}, on[2] = {p.x > 0, p.y > 0};
    for (int i = 0; i < 4; ++i) ++joint[i][2 * film[i / 2] + on[i % 2]];
  }
  EXPECT_GE(uniformity_test(cells), significance(5));
  for (const auto& counts : joint) EXPECT_GE(uniformity_test(counts), significance(5));
}

// Extremes: a lens of a hundredth of everything, and one from 10^6 away. There a float32 direction is worth 2^-24 10^6 =
// 0.06.
TEST(lens_test, tiny_and_distant_lenses_give_rays_between_the_clip_planes) {
  for (const double size : {0.01, 1e6}) {
    World world = lens(0.05 * size, size, glm::dvec3(0.6, -0.48, 0.64) * size, {0, 0, 0});
    world.camera.near_clip = 1e-3 * size;
    world.camera.far_clip = 3.0 * size;
    world.camera.tan_half_fov_x = 0.5 / size;
    const Inputs in = random_inputs(count_or_small(2000, 50), 5);
    const std::vector<Ray> all = rays(place_scene(world), in);
    for (std::size_t i = 0; i < all.size(); ++i) {
      const real3 focus = at_depth(world, all[i], size);
      const glm::dvec3 exact = glm::dvec3(world.camera.to_world[3]) + size * pinhole(world, in.x[i], in.y[i]);
      const double slope = glm::length(pinhole(world, in.x[i], in.y[i])) + 0.05;
      EXPECT_LE(static_cast<double>(glm::length(focus - real3(exact))), slope * unit_roundoff * (8 + 48 * slope * size))
          << size;
      EXPECT_GT(all[i].t_max, 0.0f);
    }
  }
}
