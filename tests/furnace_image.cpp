// Closed rooms and other renders whose radiance is known exactly (integrating spheres; extremes X29, X31).
#include "extremes.h"
#include "image.h"

using namespace oclair;
using namespace oclair::test;

namespace {

enum class Room { cube, rock, sphere };

WorldShape& add_room(World& world, Room room, const Material& material) {
  if (room == Room::sphere) {
    WorldShape& shape = add_sphere(world, material, Sides::front, {0.1, -0.2, 0.05}, 1.3, 1.0);
    shape.flip_normals = true;
    return shape;
  }
  WorldShape& shape = add_shape(world, material, Sides::front, 1.0);
  if (room == Room::cube) add_box(shape.mesh, {-1, -1, -1}, {1, 1, 1}, true);
  else {
    shape.mesh = icosphere(2, 0.2, 7);
    for (glm::uvec3& t : shape.mesh.triangles) std::swap(t.y, t.z);
  }
  return shape;
}

// The camera is inside, away from every symmetry; every wall emits 1.
World furnace(Room room, const Material& material, uint max_depth = std::numeric_limits<uint>::max()) {
  World world;
  add_room(world, room, material);
  look(world, {0.1, 0.2, 0.3}, {1, 0.5, 0.2}, {0, 1, 0}, 1.0, 32, 16);
  world.integrator.max_depth = max_depth;
  return world;
}

World furnace(Room room, double albedo, uint max_depth = std::numeric_limits<uint>::max()) {
  return furnace(room, diffuse(albedo), max_depth);
}

// A glass object of unit size in light that is 1 from everywhere; without Russian roulette every path ends with 1.
World glass(double eta, double tan_half_fov = 0.5) {
  World world;
  add_light(world, LIGHT_CONSTANT, glm::dvec3(1.0));
  add_shape(world, dielectric(eta), Sides::both);
  look(world, {0.4, 0.7, 3}, {0, 0, 0}, {0, 1, 0}, tan_half_fov, 32, 16);
  world.integrator.rr_depth = no_roulette;
  return world;
}

World glass_sphere(double eta) {
  World world = glass(eta);
  world.shapes[0].geometry = Geometry::sphere;
  return world;
}

// A path of n crossings rounds its weight 2 n times; fewer than one of 1e9 paths crosses 16 surfaces.
constexpr double glass_tolerance = 32 * unit_roundoff;

}  // namespace

// L = Le (1 - albedo^N) / (1 - albedo) after N segments.
TEST(furnace_image, closed_room_truncated_at_depth_n_is_the_geometric_sum) {
  double worst = 0.0;
  for (const uint depth : {1u, 2u, 5u, 17u}) {
    SCOPED_TRACE(depth);
    const Film film = render_full(furnace(Room::cube, 0.8, depth), depth > 5 ? 1024 : 256);
    worst = std::max(worst, expect_mean(film, (1.0 - std::pow(0.8, depth)) / 0.2));
  }
  record_extreme("X31", worst, z_limit);
}

TEST(furnace_image, room_of_any_shape_is_emission_over_one_minus_albedo) {
  struct Case { Room room; double albedo; uint samples; };
  for (const Case c : {Case{Room::sphere, 0.5, 512}, {Room::cube, 0.8, 1280}, {Room::rock, 0.8, 1280}, {Room::sphere, 0.9, 1920}}) {
    SCOPED_TRACE(testing::Message() << static_cast<int>(c.room) << " " << c.albedo);
    expect_mean(render_full(furnace(c.room, c.albedo), c.samples), 1.0 / (1.0 - c.albedo));
  }
}

// No light sampling at a mirror: each path is the sum of its powers, however it bounces.
TEST(furnace_image, mirror_room_is_the_geometric_sum_in_every_sample) {
  const double r = 0.9f;
  for (const Room room : {Room::cube, Room::rock, Room::sphere})
    for (const uint depth : {1u, 3u, 40u, 400u}) {
      SCOPED_TRACE(testing::Message() << static_cast<int>(room) << " " << depth);
      World world = furnace(room, mirror(0.9), depth);
      world.integrator.rr_depth = no_roulette;
      expect_every_sample(render_full(world, 4), (1.0 - std::pow(r, depth)) / (1.0 - r), (depth + 2) * unit_roundoff);
    }
}

TEST(furnace_image, roulette_does_not_change_the_mean) {
  double worst = 0.0;
  for (const double albedo : {0.02, 0.4, 0.6}) {  // 0.02 is below the least probability of survival
    SCOPED_TRACE(albedo);
    World world = furnace(Room::cube, albedo);
    world.integrator.rr_depth = 1;
    worst = std::max(worst, expect_mean(render_full(world, 1280), 1.0 / (1.0 - albedo)));
    world.integrator.rr_depth = no_roulette;
    world.integrator.max_depth = 36;  // .6^36 = 1e-8
    worst = std::max(worst, expect_mean(render_full(world, 384), 1.0 / (1.0 - albedo)));
  }
  record_extreme("X29", worst, z_limit);
}

// Albedo 1 - 2^-24: roulette ends the paths; without it they end at the hard depth of 4096 segments.
TEST(furnace_image, nearly_white_room_terminates) {
  const Film film = render_full(furnace(Room::cube, 1.0 - 0x1p-24), 4);
  EXPECT_EQ(rejected_samples(film), 0u);
  EXPECT_GT(estimate(film).mean, 20.0);

  World world = furnace(Room::sphere, mirror(1.0 - 0x1p-24));
  world.integrator.rr_depth = no_roulette;
  world.film.width = world.film.crop_width = world.film.height = world.film.crop_height = 8;
  const double r = 1.0 - 0x1p-24;
  const double off = expect_every_sample(render_full(world, 2), (1.0 - std::pow(r, 4096)) / (1.0 - r), 4098 * unit_roundoff);
  record_extreme("X29", off / (4098 * unit_roundoff), 1);
}

TEST(furnace_image, glass_sphere_in_uniform_light_is_invisible_in_every_sample) {
  for (const double eta : {1.0, 1.5, 2.42, 1.0 / 1.5}) {
    SCOPED_TRACE(eta);
    expect_every_sample(render_full(glass_sphere(eta), 64), 1.0, glass_tolerance);
  }
}

// A ray that meets a glass sphere at one angle meets it at that angle ever after: with reflectance R each time, n segments miss
// the share (1 - R) R^(n - 2) that is still inside.
TEST(furnace_image, glass_sphere_truncated_at_depth_n_lacks_what_is_still_inside) {
  const double angle = glm::radians(75.0), reflectance = 0.25306056299;  // of eta 1.5 there
  double worst = 0.0;
  for (const uint depth : {2u, 3u, 4u}) {
    SCOPED_TRACE(depth);
    World world = glass_sphere(1.5);
    look_closely(world, {2 * std::sin(angle), 0, 1 + 2 * std::cos(angle)}, {0, 0, 1});
    world.integrator.max_depth = depth;
    const double inside = (1.0 - reflectance) * std::pow(reflectance, depth - 2);
    worst = std::max(worst, expect_mean(render_full(world, 512), 1.0 - inside, 0.02));
  }
  record_extreme("X31", worst, z_limit);
}

// From inside a glass box, directions with all components below cos(critical) = 0.745 never leave: the path ends at the hard
// depth of 4096 segments and brings nothing. Others leave with the squared index, however long they take.
TEST(furnace_image, light_trapped_in_a_glass_box_is_lost_and_no_other) {
  const uint samples = 4;
  for (const bool trapped : {true, false}) {
    SCOPED_TRACE(trapped);
    World world = glass(1.5);
    add_box(world.shapes[0].mesh, {-1, -1, -1}, {1, 1, 1});
    look_closely(world, {0.1, 0.2, -0.3}, trapped ? glm::dvec3(1.1, 1.3, 0.6) : glm::dvec3(1.1, 0.4, 0.1), 8, 8);
    const Film film = render_full(world, samples);
    if (trapped) {
      EXPECT_EQ(rejected_samples(film), 0u);
      EXPECT_EQ(estimate(film).mean, 0.0);
      EXPECT_EQ(film.rays, 8 * 8 * samples * 4096u);
    } else {
      expect_every_sample(film, 1.5 * 1.5, glass_tolerance);
    }
  }
  record_law("X44");
}

TEST(furnace_image, roulette_keeps_glass_invisible_in_the_mean) {
  World world = glass_sphere(2.42);
  world.integrator.rr_depth = 2;
  expect_mean(render_full(world, 512), 1.0);
}

// Flat facets: any closed surface will do, but a polyhedron can hold light for long.
TEST(furnace_image, glass_polyhedron_in_uniform_light_is_invisible_in_every_sample) {
  for (const double eta : {1.0, 1.5}) {
    SCOPED_TRACE(eta);
    World world = glass(eta);
    world.shapes[0].mesh = icosphere(3, 0.02, 3);
    expect_every_sample(render_full(world, 16), 1.0, 4 * glass_tolerance);
  }
}

// Interpolated normals lose the paths that end on the wrong side of the facets, and never gain: each sample is 1 or 0. What
// they lose shrinks with the facets.
TEST(furnace_image, glass_with_smooth_normals_never_gains_and_loses_less_when_finer) {
  double lost_before = 1.0;
  for (const int level : {2, 4}) {
    World world = glass(1.5);
    world.shapes[0].mesh = icosphere(level, 0.0, 1);
    world.shapes[0].mesh.normals = world.shapes[0].mesh.positions;
    const Film film = render_full(world, 64);
    EXPECT_EQ(rejected_samples(film), 0u);
    for (std::size_t i = 0; i < film.pixels.size(); ++i) EXPECT_LE(pixel_mean(film, i)[0], 1.0 + glass_tolerance);
    const double lost = 1.0 - estimate(film).mean;
    EXPECT_LT(lost, 0.5 * lost_before) << level;
    lost_before = lost;
  }
  EXPECT_LT(lost_before, 0.01);
  record_law("X42");
}

// Radiance over the squared index is what refraction conserves (Veach 1997, 5.2). All rays from there meet the surface below
// the critical angle.
TEST(furnace_image, inside_glass_uniform_light_is_the_squared_index) {
  for (const double eta : {1.5, 2.42}) {
    SCOPED_TRACE(eta);
    World world = glass_sphere(eta);
    look(world, {0.1, 0.15, -0.1}, {1, 0.2, 0.3}, {0, 1, 0}, 2.0, 32, 16);
    const double index = static_cast<float>(eta);
    expect_every_sample(render_full(world, 64), index * index, glass_tolerance);
  }
}

TEST(furnace_image, mirror_sphere_in_uniform_light_is_its_reflectance_in_every_sample) {
  World world;
  add_light(world, LIGHT_CONSTANT, glm::dvec3(1.0));
  add_sphere(world, mirror(0.7), Sides::front, {0, 0, 0}, 1.0);
  look(world, {0.4, 0.7, 3}, {0, 0, 0}, {0, 1, 0}, 0.2, 32, 16);  // the sphere fills the view
  expect_every_sample(render_full(world, 64), 0.7f, 2 * unit_roundoff);
}

// A sheet absorbs nothing, however its reflections add up: bubbles within bubbles.
TEST(furnace_image, thin_bubbles_in_uniform_light_are_invisible_in_every_sample) {
  for (const double eta : {1.0, 1.5, 2.42, 1.0 / 1.5}) {
    SCOPED_TRACE(eta);
    World world = glass_sphere(eta);
    world.materials[0].kind = MATERIAL_THIN_DIELECTRIC;
    add_sphere(world, world.materials[0], Sides::both, {0.1, 0.2, 0.0}, 0.6);
    expect_every_sample(render_full(world, 64), 1.0, glass_tolerance);
  }
}

// Schlick's approximation moves light between reflection and refraction, and loses none.
TEST(furnace_image, glass_with_schlicks_reflectance_stays_invisible) {
  Scene scene = place_scene(glass_sphere(1.5));
  scene.features = every_feature;
  scene.approximations = APPROXIMATION_SCHLICK;
  expect_every_sample(render_scene(scene, 64), 1.0, glass_tolerance);
}
