// Mirrors and conductors: no sample is random but for its place in the pixel, so that most laws hold in every sample.
#include "extremes.h"
#include "image.h"

using namespace oclair;
using namespace oclair::test;

namespace {

Material conductor(glm::dvec3 eta, glm::dvec3 k) {
  Material m = diffuse(1.0);
  m.kind = MATERIAL_CONDUCTOR;
  m.conductor_eta = {static_cast<float>(eta.x), static_cast<float>(eta.y), static_cast<float>(eta.z)};
  m.conductor_k = {static_cast<float>(k.x), static_cast<float>(k.y), static_cast<float>(k.z)};
  return m;
}

// The point of the plane z = 0 that a camera sees at the given angle, under light that is 1 from everywhere.
Film reflectance_at(const Material& material, double degrees) {
  World world;
  add_light(world, LIGHT_CONSTANT, glm::dvec3(1.0));
  add_quad(add_shape(world, material, Sides::front).mesh, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
  const double angle = glm::radians(degrees);
  look_closely(world, {-std::sin(angle), 0.0, std::cos(angle)}, {0, 0, 0});
  world.camera.tan_half_fov_x = 1e-6;
  return render_full(world, 16);
}

glm::dvec3 mirrored(glm::dvec3 p, glm::dvec3 on_plane, glm::dvec3 normal) { return p - 2.0 * glm::dot(p - on_plane, normal) * normal; }

}  // namespace

// Two parallel mirrors and a lamp at the end: n reflections leave r^n, each with one rounding, and one more for the product
// with the lamp's radiance and one for the film.
TEST(mirror_image, corridor_of_n_reflections_is_r_to_the_n_in_every_sample) {
  struct Case { double reflectance; int reflections; };
  double worst = 0.0;
  for (const Case c : {Case{0.9, 10}, {0.99, 100}, {0.99, 1000}}) {
    SCOPED_TRACE(c.reflections);
    World world;
    const double length = 4.0;
    WorldShape& walls = add_shape(world, mirror(c.reflectance), Sides::front);
    add_quad(walls.mesh, {0, -0.5, 0}, {length, 0, 0}, {0, 1, 0});
    add_quad(walls.mesh, {0, -0.5, 1}, {0, 1, 0}, {length, 0, 0});
    add_quad(add_black(world, glm::dvec3(1.0)).mesh, {length, -1, -1}, {0, 0, 3}, {0, 2, 0});  // faces -x
    // From the middle of the entry, up by n / length per unit of x: the last reflection is half a period before the lamp.
    look_closely(world, {0, 0.1, 0.5}, {1, 0.1, 0.5 + c.reflections / length});
    world.camera.tan_half_fov_x = 1e-6;
    world.integrator.rr_depth = no_roulette;
    const double r = static_cast<float>(c.reflectance);
    const double bound = (c.reflections + 2) * unit_roundoff;
    worst = std::max(worst, expect_every_sample(render_full(world, 4), std::pow(r, c.reflections), bound) / bound);
    world.integrator.max_depth = c.reflections;  // one segment too few
    EXPECT_EQ(estimate(render_full(world, 1)).mean, 0.0);
  }
  record_extreme("X30", worst, 1);
}

// A small lamp seen by way of two mirrors stands at its image in the second mirror of its image in the first: at the middle of the
// picture, as a disk of its true angular size, with both reflectances.
TEST(mirror_image, lamp_stands_at_its_image_in_two_mirrors) {
  const glm::dvec3 lamp(0.6, 0.3, 0.5), eye(2.3, -0.2, 4.0);
  const glm::dvec3 normal_a(0, 0, 1), on_a(0, 0, 0), normal_b = glm::normalize(glm::dvec3(1, 0.1, -0.05)), on_b(-1.2, 0, 0);
  const glm::dvec3 image = mirrored(mirrored(lamp, on_a, normal_a), on_b, normal_b);
  const double radius = 0.02;
  World world;
  add_quad(add_shape(world, mirror(0.8), Sides::front).mesh, {-1.2, -3, 0}, {5, 0, 0}, {0, 6, 0});
  const glm::dvec3 x = glm::normalize(glm::cross(glm::dvec3(0, 1, 0), normal_b)), y = glm::cross(normal_b, x);
  add_quad(add_shape(world, mirror(0.7), Sides::front).mesh, on_b - 3.0 * x - 3.0 * y, 6.0 * x, 6.0 * y);
  WorldShape& ball = add_black(world, glm::dvec3(1.0));
  ball.geometry = Geometry::sphere;
  ball.to_world = glm::dmat4(radius);
  ball.to_world[3] = glm::dvec4(lamp, 1);
  const double sine = radius / glm::length(image - eye);  // of its angular radius
  look(world, eye, image, {0, 0, 1}, 3 * sine, 32, 32);
  world.integrator.rr_depth = no_roulette;
  const Film film = render_full(world, 256);

  const double both = static_cast<double>(0.8f) * 0.7f;
  double sum = 0.0, sum_x = 0.0, sum_y = 0.0, highest = 0.0;
  for (uint j = 0; j < 32; ++j)
    for (uint i = 0; i < 32; ++i) {
      const double value = pixel_mean(film, j * 32 + i)[0];
      sum += value;
      sum_x += value * (i + 0.5 - 16);
      sum_y += value * (j + 0.5 - 16);
      highest = std::max(highest, value);
    }
  EXPECT_NEAR(highest, both, 4 * unit_roundoff);
  // Only the some 60 pixels on the disk's rim have noise: each of at most 1/2 per sample.
  const double pixel_area = std::pow(6 * sine / 32, 2), noise = z_limit * 0.5 * std::sqrt(60.0 / 256.0);
  const double disk = glm::pi<double>() * sine * sine / (1.0 - sine * sine);  // of radius tan on the film
  EXPECT_NEAR(sum / both, disk / pixel_area, noise);
  EXPECT_NEAR(sum_x / sum, 0.0, noise * 16.0 / (disk / pixel_area));
  EXPECT_NEAR(sum_y / sum, 0.0, noise * 16.0 / (disk / pixel_area));
}

// (eta, k) at 0, 45, 80 and 89 degrees: Born and Wolf 1999, 14.2, in mpmath. Three materials at once as red, green, blue. 1e-6 for the
// formula; near 89 degrees the cosine's rounding of 1e-7 is multiplied by a slope of up to 5.
TEST(mirror_image, conductor_reflects_by_the_exact_fresnel_equations) {
  const double degrees[4] = {0, 45, 80, 89};
  const double table[6][6] = {{1.2, 7.26, .91659078745, .91256272038, .85363993287, .9593241089},
                              {.155, 3.6, .95662523327, .95500685894, .95718759359, .99409246082},
                              {.06, 3.59, .98287145742, .98219859264, .98300889201, .99770455046},
                              {1, 1000, .999996000016, .99999575738, .99998813567, .99988575571},
                              {1.5, 0, .04, .050239911012, .387704354691, .904184949780},   // without absorption: the dielectric
                              {2.42, 0, .172394924934, .191907354, .433327611245, .899692950188}};
  for (int first = 0; first < 6; first += 3)
    for (int angle = 0; angle < 4; ++angle) {
      glm::dvec3 eta, k;
      for (int c = 0; c < 3; ++c) {
        eta[c] = table[first + c][0];
        k[c] = table[first + c][1];
      }
      const Film film = reflectance_at(conductor(eta, k), degrees[angle]);
      for (int c = 0; c < 3; ++c) {
        SCOPED_TRACE(testing::Message() << eta[c] << " + i " << k[c] << " at " << degrees[angle]);
        if (eta[c] == 2.42 && angle == 1) continue;  // compared with the dielectric below
        EXPECT_NEAR(estimate(film, c).mean, table[first + c][2 + angle], 2e-6);
      }
    }
}

// A glass surface over nothing: what it reflects is red, what it transmits is lost on a black plate. Its mean is the conductor without
// absorption.
TEST(mirror_image, conductor_without_absorption_is_the_dielectric) {
  for (const double degrees : {20.0, 45.0, 70.0, 85.0}) {
    SCOPED_TRACE(degrees);
    const double r = estimate(reflectance_at(conductor(glm::dvec3(2.42), glm::dvec3(0.0)), degrees)).mean;
    World world;
    add_light(world, LIGHT_CONSTANT, glm::dvec3(1.0));
    add_quad(add_shape(world, dielectric(2.42), Sides::both).mesh, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
    add_quad(add_black(world).mesh, {-2, -2, -0.1}, {4, 0, 0}, {0, 4, 0});
    const double angle = glm::radians(degrees);
    look_closely(world, {-std::sin(angle), 0.0, std::cos(angle)}, {0, 0, 0});
    expect_mean(render_full(world, 640), r, 0.005 / r);
  }
}

TEST(mirror_image, mirror_is_black_behind_and_exact_in_front) {
  expect_every_sample(reflectance_at(mirror(0.75), 30), 0.75, 0.0);
  expect_every_sample(reflectance_at(mirror(0.75), 89.9), 0.75, 0.0);
  EXPECT_EQ(estimate(reflectance_at(mirror(0.75), 150)).mean, 0.0);
}
