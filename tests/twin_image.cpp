// Renders whose kernel computes in double, Scene::double_precision.
#include "image.h"

using namespace oclair;
using namespace oclair::test;

namespace {

bool has_double() { return device().device.getInfo<CL_DEVICE_DOUBLE_FP_CONFIG>() != 0; }

Film render_in(bool double_precision, const World& world, uint samples, bool every = true) {
  Scene scene = place_scene(world);
  if (every) scene.features = every_feature;
  scene.double_precision = double_precision;
  return render_scene(std::move(scene), samples);
}

// A corridor of two mirrors with a lamp of 1 at its end, seen by way of that many reflections.
World corridor(float reflectance, int reflections) {
  World world;
  const double length = 4.0;
  WorldShape& walls = add_shape(world, mirror(reflectance), Sides::front);
  add_quad(walls.mesh, {0, -0.5, 0}, {length, 0, 0}, {0, 1, 0});
  add_quad(walls.mesh, {0, -0.5, 1}, {0, 1, 0}, {length, 0, 0});
  add_quad(add_black(world, glm::dvec3(1.0)).mesh, {length, -1, -1}, {0, 0, 3}, {0, 2, 0});
  look_closely(world, {0, 0.1, 0.5}, {1, 0.1, 0.5 + reflections / length});
  world.camera.tan_half_fov_x = 1e-6;
  world.integrator.rr_depth = no_roulette;
  return world;
}

// The largest relative error of a pixel.
double worst_error(const Film& film, double expected) {
  double worst = 0;
  for (std::size_t i = 0; i < film.pixels.size(); ++i)
    for (const double channel : pixel_mean(film, i)) worst = std::max(worst, std::abs(channel - expected) / expected);
  return worst;
}

}  // namespace

// n reflections are n products of doubles; the film rounds a sample to float, by u. In float they may err by n u, and do by
// more than u.
TEST(twin_image, a_thousand_reflections_in_double_are_their_closed_form_rounded_once) {
  if (!has_double()) GTEST_SKIP() << "no double precision";
  for (const int reflections : {100, 1000}) {
    const World world = corridor(0.99f, reflections);
    const double expected = std::pow(double{0.99f}, reflections);
    EXPECT_LE(worst_error(render_in(true, world, 4), expected), unit_roundoff + (reflections + 1) * 0x1p-53);
    EXPECT_GT(worst_error(render_in(false, world, 4), expected), unit_roundoff);
  }
}

// A floor under a point light, straight: no sample hangs on a decision, so both precisions see the same light but for
// rounding. The floor fills the frame, and light and camera are at least 1/2 from it: a point that is seen is off by at most
// 12 u for the camera's ray at t < 2 (6 roundings) and 8 u of the triangle, both doubled by a cosine above 1/2: 40 u. The
// radiance is h / d^3, whose logarithm changes by at most 4 / d = 8 per length: 320 u, and u for each of some 40 further
// roundings.
TEST(twin_image, where_nothing_is_decided_float_and_double_differ_by_rounding) {
  if (!has_double()) GTEST_SKIP() << "no double precision";
  World world;
  add_quad(add_shape(world, diffuse(0.5), Sides::front).mesh, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
  add_light(world, LIGHT_POINT, glm::dvec3(1.0), {0.3, 0.2, 0.6});
  look(world, {0, 0.1, 0.7}, {0, 0, 0}, {0, 1, 0}, 0.5, 32, 32);
  world.integrator.max_depth = 2;
  const Film single = render_in(false, world, 1), twin = render_in(true, world, 1);
  std::size_t differ = 0;
  for (std::size_t i = 0; i < twin.pixels.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      const double a = pixel_mean(single, i)[c], b = pixel_mean(twin, i)[c];
      ASSERT_GT(b, 0);
      ASSERT_NEAR(a, b, 360 * unit_roundoff * b) << "pixel " << i;
      differ += a != b;
    }
  EXPECT_GT(differ, 0u) << "both are rendered in float";
}

// As in float: what a scene does not have changes nothing.
TEST(twin_image, an_image_in_double_does_not_depend_on_the_features_of_its_kernel) {
  if (!has_double()) GTEST_SKIP() << "no double precision";
  World world;
  add_box(add_shape(world, diffuse(0.7), Sides::front).mesh, {-1, -1, -1}, {1, 1, 1}, true);
  add_box(add_shape(world, dielectric(1.5), Sides::both).mesh, {-0.5, -0.5, -0.9}, {0.1, 0.2, -0.2}, false);
  add_quad(add_black(world, glm::dvec3(5.0)).mesh, {-0.3, -0.3, 0.95}, {0, 0.6, 0}, {0.6, 0, 0});
  look(world, {0.2, -0.9, 0.1}, {0, 0, -0.4}, {0, 0, 1}, 0.8, 16, 16);
  const Film all = render_in(true, world, 16), exact = render_in(true, world, 16, false);
  EXPECT_GT(image_mean(all).mean, 0.01);
  for (std::size_t i = 0; i < all.pixels.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t limb = 0; limb < 2; ++limb)
        ASSERT_EQ(all.pixels[i].sum[c][limb], exact.pixels[i].sum[c][limb]) << "pixel " << i;
}
