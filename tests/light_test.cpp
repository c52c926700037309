// Choosing lights, and the value and density of light samples against closed forms.
#include <functional>

#include "../host/distribution.h"
#include "extremes.h"
#include "lights.h"

using namespace oclair;
using namespace oclair::test;

namespace {

const double pi = std::acos(-1.0);

std::vector<cl_uint> choose(const std::vector<uint>& cdf, const std::vector<cl_uint>& bits) {
  std::vector<cl_uint> which(bits.size());
  run("light_test.cl", "choose", bits.size(), cdf, static_cast<cl_uint>(cdf.size()), bits, out(which));
  return which;
}

// The first light whose entry lies above; the last entry counts as 2^32.
cl_uint expected_choice(const std::vector<uint>& cdf, cl_uint bits) {
  for (std::size_t i = 0; i + 1 < cdf.size(); ++i)
    if (bits < cdf[i]) return static_cast<cl_uint>(i);
  return static_cast<cl_uint>(cdf.size() - 1);
}

Scene lit_scene(const std::function<void(World&)>& add) {
  World world;
  add_frame_box(world);
  add(world);
  Scene scene = place_scene(world);
  EXPECT_EQ(scene.frame.exponent, 1);
  return scene;
}

// a x b above the origin at height h, its front downwards, corner above the origin or centred; in world units.
void add_rect(World& world, double a, double b, double h, bool centred, double radiance = 1.0) {
  const glm::dvec3 corner(centred ? -a / 2 : 0.0, centred ? -b / 2 : 0.0, h);
  add_quad(add_shape(world, diffuse(0.0), Sides::both, radiance).mesh, corner, {0, b, 0}, {a, 0, 0});
}

WorldShape& add_quadric(World& world, Geometry geometry, const glm::dvec3& x, const glm::dvec3& y, const glm::dvec3& z, const glm::dvec3& center) {
  WorldShape& shape = add_shape(world, diffuse(0.0), Sides::both, 1.0);
  shape.geometry = geometry;
  shape.to_world = glm::dmat4(glm::dvec4(x, 0), glm::dvec4(y, 0), glm::dvec4(z, 0), glm::dvec4(center, 1));
  return shape;
}

}  // namespace

TEST(light_test, selection_follows_the_distribution_at_every_boundary) {
  for (const std::vector<uint>& cdf : {std::vector<uint>{0xffffffffu}, {1u, 0xffffffffu}, {0u, 5u, 5u, 5u, 1000u, 0xfffffffeu, 0xffffffffu},
                                       {7u, 7u, 0xffffffffu}, {0x80000000u, 0x80000001u, 0xffffffffu, 0xffffffffu}}) {
    std::vector<cl_uint> bits = {0u, 0xffffffffu, 0xfffffffeu};
    for (const uint entry : cdf) bits.insert(bits.end(), {entry - 1, entry, entry + 1});
    const std::vector<cl_uint> which = choose(cdf, bits);
    for (std::size_t i = 0; i < bits.size(); ++i) EXPECT_EQ(which[i], expected_choice(cdf, bits[i])) << bits[i];
  }
}

TEST(light_test, every_light_is_reached_at_both_ends_of_its_interval) {
  Random random(1);
  std::vector<double> weights(count_or_small(5000, 50));
  for (double& w : weights) w = random.log_between(1e-20, 1e20);
  const std::vector<uint> cdf = distribution(weights);
  std::vector<cl_uint> bits;
  for (std::size_t i = 0; i < cdf.size(); ++i) bits.insert(bits.end(), {i == 0 ? 0u : cdf[i - 1], i + 1 < cdf.size() ? cdf[i] - 1 : 0xffffffffu});
  const std::vector<cl_uint> which = choose(cdf, bits);
  for (std::size_t i = 0; i < which.size(); ++i) EXPECT_EQ(which[i], i / 2);
}

// Entries within one unit of the exact sums (n units are set aside, one a light), order kept, at least one unit each.
TEST(light_test, the_distribution_is_proportional_with_at_least_one_unit_each) {
  Random random(2);
  std::vector<std::vector<double>> tables = {{1.0}, {1.0, 1.0}, {1e-300, 1e300, 1e-300}, {5e-324, 1.0}, {1.0, 2.0, 4.0, 9.0}};
  tables.emplace_back(count_or_small(1000000, 100), 1.0);
  tables.emplace_back();
  for (std::size_t i = 0; i < count_or_small(1000000, 100); ++i) tables.back().push_back(random.log_between(1e-12, 1e12));
  for (const std::vector<double>& weights : tables) {
    const std::vector<uint> cdf = distribution(weights);
    ASSERT_EQ(cdf.size(), weights.size());
    long double total = 0, sum = 0;
    for (double w : weights) total += w;
    EXPECT_GE(cdf[0], 1u);
    EXPECT_EQ(cdf.back(), 0xffffffffu);
    std::size_t wrong = 0;
    for (std::size_t i = 0; i + 1 < cdf.size(); ++i) {
      sum += weights[i];
      const auto n = static_cast<long double>(weights.size());
      const long double exact = sum / total * (4294967296.0L - n) + static_cast<long double>(i + 1);
      wrong += std::abs(cdf[i] - exact) > 1.0L + 1e-3L || (i > 0 && cdf[i] <= cdf[i - 1]);
    }
    EXPECT_EQ(wrong, 0u) << weights.size();
  }
}

TEST(light_test, probabilities_are_the_widths_of_the_intervals_and_proportional_to_flux) {
  const Scene scene = lit_scene([](World& world) {
    add_rect(world, 0.5, 0.25, 0.5, true, 3.0);
    add_quadric(world, Geometry::sphere, {0.1, 0, 0}, {0, 0.1, 0}, {0, 0, 0.1}, {0.5, 0.5, 0.5});
    world.lights.push_back({LIGHT_POINT, glm::dvec3(2.0), {0.1, 0.2, 0.3}});
    world.lights.push_back({LIGHT_CONSTANT, glm::dvec3(0.25), {}});
    world.lights.push_back({LIGHT_DIRECTIONAL, glm::dvec3(0.5), {0, 0, -1}});
  });
  ASSERT_EQ(scene.lights.size(), 6u);
  // Canonical lengths are half of the world's: areas and intensities a quarter.
  const double flux[] = {pi * 3 * 0.0625 / 4, pi * 3 * 0.0625 / 4, pi * 4 * pi * 0.01 / 4, 4 * pi * 2.0 / 4, 4 * pi * pi * 3 * 0.25, pi * 3 * 0.5};
  double total = 0, below = 0;
  for (double f : flux) total += f;
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(scene.lights[i].probability, flux[i] / total, 2 * unit_roundoff);
    const double end = i < 5 ? scene.light_cdf[i] * 0x1p-32 : 1.0;
    EXPECT_EQ(scene.lights[i].probability, static_cast<float>(end - below));
    below = end;
  }
  EXPECT_EQ(scene.settings.environment_probability, scene.lights[4].probability);
  EXPECT_EQ(scene.settings.light_count, 6u);
}

// Closed forms for Le = 1, receiver at the origin facing +z. The midpoint rule on n x n points errs by the integrand's curvature,
// ~ (L / (n h))^2 for a light of size L at height h; float32 adds ~ 1e-6.
TEST(light_test, irradiance_of_rectangles_is_the_form_factor) {
  struct Row {
    double a, b, h, factor;
    bool centred;
    std::size_t n;
  };
  // Coordinates within the frame box: sizes and heights scaled by s, which the form factor does not see.
  for (const Row& row : {Row{1, 1, 1, 0.138531605994892997, false, 256}, {1, 1, 1, 0.239456470460773539, true, 256}, {2, 2, 1, 0.554126423979571987, true, 512},
                         {1, 1, 0.01, 0.999672786936447879, true, 2048}, {0.01, 0.01, 1, 0.0000318299276225599, true, 16}}) {
    const double s = 0.5;
    const Scene scene = lit_scene([&](World& world) { add_rect(world, s * row.a, s * row.b, s * row.h, row.centred); });
    ASSERT_EQ(scene.lights.size(), 2u);
    const std::size_t n = count_or_small(row.n, 4);
    const double error = small_inputs() ? 1.0 : std::pow(row.a / row.h / static_cast<double>(n), 2) + 2e-6;
    EXPECT_NEAR(irradiance(scene, {0, 0, 0}, {0, 0, 1}, n) / pi, row.factor, error * row.factor) << row.a << " " << row.h;
    EXPECT_EQ(irradiance(scene, {0, 0, 0}, {0, 0, -1}, 4), 0.0);
    EXPECT_EQ(irradiance(scene, {0, 0, 0.45}, {0, 0, -1}, 4), 0.0);  // from behind
  }
}

TEST(light_test, irradiance_of_a_slanted_triangle_is_lamberts_sum) {
  const double s = 0.5;
  const Scene scene = lit_scene([&](World& world) {
    add_triangle(add_shape(world, diffuse(0.0), Sides::both, 1.0).mesh, s * glm::dvec3(.2, .1, 1), s * glm::dvec3(.4, 1.1, 1.5), s * glm::dvec3(1.2, .3, .8));
  });
  EXPECT_NEAR(irradiance(scene, {0, 0, 0}, {0, 0, 1}, count_or_small(512, 4)), 0.166471501963519918, small_inputs() ? 0.1 : 1e-6);
}

TEST(light_test, irradiance_of_disks_and_spheres_is_the_closed_form) {
  const double s = 0.4;
  const std::size_t n = count_or_small(256, 4);
  const double error = small_inputs() ? 0.2 : 1e-5;
  const Scene disk = lit_scene([&](World& world) { add_quadric(world, Geometry::disk, {0.5 * s, 0, 0}, {0, -0.5 * s, 0}, {0, 0, -s}, {0, 0, 2 * s}); });
  EXPECT_NEAR(irradiance(disk, {0, 0, 0}, {0, 0, 1}, n) / pi, 0.0588235294117647, error * 0.0588);
  const Scene sphere = lit_scene([&](World& world) { add_quadric(world, Geometry::sphere, {0.5 * s, 0, 0}, {0, 0.5 * s, 0}, {0, 0, 0.5 * s}, {0, 0, 2 * s}); });
  EXPECT_NEAR(irradiance(sphere, {0, 0, 0}, {0, 0, 1}, n) / pi, 0.0625, error * 0.0625);
  EXPECT_NEAR(irradiance(sphere, {0, 0, 0}, {std::sin(pi / 3), 0, 0.5}, n) / pi, 0.03125, error * 0.03125);
  // Inside a sphere that emits inwards every direction brings 1: E = pi, from anywhere. Outwards: nothing.
  for (const bool inwards : {true, false}) {
    const Scene inside = lit_scene([&](World& world) {
      add_quadric(world, Geometry::sphere, {0.9, 0, 0}, {0, 0.9, 0}, {0, 0, 0.9}, {0, 0, 0}).flip_normals = inwards;
    });
    for (const glm::dvec3& from : {glm::dvec3(0.0), glm::dvec3(0.1, 0.2, 0.3)})
      EXPECT_NEAR(irradiance(inside, from, {0, 0.6, 0.8}, count_or_small(1024, 4)) / pi, inwards ? 1.0 : 0.0, small_inputs() ? 0.5 : 1e-4);
  }
}

TEST(light_test, a_sphere_that_emits_inwards_brings_nothing_outside) {
  const Scene scene = lit_scene([](World& world) { add_quadric(world, Geometry::sphere, {0.3, 0, 0}, {0, 0.3, 0}, {0, 0, 0.3}, {0, 0, 0.6}).flip_normals = true; });
  for (const glm::dvec3& from : {glm::dvec3(0.0), glm::dvec3(0, 0, 0.149), glm::dvec3(0.3, 0.3, 0.3)}) EXPECT_EQ(irradiance(scene, from, {0, 0, 1}, 16), 0.0);
}

// The shadow ray ends on the receiver's side of the light's plane, so that what is coplanar with the light does not block it; and within
// 2e-6 of it. At grazing angles the rounding of the point along the ray exceeds the offset: cosines above .7.
TEST(light_test, shadow_rays_end_just_before_the_plane_of_the_light) {
  const Scene scene = lit_scene([](World& world) {
    add_triangle(add_shape(world, diffuse(0.0), Sides::both, 1.0).mesh, {.2, .1, .8}, {.4, .9, .5}, {.9, .3, .8});
  });
  const Light& light = scene.lights[0];
  const glm::dvec3 v0 = unpacked(light.position), n = glm::normalize(glm::cross(unpacked(light.edge1), unpacked(light.edge2)));
  std::size_t judged = 0;
  for (const glm::dvec3& from : {glm::dvec3(0.0), glm::dvec3(0.1, 0.1, -0.4), glm::dvec3(-0.2, -0.1, 0.1)})
    for (const LightResult& s : sample_light(scene, 0, from, random_squares(count_or_small(20000, 50), 4))) {
      const glm::dvec3 w = unpacked(s.direction), o = unpacked(packed(from));
      if (-glm::dot(w, n) < 0.7) continue;
      const double plane = glm::dot(v0 - o, n) / glm::dot(w, n);
      EXPECT_LT(s.distance, plane);
      EXPECT_GT(s.distance, plane - 2e-6);
      ++judged;
    }
  EXPECT_GT(judged, count_or_small(10000, 20));
}

// A closed cylinder with a lid and a base, all emitting inwards: E = pi.
TEST(light_test, irradiance_inside_an_emitting_can_is_pi) {
  const Scene can = lit_scene([](World& world) {
    add_quadric(world, Geometry::cylinder, {0.5, 0, 0}, {0, 0.5, 0}, {0, 0, 1.0}, {0, 0, -0.5}).flip_normals = true;
    add_quadric(world, Geometry::disk, {0.5, 0, 0}, {0, 0.5, 0}, {0, 0, 0.5}, {0, 0, -0.5});
    add_quadric(world, Geometry::disk, {0.5, 0, 0}, {0, -0.5, 0}, {0, 0, -0.5}, {0, 0, 0.5});
  });
  EXPECT_NEAR(irradiance(can, {0.05, -0.1, 0.08}, {0.48, 0.6, 0.64}, count_or_small(1024, 4)) / pi, 1.0, small_inputs() ? 0.5 : 1e-4);
}

// E = I h / (h^2 + d^2)^1.5 in world units; the intensity is placed in canonical ones.
TEST(light_test, lights_without_area_bring_their_closed_form_and_no_density) {
  const Scene scene = lit_scene([](World& world) { world.lights.push_back({LIGHT_POINT, glm::dvec3(5.0), {0.3, 0.4, 0.5}}); });
  const LightResult s = sample_light(scene, 0, {0, 0, 0}, {{0.3f, 0.7f}})[0];
  const double d2 = 0.5;  // world
  // The frame halves lengths: irradiance per canonical area is per world area, because the intensity was scaled too.
  EXPECT_NEAR(s.weight.x, 5.0 / d2, 8 * unit_roundoff * 5.0 / d2);
  EXPECT_NEAR(s.distance, 0.5 * std::sqrt(d2), 4 * unit_roundoff);
  EXPECT_LE(glm::length(unpacked(s.direction) - glm::dvec3(0.3, 0.4, 0.5) / std::sqrt(d2)), 6 * unit_roundoff);
  EXPECT_EQ(s.pdf, 0.0f);
  EXPECT_EQ(s.primitive, NONE);
  const LightResult at_the_light = sample_light(scene, 0, {0.15, 0.2, 0.25}, {{0.3f, 0.7f}})[0];
  EXPECT_TRUE(std::isfinite(at_the_light.weight.x) && std::isfinite(at_the_light.direction.x));

  const Scene sun = lit_scene([](World& world) { world.lights.push_back({LIGHT_DIRECTIONAL, {1, 2, 3}, {0, 0.6, -0.8}}); });
  const LightResult ray = sample_light(sun, 0, {0.1, 0.2, 0.3}, {{0.3f, 0.7f}})[0];
  EXPECT_EQ(ray.weight.y, 2.0f);
  EXPECT_EQ(ray.direction.y, -0.6f);
  EXPECT_EQ(ray.direction.z, 0.8f);
  EXPECT_EQ(ray.pdf, 0.0f);
  EXPECT_EQ(ray.distance, 1e30f);
}

TEST(light_test, the_constant_light_brings_its_radiance_from_everywhere) {
  const Scene scene = lit_scene([](World& world) { world.lights.push_back({LIGHT_CONSTANT, glm::dvec3(2.0), {}}); });
  EXPECT_NEAR(irradiance(scene, {0.1, 0.2, 0.3}, {0.6, 0, 0.8}, count_or_small(512, 4)), 2.0 * pi, small_inputs() ? 1.0 : 1e-4);
  for (const LightResult& s : sample_light(scene, 0, {0, 0, 0}, grid(8))) {
    EXPECT_NEAR(s.pdf, 1.0 / (4.0 * pi), 4 * unit_roundoff);
    EXPECT_EQ(s.distance, 1e30f);
    EXPECT_EQ(s.primitive, NONE);
  }
}

// Extreme X24.
TEST(light_test, triangles_without_area_change_nothing_about_a_mesh_light) {
  Random random(3);
  Mesh mesh, with_degenerate;
  for (int i = 0; i < 50; ++i) {
    const glm::dvec3 a = random.in_cube(0.5), b = random.in_cube(0.5), c = random.in_cube(0.5);
    add_triangle(with_degenerate, a, b, a);
    add_triangle(with_degenerate, a, b, c);
    add_triangle(mesh, a, b, c);
  }
  add_triangle(with_degenerate, {0, 0, 0}, {0, 0, 0}, {0, 0, 0});
  const auto scene_with = [&](const Mesh& m) { return lit_scene([&](World& world) { add_shape(world, diffuse(0.0), Sides::both, 1.0).mesh = m; }); };
  const Scene plain = scene_with(mesh), mixed = scene_with(with_degenerate);
  EXPECT_EQ(mixed.degenerate_primitives, 51u);
  ASSERT_EQ(mixed.lights.size(), plain.lights.size());
  EXPECT_EQ(std::memcmp(mixed.lights.data(), plain.lights.data(), plain.lights.size() * sizeof(Light)), 0);
  EXPECT_EQ(mixed.light_cdf, plain.light_cdf);
  const double both[] = {irradiance(plain, {0.3, 0.3, 0.3}, {0, 0, -1}, 8), irradiance(mixed, {0.3, 0.3, 0.3}, {0, 0, -1}, 8)};
  EXPECT_EQ(both[0], both[1]);
  EXPECT_GT(both[0], 0.0);
  record_law("X24");
}
