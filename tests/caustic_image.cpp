// Light through and around balls, and shadows, against closed forms.
#include "extremes.h"
#include "image.h"

using namespace oclair;
using namespace oclair::test;

namespace {

constexpr double pi = glm::pi<double>();

WorldShape& add_lamp(World& world, glm::dvec3 center, double radius) {
  WorldShape& lamp = add_black(world, glm::dvec3(1.0));
  lamp.geometry = Geometry::sphere;
  lamp.to_world = glm::dmat4(radius);
  lamp.to_world[3] = glm::dvec4(center, 1);
  return lamp;
}

double transmittance(double eta, double sine) {
  const double c = std::sqrt(1.0 - sine * sine), g = std::sqrt(eta * eta - 1.0 + c * c);
  const double s = (c - g) / (c + g), p = (eta * eta * c - g) / (eta * eta * c + g);
  return 1.0 - 0.5 * (s * s + p * p);
}

// A lamp of radius a, black itself, in the middle of a glass ball of radius 1: from outside, a ray of impact parameter b sees the lamp
// if b < eta a, with radiance T(b) / eta^2; the glass has scaled it down again by 1 / eta^2 from what the lamp emits into it.
World lamp_in_glass(double eta, double a) {
  World world;
  add_sphere(world, dielectric(eta), Sides::both, {0, 0, 0}, 1.0);
  add_lamp(world, {0, 0, 0}, a);
  return world;
}

}  // namespace

// A distant camera's rays cover a ball as a parallel beam does. An exit of order p (0: reflected outside) has met the surface
// p + 1 times, so a path cut after N segments brings the orders up to N - 2. Hidden emitters and the share of rays that met the ball
// (alpha) leave only the ball. Orders by quadrature with mpmath.
TEST(caustic_image, parallel_beam_leaves_a_glass_ball_in_its_orders) {
  struct Case { double eta, order[5]; };
  for (const Case c : {Case{1.5, {.0917779593, .8355444001, .0611832167, .0079933771, .0019682129}}, {2.42, {.2125407947, .6264548067, .1250438893, .0266326654, .0063201007}}}) {
    double exact = 0.0;
    for (uint order = 0; order < 5; ++order) {
      SCOPED_TRACE(testing::Message() << c.eta << " " << order);
      exact += c.order[order];
      World world;
      add_light(world, LIGHT_CONSTANT, glm::dvec3(1.0));
      add_sphere(world, dielectric(c.eta), Sides::both, {0, 0, 0}, 1.0);
      look(world, {0, 0, 300}, {0, 0, 0}, {0, 1, 0}, 1.05 / 300, 32, 32);
      world.integrator.rr_depth = no_roulette;
      world.integrator.hide_emitters = true;
      world.integrator.max_depth = order + 2;
      const Film film = render_full(world, 256);
      double hits = 0.0;
      for (std::size_t i = 0; i < film.pixels.size(); ++i) hits += static_cast<double>(film.pixels[i].hits);
      const double rays = static_cast<double>(film.samples * film.pixels.size());
      EXPECT_NEAR(hits / rays, pi / (2.1 * 2.1), z_limit * 0.5 * std::sqrt(100.0 * 256.0) / rays + 3e-5);  // noise on the rim's 100 pixels
      // 3e-5: the beam's divergence, (1 / 300)^2 of a quantity of order 1.
      const double share = estimate(film).mean * rays / hits, error = std::sqrt(exact * (1.0 - exact) / hits);
      EXPECT_NEAR(share, exact, z_limit * error + 3e-5) << "z = " << (share - exact) / error;
    }
  }
}

// The lamp fills the disk b < eta a, at T / eta^2.
TEST(caustic_image, glass_ball_magnifies_the_lamp_inside_it) {
  const double eta = 1.5, a = 0.4, distance = 300.0;
  World world = lamp_in_glass(eta, a);
  look(world, {0, 0, distance}, {0, 0, 0}, {0, 1, 0}, 1.05 / distance, 32, 32);
  double flux = 0.0;  // of L over the disk, by the midpoint rule in b^2
  const int n = 10000;
  for (int i = 0; i < n; ++i) flux += transmittance(eta, eta * a * std::sqrt((i + 0.5) / n)) / n;
  flux *= pi * eta * eta * a * a / (eta * eta);
  expect_mean(render_full(world, 1024), flux / (2.1 * 2.1), 0.006);
}

// Light that only scattering finds: shadow rays end at the glass. With sin = b / d, E = 2 pi / (d eta)^2 integral of T(b) b db.
TEST(caustic_image, floor_lit_through_glass_by_the_lamp_inside_it) {
  const double eta = 1.5, a = 0.5, d = 1.5;
  World world = lamp_in_glass(eta, a);
  add_quad(add_shape(world, diffuse(0.5), Sides::front).mesh, {-0.5, -0.5, -d}, {1, 0, 0}, {0, 1, 0});
  look_closely(world, {0.8, 0.3, -1.2}, {0, 0, -d});
  double integral = 0.0;
  const int n = 10000;
  for (int i = 0; i < n; ++i) {
    const double b = (i + 0.5) / n * eta * a;
    integral += transmittance(eta, b) * b * eta * a / n;
  }
  world.integrator.max_depth = 4;  // floor, in, lamp
  world.integrator.rr_depth = no_roulette;
  const double irradiance = 2.0 * pi / (d * d * eta * eta) * integral;
  expect_mean(render_full(world, 8192), 0.5 * irradiance / pi, 0.012);
}

// A ball before a ball of light, both on the axis: the ring of the light that is left, or nothing at all in any sample.
TEST(caustic_image, eclipse_is_a_ring_or_total) {
  const double d_light = 3.0, r_light = 0.6, d_moon = 1.5;
  for (const double r_moon : {0.15, 0.31}) {  // sines .1 and .2067 against .2
    SCOPED_TRACE(r_moon);
    World world;
    add_quad(add_shape(world, diffuse(0.5), Sides::front).mesh, {-0.5, -0.5, 0}, {1, 0, 0}, {0, 1, 0});
    add_lamp(world, {0, 0, d_light}, r_light);
    WorldShape& moon = add_black(world);
    moon.geometry = Geometry::sphere;
    moon.to_world = glm::dmat4(r_moon);
    moon.to_world[3] = {0, 0, d_moon, 1};
    look_closely(world, {0.5, 0.4, 0.6}, {0, 0, 0});
    world.integrator.max_depth = 2;
    const Film film = render_full(world, 1280);
    if (r_moon < 0.3) expect_mean(film, 0.5 * (std::pow(r_light / d_light, 2) - std::pow(r_moon / d_moon, 2)));
    else EXPECT_EQ(estimate(film).mean, 0.0);
  }
}

namespace {

// A unit cube's shadow on a horizontal plane has the area (|x| + |y| + |z|) / |z| for light that travels along (x, y, z). The camera
// hangs between the two. Returns how far the area is off, in units of the cube.
double shadow_of_a_unit_cube(glm::dvec3 corner, double size, double rounding) {
  World world;
  add_quad(add_shape(world, diffuse(0.5), Sides::front).mesh, corner, {size, 0, 0}, {0, size, 0});
  add_box(add_black(world).mesh, {-1.5, -1.3, 2.2}, {-0.5, -0.3, 3.2});
  const glm::dvec3 light = glm::normalize(glm::dvec3(0.4, 0.3, -1.0));
  add_light(world, LIGHT_DIRECTIONAL, glm::dvec3(1.0), light);
  look(world, {0, 0, 2.0}, {0, 0, 0}, {0, 1, 0}, 1.0, 64, 64);  // sees [-2, 2]^2
  world.integrator.max_depth = 2;
  const Film film = render_full(world, 128);
  const double lit = 0.5 * 1.0 / (glm::length(glm::dvec3(0.4, 0.3, -1.0)) * pi);
  const Estimate e = estimate(film);
  const double off = std::abs((1.0 - e.mean / lit) * 16.0 - 1.7), noise = 16.0 * e.error / lit;
  EXPECT_LE(off, z_limit * noise + rounding);
  EXPECT_LE(z_power * noise, 0.005 * 1.7);
  for (std::size_t i = 0; i < film.pixels.size(); ++i) EXPECT_LE(pixel_mean(film, i)[0], lit * (1.0 + 8 * unit_roundoff));
  return off;
}

}  // namespace

TEST(caustic_image, shadow_of_a_unit_cube_has_its_projected_area) { shadow_of_a_unit_cube({-5, -5, 0}, 10, 1e-5); }

// Extreme X13. A plane of 20 000 cubes' widths, the cube near its edge: the frame halves it 14 times, so that what float32
// rounds is up to 2^-24 2^14 = 2^-10 cubes long: each of the cube's corners, and where the plane is met. The edge of the
// shadow, 5.4 long, moves by both.
TEST(caustic_image, shadow_of_a_unit_cube_on_a_plane_of_20000_has_its_projected_area) {
  const double rounding = 5.4 * 2 * 0x1p-10;
  record_extreme("X13", shadow_of_a_unit_cube({-1000, -1000, 0}, 20000, rounding), rounding + 0.005 * 1.7);
}
