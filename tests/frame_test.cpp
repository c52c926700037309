// The canonical frame and the boxes of quadrics.
#include "extremes.h"
#include "random.h"
#include "worlds.h"

using namespace oclair;
using namespace oclair::test;

namespace {

WorldShape quadric(Geometry geometry, Random& random, double r, const glm::dvec3& center) {
  WorldShape shape;
  shape.geometry = geometry;
  const glm::dvec3 z = random.direction(), x = glm::normalize(glm::cross(random.direction(), z)), y = glm::cross(z, x);
  const double h = geometry == Geometry::sphere ? 1.0 : random.between(0.2, 3.0);
  shape.to_world = glm::dmat4(glm::dvec4(r * x, 0), glm::dvec4(r * y, 0), glm::dvec4(r * h * z, 0), glm::dvec4(center, 1));
  return shape;
}

// Meshes, quadrics, lights of every kind and a camera; a dyadic scale and a shift that double holds exactly.
World everything(int power, const glm::dvec3& shift) {
  Random random(1);
  World world;
  const double s = std::ldexp(1.0, power);
  add_shape(world, diffuse(0.5), Sides::both).mesh = icosphere(2, 0.1, 3);
  add_box(add_shape(world, diffuse(0.2), Sides::both, 3.0).mesh, {-0.3, -0.2, -0.1}, {0.1, 0.4, 0.3});
  for (const Geometry g : {Geometry::sphere, Geometry::disk, Geometry::cylinder}) {
    WorldShape& shape = add_shape(world, mirror(0.9), Sides::both, g == Geometry::disk ? 1.0 : 0.0);
    const uint front = shape.material_front, back = shape.material_back;
    const auto radiance = shape.radiance;
    shape = quadric(g, random, 0.2, 0.5 * random.in_cube());
    shape.material_front = front, shape.material_back = back, shape.radiance = radiance;
  }
  // Dyadic to 2^-20, so that the shift loses nothing.
  const auto dyadic = [](double x) { return std::ldexp(std::round(std::ldexp(x, 20)), -20); };
  for (WorldShape& shape : world.shapes) {
    for (glm::dvec3& p : shape.mesh.positions) p = s * (glm::dvec3(dyadic(p.x), dyadic(p.y), dyadic(p.z)) + shift);
    glm::dvec3 at(shape.to_world[3]);
    at = glm::dvec3(dyadic(at.x), dyadic(at.y), dyadic(at.z)) + shift;
    shape.to_world = glm::dmat4(shape.to_world[0] * s, shape.to_world[1] * s, shape.to_world[2] * s, glm::dvec4(s * at, 1));
  }
  world.lights.push_back({LIGHT_POINT, s * s * glm::dvec3(1, 2, 3), s * (glm::dvec3(2, -1, 0.5) + shift)});
  world.lights.push_back({LIGHT_DIRECTIONAL, {1, 1, 1}, {0, 0.6, -0.8}});
  world.lights.push_back({LIGHT_CONSTANT, {0.5, 0.25, 0.125}, {}});
  look(world, {0.5, 0.25, -2}, {0, 0, 0}, {0, 1, 0}, 0.5, 32, 24);
  world.camera.to_world[3] = glm::dvec4(s * (glm::dvec3(0.5, 0.25, -2) + shift), 1);
  world.camera.near_clip = s * 0.01;
  world.camera.far_clip = s * 100.0;
  return world;
}

template <class T, class Allocator>
bool same(const std::vector<T, Allocator>& a, const std::vector<T, Allocator>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

void expect_same(const World& a, const World& b, const std::string& what) {
  const Scene x = place_scene(a), y = place_scene(b);
  EXPECT_TRUE(same(x.positions, y.positions)) << what;
  EXPECT_TRUE(same(x.triangles, y.triangles)) << what;
  EXPECT_TRUE(same(x.quadrics, y.quadrics)) << what;
  EXPECT_TRUE(same(x.shapes, y.shapes)) << what;
  EXPECT_TRUE(same(x.triangle_shape, y.triangle_shape)) << what;
  EXPECT_TRUE(same(x.lights, y.lights)) << what;
  EXPECT_TRUE(same(x.light_cdf, y.light_cdf)) << what;
  EXPECT_EQ(std::memcmp(&x.camera, &y.camera, sizeof(Camera)), 0) << what;
  EXPECT_EQ(x.features, y.features) << what;
  EXPECT_EQ(x.settings.film_exponent, y.settings.film_exponent) << what;
}

}  // namespace

// The power of two is the one that brings the half-extent into [1/2, 1); the centre is that of the box.
TEST(frame_test, the_largest_half_extent_lies_between_one_half_and_one) {
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    World world;
    const double magnitude = random.log_between(1e-12, 1e12);
    const glm::dvec3 low = magnitude * random.in_cube(), size = magnitude * random.log_between(1e-6, 1e6) * (glm::abs(random.in_cube()) + 1e-3);
    add_box(add_shape(world, diffuse(0.5), Sides::both).mesh, low, low + size);
    const CanonicalFrame frame = canonical_frame(world);
    glm::dvec3 least(1e30), most(-1e30);
    for (const glm::dvec3& p : world.shapes[0].mesh.positions) least = glm::min(least, frame.place(p)), most = glm::max(most, frame.place(p));
    const glm::dvec3 extent = most - least;
    const double half = 0.5 * std::max({extent.x, extent.y, extent.z});
    EXPECT_GE(half, 0.5);
    EXPECT_LT(half, 1.0);
    // Centred to the rounding of the coordinates themselves.
    const double rounding = 0x1p-50 * std::ldexp(glm::length(low) + glm::length(size), -frame.exponent);
    EXPECT_LE(glm::length(most + least), rounding);
    EXPECT_EQ(frame.place_length(3.0), std::ldexp(3.0, -frame.exponent));
  }
}

TEST(frame_test, points_of_no_triangle_do_not_count) {
  World world;
  Mesh& mesh = add_shape(world, diffuse(0.5), Sides::both).mesh;
  add_box(mesh, {-1, -1, -1}, {1, 1, 1});
  mesh.positions.emplace_back(1e6, 0, 0);
  EXPECT_EQ(canonical_frame(world).exponent, 1);
}

TEST(frame_test, without_extent_the_frame_keeps_the_lengths) {
  EXPECT_EQ(canonical_frame(World{}).exponent, 0);
  EXPECT_EQ(canonical_frame(World{}).center, glm::dvec3(0.0));
  World point;
  add_triangle(add_shape(point, diffuse(0.5), Sides::both).mesh, {5, 6, 7}, {5, 6, 7}, {5, 6, 7});
  EXPECT_EQ(canonical_frame(point).exponent, 0);
  EXPECT_EQ(canonical_frame(point).center, glm::dvec3(5, 6, 7));
}

// Extreme X11.
TEST(frame_test, scaling_by_a_power_of_two_or_an_exact_shift_changes_no_bit_of_the_scene) {
  const World plain = everything(0, glm::dvec3(0.0));
  for (const int power : {-40, -20, -1, 1, 20, 40}) expect_same(plain, everything(power, glm::dvec3(0.0)), "scale " + std::to_string(power));
  // The mesh's box decides: its coordinates and the shift are dyadic, so that centre and differences are exact.
  expect_same(plain, everything(0, glm::dvec3(1048576.0, -65536.0, 4096.0)), "shift");
  expect_same(plain, everything(-20, glm::dvec3(1024.0, -65536.0, 4096.0)), "both");
  record_law("X11");
}

TEST(frame_test, the_box_of_a_quadric_holds_it_and_touches_it) {
  Random random(3);
  for (int i = 0; i < 300; ++i) {
    const Geometry g = i % 3 == 0 ? Geometry::sphere : i % 3 == 1 ? Geometry::disk : Geometry::cylinder;
    const WorldShape shape = quadric(g, random, random.log_between(1e-3, 1e3), 10.0 * random.in_cube());
    const Bounds box = quadric_bounds(g, shape.to_world);
    Bounds sampled;
    const int n = 100;
    for (int a = 0; a <= n; ++a)
      for (int b = 0; b <= n; ++b) {
        const double phi = 2 * std::acos(-1.0) * a / n, v = static_cast<double>(b) / n, z = 2 * v - 1, r = std::sqrt(1 - z * z);
        glm::dvec4 q(r * std::cos(phi), r * std::sin(phi), z, 1);
        if (g == Geometry::disk) q = {v * std::cos(phi), v * std::sin(phi), 0, 1};
        if (g == Geometry::cylinder) q = {std::cos(phi), std::sin(phi), v, 1};
        sampled.include(glm::dvec3(shape.to_world * q));
      }
    const glm::dvec3 size = box.high - box.low;
    const double largest = std::max({size.x, size.y, size.z});
    for (int k = 0; k < 3; ++k) {
      EXPECT_LE(box.low[k], sampled.low[k] + 1e-13 * largest);
      EXPECT_GE(box.high[k], sampled.high[k] - 1e-13 * largest);
      // An extreme lies within half a step of a sample: cos(pi / n) = 1 - 5e-4, in both parameters.
      EXPECT_NEAR(box.low[k], sampled.low[k], 2e-3 * largest);
      EXPECT_NEAR(box.high[k], sampled.high[k], 2e-3 * largest);
    }
  }
}
