// Radiances at both ends of what float32 holds: down to its smallest number, far below those that have all digits.
#include "image.h"

using namespace oclair;
using namespace oclair::test;

namespace {

constexpr double smallest = 0x1p-149;

bool has_denormals() { return (device().device.getInfo<CL_DEVICE_SINGLE_FP_CONFIG>() & CL_FP_DENORM) != 0; }

}  // namespace

TEST(weak_light_image, a_light_that_is_seen_has_the_very_radiance_of_its_float) {
  if (!has_denormals()) GTEST_SKIP() << "the device has no denormal numbers";
  for (const double radiance : {1e-45, 1e-43, 1e-40, 1e-38, 1e-30, 1e30, 1e38}) {
    World world;
    add_quad(add_black(world, glm::dvec3(radiance)).mesh, {-4, 4, 1}, {8, 0, 0}, {0, -8, 0});
    look(world, {0, 0, 0}, {0, 0, 1}, {0, 1, 0}, 0.5, 8, 8);
    const Film film = render_full(world, 2 * REPLICA_SAMPLES);
    EXPECT_EQ(rejected_samples(film), 0u);
    for (std::size_t i = 0; i < film.pixels.size(); ++i) {
      EXPECT_EQ(pixel_mean(film, i)[0], static_cast<double>(static_cast<float>(radiance))) << radiance;
      EXPECT_EQ((*pixel_standard_error(film, i))[0], 0.0);
      EXPECT_EQ(pixel_mean_products(film, i)[0][0], std::pow(static_cast<double>(static_cast<float>(radiance)), 2.0));
    }
  }
}

// A plate under a sky of one radiance reflects its albedo of it. Some eight operations on the way from the light to the film
// round to a multiple of the smallest number each.
TEST(weak_light_image, a_plate_under_a_sky_of_any_radiance_reflects_its_share) {
  if (!has_denormals()) GTEST_SKIP() << "the device has no denormal numbers";
  for (const double radiance : {1e-45, 1e-43, 1e-42, 1e-40, 1e-38, 1e-30, 1e30}) {
    World world;
    add_quad(add_shape(world, diffuse(0.5), Sides::front).mesh, {-0.5, -0.5, 0}, {1, 0, 0}, {0, 1, 0});
    add_light(world, LIGHT_CONSTANT, glm::dvec3(radiance));
    look_closely(world, {0.3, 0.4, 0.6}, {0, 0, 0});
    world.integrator.max_depth = 2;
    const Film film = render_full(world, 256);
    EXPECT_EQ(rejected_samples(film), 0u);
    const double exact = 0.5 * static_cast<double>(static_cast<float>(radiance));
    const Estimate e = estimate(film);
    EXPECT_NEAR(e.mean, exact, z_bound(7) * e.error + 64 * unit_roundoff * exact + 8 * smallest) << radiance;
    // What is far above the smallest number is seen to a per cent.
    if (radiance >= 1e-40) {
      EXPECT_LE(z_power * e.error, 0.01 * exact) << radiance;
    }
  }
}
