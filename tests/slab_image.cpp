// Lossless plates: transmittance with all orders of internal reflection, against closed forms. The renderer averages the two
// polarisations at each surface, so the oracle does too: T = (1 - R) / (1 + R) with R the mean reflectance.
#include "image.h"

using namespace oclair;
using namespace oclair::test;

namespace {

// Plates of thickness .01, .01 apart, seen from above at the given angle. Transmitted light is red, from a black plate below that
// emits upwards; reflected light is green, from around. Each path ends with one of them.
World plates(int count, const Material& material, double degrees) {
  World world;
  add_light(world, LIGHT_CONSTANT, {0, 1, 0});
  for (int i = 0; i < 2 * count; ++i) {
    WorldShape& surface = add_shape(world, material, Sides::both);
    const double z = -0.01 * i;
    if (i % 2 == 0) add_quad(surface.mesh, {-2, -2, z}, {4, 0, 0}, {0, 4, 0});  // front above
    else add_quad(surface.mesh, {-2, -2, z}, {0, 4, 0}, {4, 0, 0});             // front below
  }
  WorldShape& below = add_black(world, {1, 0, 0});
  add_quad(below.mesh, {-4, -4, -0.01 * 2 * count - 0.01}, {8, 0, 0}, {0, 8, 0});
  const double angle = glm::radians(degrees);
  look_closely(world, {-std::sin(angle), 0.0, std::cos(angle)}, {0, 0, 0});
  world.integrator.rr_depth = no_roulette;
  return world;
}

// Born and Wolf 1999, 1.5.2, mean of the polarisations; double.
double reflectance(double eta, double degrees) {
  const double c = std::cos(glm::radians(degrees)), g = std::sqrt(eta * eta - 1.0 + c * c);
  const double s = (c - g) / (c + g), p = (eta * eta * c - g) / (eta * eta * c + g);
  return 0.5 * (s * s + p * p);
}

// Sheets .01 apart, each in the place of a plate.
World sheets(int count, Material material, double degrees) {
  material.kind = MATERIAL_THIN_DIELECTRIC;
  World world = plates(count, material, degrees);
  for (int i = count; i > 0; --i) world.shapes.erase(world.shapes.begin() + 2 * i - 1);  // the lower surface of each
  return world;
}

// Found with a probability of 90 %: the samples are 0 or 1, their deviation at most 1/2.
constexpr double absolute_bias = 0.005;

struct Case {
  double eta, degrees, transmittance;
};

}  // namespace

// Table computed with mpmath at 30 digits.
TEST(slab_image, one_plate_transmits_one_minus_r_over_one_plus_r) {
  for (const Case c : {Case{1.5, 0, .923076923077}, {1.5, 30, .920265532519}, {1.5, 45, .904326791459}, {1.5, 60, .83623246271}, {1.5, 75, .596092047799}, {1.5, 80, .441229173374}, {1.5, 85, .240079637835},
                       {2.42, 0, .705909806896}, {2.42, 45, .692733264849}, {2.42, 60, .650713118386}, {2.42, 75, .503050628474}, {2.42, 80, .395354407679}, {2.42, 85, .233333336171}}) {
    SCOPED_TRACE(testing::Message() << c.eta << " " << c.degrees);
    const double r = reflectance(c.eta, c.degrees);
    EXPECT_NEAR((1.0 - r) / (1.0 + r), c.transmittance, 1e-11);
    const Film film = render_full(plates(1, dielectric(c.eta), c.degrees), 640);
    expect_mean(film, c.transmittance, absolute_bias / c.transmittance, 0);
    expect_mean(film, 1.0 - c.transmittance, absolute_bias / (1.0 - c.transmittance), 1);
    EXPECT_NEAR(estimate(film, 0).mean + estimate(film, 1).mean, 1.0, 64 * unit_roundoff);  // no path is lost
  }
}

TEST(slab_image, stack_of_plates_at_normal_incidence) {
  struct Stack { int count; double transmittance; };
  for (const Stack s : {Stack{2, .857142857143}, {5, .705882352941}, {10, .545454545455}}) {
    SCOPED_TRACE(s.count);
    const Film film = render_full(plates(s.count, dielectric(1.5), 0), 640);
    expect_mean(film, s.transmittance, absolute_bias / s.transmittance, 0);
    EXPECT_NEAR(estimate(film, 0).mean + estimate(film, 1).mean, 1.0, 64 * unit_roundoff);
  }
}

// With factor a for each transmission and b for each reflection: T = (a (1 - R))^2 / (1 - (b R)^2), and the reflected light is
// b R + T b R.
TEST(slab_image, coloured_plate_sums_its_orders) {
  Material glass = dielectric(2.42);
  glass.reflectance = {0.5f, 0.5f, 0.5f};
  glass.transmittance = {0.25f, 0.25f, 0.25f};
  const double r = reflectance(2.42, 60), t = std::pow(0.25 * (1.0 - r), 2) / (1.0 - std::pow(0.5 * r, 2));
  const Film film = render_full(plates(1, glass, 60), 640);
  expect_mean(film, t, 0.02, 0);
  expect_mean(film, 0.5 * r + t * 0.5 * r, 0.02, 1);
}

// Equal indices: no interface at all, in every sample.
TEST(slab_image, plates_without_contrast_are_invisible) {
  for (const double degrees : {0.0, 45.0, 85.0}) {
    const Film film = render_full(plates(3, dielectric(1.0), degrees), 4);
    expect_every_sample(film, 1.0, 0.0, 0);
    EXPECT_EQ(estimate(film, 1).mean, 0.0);
  }
}

// (1 - R)/(1 + R), as a plate whose surfaces are traced: table computed with mpmath at 30 digits.
TEST(slab_image, a_thin_sheet_transmits_what_a_plate_does) {
  for (const Case c : {Case{1.5, 0, .923076923077}, {1.5, 60, .83623246271}, {1.5, 80, .441229173374}, {2.42, 45, .692733264849}, {2.42, 85, .233333336171}}) {
    SCOPED_TRACE(testing::Message() << c.eta << " " << c.degrees);
    const Film film = render_full(sheets(1, dielectric(c.eta), c.degrees), 640);
    expect_mean(film, c.transmittance, absolute_bias / c.transmittance, 0);
    expect_mean(film, 1.0 - c.transmittance, absolute_bias / (1.0 - c.transmittance), 1);
    EXPECT_NEAR(estimate(film, 0).mean + estimate(film, 1).mean, 1.0, 64 * unit_roundoff);
  }
}

TEST(slab_image, stack_of_thin_sheets_transmits_what_a_stack_of_plates_does) {
  const Film film = render_full(sheets(5, dielectric(1.5), 0), 640);
  expect_mean(film, .705882352941, absolute_bias / .705882352941, 0);
  EXPECT_NEAR(estimate(film, 0).mean + estimate(film, 1).mean, 1.0, 64 * unit_roundoff);
}

// One event on a sheet multiplies its colour once.
TEST(slab_image, coloured_sheet_scales_reflection_and_transmission_apart) {
  Material glass = dielectric(2.42);
  glass.reflectance = {0.5f, 0.5f, 0.5f};
  glass.transmittance = {0.25f, 0.25f, 0.25f};
  const double r = reflectance(2.42, 60), t = (1.0 - r) / (1.0 + r);
  const Film film = render_full(sheets(1, glass, 60), 640);
  expect_mean(film, 0.25 * t, 0.02, 0);
  expect_mean(film, 0.5 * (1.0 - t), 0.02, 1);
}

// Schlick's reflectance through the whole renderer: R0 + (1 - R0)(1 - cos)^5 at each surface.
TEST(slab_image, plate_with_schlicks_reflectance_transmits_as_it_says) {
  for (const double degrees : {60.0, 85.0}) {
    SCOPED_TRACE(degrees);
    Scene scene = place_scene(plates(1, dielectric(1.5), degrees));
    scene.features = every_feature;
    scene.approximations = APPROXIMATION_SCHLICK;
    const double r = 0.04 + 0.96 * std::pow(1.0 - std::cos(glm::radians(degrees)), 5), t = (1.0 - r) / (1.0 + r);
    const Film film = render_scene(scene, 640);
    expect_mean(film, t, absolute_bias / t, 0);
    expect_mean(film, 1.0 - t, absolute_bias / (1.0 - t), 1);
  }
}

// A sample is red if the plate transmits it, green if it reflects it: only the red ones are above the limit.
TEST(slab_image, clamping_takes_from_the_brighter_samples_what_they_are_above_the_limit) {
  World world = plates(1, dielectric(1.5), 60);
  world.shapes.back().radiance = glm::dvec3{5, 0, 0};
  Scene scene = place_scene(world);
  scene.features = every_feature;
  scene.approximations = APPROXIMATION_CLAMP;
  scene.settings.largest_sample = 2.0f;
  const Film film = render_scene(std::move(scene), 640);
  expect_mean(film, 2.0 * .83623246271, absolute_bias / .83623246271, 0);
  expect_mean(film, 1.0 - .83623246271, absolute_bias / (1.0 - .83623246271), 1);
}
