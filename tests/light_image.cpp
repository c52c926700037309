// Direct light against closed forms: the radiance of a diffuse point under each kind of light (form factors: Howell, Menguc,
// Daun, Siegel 2020, appendix C). Light sampling and scattering find the same light, joined by multiple importance sampling.
#include <array>

#include "extremes.h"
#include "image.h"

using namespace oclair;
using namespace oclair::test;

namespace {

constexpr double albedo = 0.5;
constexpr double pi = glm::pi<double>();

// A diffuse floor around the origin, facing +z, whose origin the camera sees; direct light only.
World floor_seen_from(glm::dvec3 from, double half_size = 0.5) {
  World world;
  WorldShape& ground = add_shape(world, diffuse(albedo), Sides::front);
  add_quad(ground.mesh, {-half_size, -half_size, 0}, {2 * half_size, 0, 0}, {0, 2 * half_size, 0});
  look_closely(world, from, {0, 0, 0});
  world.integrator.max_depth = 2;
  return world;
}

// L = albedo E / pi.
double radiance(double irradiance) { return albedo * irradiance / pi; }

// Form factor of a point to a rectangle a x b parallel to it at distance 1, one corner straight above it.
double corner_factor(double a, double b) {
  const double x = std::sqrt(1.0 + a * a), y = std::sqrt(1.0 + b * b);
  return (a / x * std::atan(b / x) + b / y * std::atan(a / y)) / (2.0 * pi);
}

// A rectangle that faces down.
WorldShape& add_ceiling(World& world, glm::dvec3 origin, double width, double height, double radiance = 1.0) {
  WorldShape& light = add_black(world, glm::dvec3(radiance));
  add_quad(light.mesh, origin, {0, height, 0}, {width, 0, 0});
  return light;
}

WorldShape& add_quadric(World& world, Geometry geometry, glm::dvec3 x, glm::dvec3 y, glm::dvec3 z, glm::dvec3 base, glm::dvec3 radiance) {
  WorldShape& shape = add_black(world, radiance);
  shape.geometry = geometry;
  shape.to_world = glm::dmat4(glm::dvec4(x, 0), glm::dvec4(y, 0), glm::dvec4(z, 0), glm::dvec4(base, 1));
  return shape;
}

}  // namespace

TEST(light_image, rectangle_above_its_corner) {
  EXPECT_NEAR(corner_factor(1, 1), .138531605994892997, 1e-15);
  World world = floor_seen_from({-0.3, -0.4, 0.5});
  add_ceiling(world, {0, 0, 1}, 1, 1);
  expect_mean(render_full(world, 640), albedo * .138531605994892997);
}

// The mean, and the variance of one sample: it must be what the power heuristic gives with one sample of each strategy. With w the
// heuristic's weight and f the integrand, each strategy of density p has mean m = integral of w f and second moment integral of
// (w f)^2 / p. (Neither strategy alone does at all heights: the deviation relative to the mean is .17 by area and 1.8 by cosine at
// height 1, 33 and .018 at height .01.)
TEST(light_image, centred_square_light_from_touching_to_far_has_the_mean_and_variance_of_the_power_heuristic) {
  struct Case { double height, factor; };
  double worst = 0.0;
  for (const Case c : {Case{1, .239456470460773539}, {.1, 4 * corner_factor(5, 5)}, {.01, .999672786936447879}, {100, .0000318299276225599}}) {
    SCOPED_TRACE(c.height);
    World world = floor_seen_from(glm::dvec3{0.3, 0.2, 0.6} * std::min(c.height, 1.0), 1.0);
    add_ceiling(world, {-0.5, -0.5, c.height}, 1, 1);
    const Film film = render_full(world, 640);
    worst = std::max(worst, expect_mean(film, albedo * c.factor));

    // Midpoint rule over the light's area, 1; all densities per area.
    const int n = 2000;
    double mean[2] = {}, square[2] = {};
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        const double x = (i + 0.5) / n - 0.5, y = (j + 0.5) / n - 0.5, d2 = x * x + y * y + c.height * c.height;
        const double f = c.height * c.height / (pi * d2 * d2);  // cos cos / (pi d^2): also the density of cosine sampling
        const double density[2] = {1.0, f}, weights = 1.0 + f * f;
        for (int k = 0; k < 2; ++k) {
          const double wf = density[k] * density[k] / weights * f;
          mean[k] += wf / (n * n);
          square[k] += wf * wf / density[k] / (n * n);
        }
      }
    const double variance = square[0] - mean[0] * mean[0] + square[1] - mean[1] * mean[1];
    EXPECT_NEAR(relative_deviation(film), std::sqrt(variance) / c.factor, 0.02 * std::sqrt(variance) / c.factor + 1e-6);
  }
  record_extreme("X25", worst, z_limit);
}

TEST(light_image, disk_light) {
  World world = floor_seen_from({0.5, 0.4, 0.6});
  add_quadric(world, Geometry::disk, {.5, 0, 0}, {0, -.5, 0}, {0, 0, -.5}, {0, 0, 2}, glm::dvec3(1.0));
  expect_mean(render_full(world, 512), albedo * .25 / 4.25);
}

TEST(light_image, sphere_light_above_and_at_60_degrees) {
  for (const double degrees : {0.0, 60.0}) {
    SCOPED_TRACE(degrees);
    World world = floor_seen_from({-0.5, 0.4, 0.6});
    const double angle = glm::radians(degrees);
    add_quadric(world, Geometry::sphere, {.5, 0, 0}, {0, .5, 0}, {0, 0, .5}, {2 * std::sin(angle), 0, 2 * std::cos(angle)}, glm::dvec3(1.0));
    expect_mean(render_full(world, 512), albedo * std::pow(0.5 / 2.0, 2) * std::cos(angle));
  }
}

// The half of the sphere above the horizon: its directions project onto a segment of the unit disk, of half angle
// asin(R / d) = 30 degrees.
TEST(light_image, sphere_light_cut_by_the_horizon) {
  World world = floor_seen_from({-0.3, 0.1, 0.5});
  add_quadric(world, Geometry::sphere, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {2, 0, 0}, glm::dvec3(1.0));
  const double half = pi / 6.0;
  expect_mean(render_full(world, 4800), radiance(half - std::sin(half) * std::cos(half)));
}

// From within 1.0001 radii a sphere is sampled by area and no longer by its cone. E = pi (R / d)^2.
TEST(light_image, sphere_light_that_almost_touches) {
  for (const double distance : {1.00004, 1.001}) {
    SCOPED_TRACE(distance);
    World world = floor_seen_from({0.9, 0.0, 0.006}, 2.0);  // below the sphere: .006 x / .9 < x^2 / 2 + 4e-5
    add_quadric(world, Geometry::sphere, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, distance}, glm::dvec3(1.0));
    expect_mean(render_full(world, 512), albedo / (distance * distance));
  }
}

TEST(light_image, triangle_light) {
  World world = floor_seen_from({-0.5, -0.4, 0.6});
  WorldShape& light = add_black(world, glm::dvec3(1.0));
  const glm::dvec3 a(.2, .1, 1), b(1.2, .3, .8), c(.4, 1.1, 1.5);
  add_triangle(light.mesh, a, c, b);
  ASSERT_LT(glm::dot(glm::cross(c - a, b - a), a), 0.0);  // it faces the origin
  expect_mean(render_full(world, 640), radiance(.166471501963519918));
}

// Lateral distance in the direction of one axis; E = I h / (h^2 + d^2)^1.5. No noise: the light has no extent.
TEST(light_image, point_light) {
  struct Case { double height, distance, irradiance; };
  for (const Case c : {Case{1, 1, .353553390593274}, {2, 3, .0426692458634792}}) {
    World world = floor_seen_from({-0.5, -0.4, 0.6});
    add_light(world, LIGHT_POINT, glm::dvec3(1.0), {0.6 * c.distance, 0.8 * c.distance, c.height});
    const Film film = render_full(world, 16);
    expect_every_sample(film, radiance(c.irradiance), 1e-4);  // the view's extent of 1e-5
    expect_mean(film, radiance(c.irradiance), 1e-6);
  }
}

// The film's units follow what arrives, not the intensity: at 2^30 times the scene's size that is 2^60 times as much. cos = 1.
TEST(light_image, point_light_however_far_away) {
  for (const double distance : {1.0, 0x1p10, 0x1p20, 0x1p25, 0x1p30, 0x1p60}) {
    World world = floor_seen_from({-0.5, -0.4, 0.6});
    add_light(world, LIGHT_POINT, glm::dvec3(distance * distance), {0, 0, distance});
    expect_every_sample(render_full(world, 16), radiance(1.0), 1e-6);
  }
}

TEST(light_image, directional_light) {
  World world = floor_seen_from({-0.5, -0.4, 0.6});
  add_light(world, LIGHT_DIRECTIONAL, glm::dvec3(3.0), glm::normalize(glm::dvec3(1, 2, -2)));
  expect_every_sample(render_full(world, 16), radiance(3.0 * 2.0 / 3.0), 1e-6);
  world.lights[0].position = glm::normalize(glm::dvec3(1, 2, 0.01));  // from below
  EXPECT_EQ(estimate(render_full(world, 16)).mean, 0.0);
}

// Rounding must not let a triangle shade its neighbour across a shared edge: all samples lie within 1e-6 of the diagonal of a
// plane that lies in any way to the axes.
TEST(light_image, points_on_a_shared_edge_are_fully_lit) {
  for (const double tilt : {0.0, 0.3})
    for (const double height : {0.0, 0.1})
      for (const double elevation : {1.5, 0.3, 0.03}) {
        SCOPED_TRACE(testing::Message() << tilt << " " << height << " " << elevation);
        const glm::dvec3 x(std::cos(tilt), 0, std::sin(tilt)), y(0, 1, 0), normal = glm::cross(x, y), base(0, 0, height);
        World world;
        add_quad(add_shape(world, diffuse(albedo), Sides::front).mesh, base - x - y, 2.0 * x, 2.0 * y);
        for (const double z : {-1.0, 1.0}) add_quad(add_black(world).mesh, {-0.9, 0.9, z}, {0.1, 0, 0}, {0, 0.1, 0});  // height 0 is 0 in the frame
        const glm::dvec3 to_light = std::cos(elevation) * (0.8 * x - 0.6 * y) + std::sin(elevation) * normal;
        add_light(world, LIGHT_DIRECTIONAL, glm::dvec3(1.0), -to_light);
        look_closely(world, base + normal, base);
        world.camera.tan_half_fov_x = 1e-6;
        world.integrator.max_depth = 2;
        expect_every_sample(render_full(world, 64), radiance(std::sin(elevation)), 1e-5);
      }
}

// Light from where the camera is: what it sees of a convex body is lit, up to the silhouette, in every sample. One dark dot would be
// the shadow of the body on itself, one bright dot in the shadow behind it a leak.
TEST(light_image, convex_bodies_never_shade_themselves_and_never_leak) {
  for (const int body : {0, 1, 2, 3})
    for (const LightKind kind : {LIGHT_POINT, LIGHT_DIRECTIONAL}) {
      SCOPED_TRACE(testing::Message() << body << " " << kind);
      World world;
      WorldShape& shape = add_shape(world, diffuse(albedo), Sides::front);
      if (body == 0) shape.mesh = icosphere(5, 0.0, 1);
      if (body == 1) add_box(shape.mesh, {-0.6, -0.7, -0.5}, {0.6, 0.3, 0.8});
      if (body == 2) shape.geometry = Geometry::sphere;
      if (body == 3) {
        shape.geometry = Geometry::cylinder;
        shape.to_world = glm::dmat4({.5, 0, 0, 0}, {0, .5, 0, 0}, {0, 0, 1, 0}, {0, 0, -.5, 1});
      }
      const glm::dvec3 eye(3.0, 1.8, 2.4);
      add_light(world, kind, glm::dvec3(1.0), kind == LIGHT_POINT ? eye : -glm::normalize(eye));
      look(world, eye, {0, 0, 0}, {0, 0, 1}, 0.3, 384, 384);
      world.integrator.max_depth = 2;
      const auto dark_and_bright = [&] {
        const Film film = render_full(world, 1);
        std::array<int, 2> count{};
        for (const FilmPixel& pixel : film.pixels)
          if (pixel.hits > 0) ++count[pixel.sum[0][0] != 0 || pixel.sum[0][1] != 0];
        return count;
      };
      const auto lit = dark_and_bright();
      // Through the cylinder's open end the camera sees the inside, which is black.
      EXPECT_TRUE(lit[0] == 0 || body == 3) << lit[0];
      EXPECT_GT(lit[1], 15000);
      world.lights[0].position = kind == LIGHT_POINT ? -eye : glm::normalize(eye);  // from behind
      const auto unlit = dark_and_bright();
      EXPECT_EQ(unlit[1], 0);
      EXPECT_GT(unlit[0], 15000);
    }
}

// The open plane sees light from its whole half space.
TEST(light_image, constant_light_on_an_open_plane_gives_the_albedo) {
  World world = floor_seen_from({-0.5, -0.4, 0.6});
  add_light(world, LIGHT_CONSTANT, glm::dvec3(1.0));
  expect_mean(render_full(world, 512), albedo);
}

// The point lies before the middle of the axis of a cylinder of finite length. Quadrature over the visible part of the
// cylinder's surface by the midpoint rule.
TEST(light_image, cylinder_light) {
  const double r = 0.3, length = 2.0, distance = 1.0, z0 = -0.7;
  World world = floor_seen_from({-0.5, 0.4, 0.6});
  add_quadric(world, Geometry::cylinder, {0, r, 0}, {0, 0, r}, {length, 0, 0}, {z0, 0, distance}, glm::dvec3(1.0));
  const double visible = std::acos(r / distance);
  const int n = 2000;
  double sum = 0.0;
  for (int i = 0; i < n; ++i) {
    const double phi = ((i + 0.5) / n * 2.0 - 1.0) * visible;
    const glm::dvec3 normal(0, std::sin(phi), -std::cos(phi));
    for (int j = 0; j < n; ++j) {
      const glm::dvec3 p(z0 + (j + 0.5) / n * length, r * normal.y, distance + r * normal.z);
      const double d2 = glm::dot(p, p);
      sum += p.z * -glm::dot(normal, p) / (d2 * d2);
    }
  }
  expect_mean(render_full(world, 4096), radiance(sum * (2.0 * visible / n) * r * (length / n)));
}

// For an endless cylinder it is the same as for an endless strip of the same apparent width: E = pi R / d.
TEST(light_image, long_cylinder_light) {
  World world = floor_seen_from({-0.5, 0.4, 0.6});
  add_quadric(world, Geometry::cylinder, {0, .25, 0}, {0, 0, .25}, {200, 0, 0}, {-100, 0, 1}, glm::dvec3(1.0));
  const Film film = render_full(world, 6000);
  expect_mean(film, albedo * 0.25, 0.01);  // the ends beyond 100 take away less than 1e-6
}

// One light cut into 2000 triangles of all sizes, every other one without area, is still the same light.
TEST(light_image, mesh_light_of_many_triangles_some_of_them_degenerate) {
  World world = floor_seen_from({-0.3, -0.4, 0.5});
  WorldShape& light = add_black(world, glm::dvec3(1.0));
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<double> cut{0.0, 1.0};
  for (int i = 0; i < 999; ++i) cut.push_back(std::pow(uniform(random), 3));
  std::sort(cut.begin(), cut.end());
  for (std::size_t i = 0; i + 1 < cut.size(); ++i) {
    const glm::dvec3 p(cut[i], 0, 1);
    add_triangle(light.mesh, p, p, p + glm::dvec3(0, 1, 0));
    add_quad(light.mesh, p, {0, 1, 0}, {cut[i + 1] - cut[i], 0, 0});
    add_triangle(light.mesh, p, p + glm::dvec3(0, 0.5, 0), p + glm::dvec3(0, 1, 0));
  }
  expect_mean(render_full(world, 640), albedo * .138531605994892997);
}

// A strong light behind a wall, and in a second picture not hidden: the weak one, chosen once in 10^6 times, stays right because
// scattering finds it as well.
TEST(light_image, weak_light_beside_one_a_million_times_stronger) {
  for (const bool hidden : {true, false}) {
    SCOPED_TRACE(hidden);
    World world = floor_seen_from({0.02, 0.03, 0.05});
    add_ceiling(world, {-0.5, -0.5, 0.1}, 1, 1).radiance = glm::dvec3(0, 0, 1);
    WorldShape& strong = add_black(world, {1e6, 0, 0});
    add_quad(strong.mesh, {-2, 1, 0}, {4, 0, 0}, {0, 0, 1});  // faces -y
    if (hidden) {
      WorldShape& wall = add_black(world);
      add_quad(wall.mesh, {-2, 0.9, -0.1}, {4, 0, 0}, {0, 0, 2});
    }
    const Film film = render_full(world, 1024);
    expect_mean(film, albedo * 4.0 * corner_factor(5, 5), 0.005, 2);
    if (hidden) EXPECT_EQ(estimate(film, 0).mean, 0.0);
    else EXPECT_GT(estimate(film, 0).mean, 0.0);
  }
}

// Seen and seeing from the front only.
TEST(light_image, lights_emit_on_their_front_side_alone) {
  for (const bool front : {true, false}) {
    World world = floor_seen_from({-0.3, -0.4, 0.5});
    WorldShape& rectangle = add_black(world, glm::dvec3(1.0));
    if (front) add_quad(rectangle.mesh, {0, 0, 1}, {0, 1, 0}, {1, 0, 0});
    else add_quad(rectangle.mesh, {0, 0, 1}, {1, 0, 0}, {0, 1, 0});
    add_quadric(world, Geometry::disk, {.2, 0, 0}, {0, front ? -.2 : .2, 0}, {0, 0, front ? -1.0 : 1.0}, {-0.4, 0, 0.8}, glm::dvec3(1.0));
    add_quadric(world, Geometry::sphere, {.2, 0, 0}, {0, .2, 0}, {0, 0, .2}, {0.4, -0.4, 0.8}, glm::dvec3(1.0)).flip_normals = !front;
    add_quadric(world, Geometry::cylinder, {.1, 0, 0}, {0, .1, 0}, {0, 0, .2}, {0.4, 0.4, 0.8}, glm::dvec3(1.0)).flip_normals = !front;
    const Film film = render_full(world, 64);
    if (front) EXPECT_GT(estimate(film).mean, 0.1);
    else {
      EXPECT_LT(estimate(film).mean, 0.02);  // the inside of the open cylinder, which the light leaves through its end
    }
  }
  for (const double z : {1.0, -1.0}) {
    World world;
    add_quad(add_black(world, glm::dvec3(0.1, 1.0, 7.0)).mesh, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
    look_closely(world, {0.1, 0.2, z}, {0, 0, 0});
    expect_every_sample(render_full(world, 2), z > 0.0 ? 7.0 : 0.0, 0.0, 2);
  }
}

// The inside of a closed shell that emits outwards is black; of one that emits inwards the floor below is.
TEST(light_image, closed_shell_does_not_shine_through) {
  for (const Geometry geometry : {Geometry::sphere, Geometry::mesh}) {
    World world = floor_seen_from({-0.1, -0.1, 0.15}, 0.2);
    WorldShape& shell = add_black(world, glm::dvec3(1.0));
    shell.geometry = geometry;
    if (geometry == Geometry::mesh) add_box(shell.mesh, {-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5});
    else shell.to_world = glm::dmat4(0.5);
    shell.to_world[3][3] = 1.0;
    EXPECT_EQ(estimate(render_full(world, 512)).mean, 0.0);
  }
}

TEST(light_image, back_of_a_twosided_surface_is_its_front_and_of_a_onesided_one_black) {
  for (const Sides sides : {Sides::both, Sides::front}) {
    World world;
    WorldShape& plane = add_shape(world, diffuse(albedo), sides);
    add_quad(plane.mesh, {-0.5, -0.5, 0}, {0, 1, 0}, {1, 0, 0});  // faces down
    add_ceiling(world, {0, 0, 1}, 1, 1);
    look_closely(world, {-0.3, -0.4, 0.5}, {0, 0, 0});
    world.integrator.max_depth = 2;
    const Film film = render_full(world, 640);
    if (sides == Sides::both) expect_mean(film, albedo * .138531605994892997);
    else EXPECT_EQ(estimate(film).mean, 0.0);
  }
}

namespace {

Film render_with(Approximations approximations, const World& world, uint samples) {
  Scene scene = place_scene(world);
  scene.features = every_feature;
  scene.approximations = approximations;
  return render_scene(std::move(scene), samples);
}

constexpr Approximations strategies[] = {0, APPROXIMATION_BSDF_SAMPLING};

}  // namespace

// Deviation of a sample, over the mean: cosine sampling alone hits the light with a probability of the form factor F and has
// the albedo then, sqrt(1 / F - 1).
TEST(light_image, without_light_sampling_the_mean_is_the_same_and_the_variance_that_of_cosine_sampling) {
  World world = floor_seen_from({-0.3, -0.4, 0.5});
  add_ceiling(world, {0, 0, 1}, 1, 1);
  const double factor = corner_factor(1, 1), deviation = std::sqrt(1.0 / factor - 1.0);
  const Film film = render_with(APPROXIMATION_BSDF_SAMPLING, world, 1024);
  expect_mean(film, albedo * factor, 0.02);
  EXPECT_NEAR(relative_deviation(film), deviation, 0.02 * deviation);
  EXPECT_LT(relative_deviation(render_with(0, world, 1024)), 0.5 * deviation);
}

TEST(light_image, each_strategy_finds_spheres_surroundings_and_lights_without_extent) {
  World sphere = floor_seen_from({-0.5, 0.4, 0.6}), sky = sphere, point = sphere, both = sphere;
  add_quadric(sphere, Geometry::sphere, {.5, 0, 0}, {0, .5, 0}, {0, 0, .5}, {0, 0, 2}, glm::dvec3(1.0));
  add_light(sky, LIGHT_CONSTANT, glm::dvec3(1.0));
  add_light(point, LIGHT_POINT, glm::dvec3(1.0), {0, 0, 2});
  add_light(both, LIGHT_CONSTANT, glm::dvec3(1.0));
  add_light(both, LIGHT_POINT, glm::dvec3(1.0), {0, 0, 2});
  for (const Approximations strategy : strategies) {
    SCOPED_TRACE(strategy);
    expect_mean(render_with(strategy, sphere, 2048), albedo / 16.0, 0.03);
    expect_mean(render_with(strategy, sky, 512), albedo, 0.02);
    expect_mean(render_with(strategy, point, 16), radiance(0.25));
    expect_mean(render_with(strategy, both, 512), albedo + radiance(0.25), 0.02);
  }
}

// Paths that come straight from the camera or from a mirror see a light that no strategy has counted.
TEST(light_image, each_strategy_shows_lights_themselves_and_in_mirrors) {
  World seen;
  add_quad(add_black(seen, glm::dvec3(3.0)).mesh, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
  look_closely(seen, {0, 0, 2}, {0, 0, 0});
  World mirrored;
  add_quad(add_shape(mirrored, mirror(0.9), Sides::front).mesh, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
  add_light(mirrored, LIGHT_CONSTANT, glm::dvec3(2.0));
  look_closely(mirrored, {0.2, 0.1, 2}, {0, 0, 0});
  mirrored.integrator.rr_depth = no_roulette;
  for (const Approximations strategy : strategies) {
    SCOPED_TRACE(strategy);
    expect_every_sample(render_with(strategy, seen, 16), 3.0, 8 * unit_roundoff);
    expect_every_sample(render_with(strategy, mirrored, 16), 1.8, 8 * unit_roundoff);
  }
}

// Without noise the mean of min(L, c) is min(L, c), in the hue of L: each channel by the factor of the largest.
TEST(light_image, clamped_light_is_the_lesser_of_its_radiance_and_the_limit) {
  World world;
  add_quad(add_black(world, {4.0, 2.0, 1.0}).mesh, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
  look_closely(world, {0, 0, 2}, {0, 0, 0});
  for (const float limit : {1e-3f, 0.5f, 2.0f, 3.9f, 4.0f, 5.0f}) {
    SCOPED_TRACE(limit);
    Scene scene = place_scene(world);
    scene.features = every_feature;
    scene.approximations = APPROXIMATION_CLAMP;
    scene.settings.largest_sample = limit;
    const Film film = render_scene(std::move(scene), 16);
    for (int channel = 0; channel < 3; ++channel)
      expect_every_sample(film, std::min(4.0, static_cast<double>(limit)) / (1 << channel), 8 * unit_roundoff, channel);
  }
}
