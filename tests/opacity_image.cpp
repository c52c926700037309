// Surfaces that let light straight through: transmission of stacks for every strategy that finds light, and termination.
#include "image.h"
#include "textured.h"

using namespace oclair;
using namespace oclair::test;

namespace {

Material masked(Material m, double opacity) {
  m.transparency = static_cast<float>(1.0 - opacity);
  return m;
}

// As float32 has it.
double transparency(double opacity) { return static_cast<float>(1.0 - opacity); }

void add_sheet(World& world, const Material& material, double y, double half = 1.0) {
  add_quad(add_shape(world, material, Sides::both).mesh, {-half, y, -half}, {0, 0, 2 * half}, {2 * half, 0, 0});
}

// A diffuse floor at y = 0, `count` black sheets over it, and a camera below them that sees the floor's middle.
World floor_under_sheets(double albedo, double opacity, int count) {
  World world;
  add_sheet(world, diffuse(albedo), 0.0);
  for (int i = 0; i < count; ++i) add_sheet(world, masked(diffuse(0.0), opacity), 0.3 + 0.05 * i);
  look_closely(world, {0.1, 0.2, 0.15}, {0, 0, 0});
  world.integrator.max_depth = 2;
  return world;
}

}  // namespace

TEST(opacity_image, a_white_mirror_of_any_opacity_is_invisible_in_every_sample) {
  for (const double opacity : {0.0, 0.3, 1.0}) {
    World world;
    add_light(world, LIGHT_CONSTANT, glm::dvec3(1.0));
    add_box(add_shape(world, masked(mirror(1.0), opacity), Sides::both).mesh, {-0.5, -0.4, -0.3}, {0.5, 0.3, 0.6});
    look(world, {0.4, 0.7, 3}, {0, 0, 0}, {0, 1, 0}, 0.3, 32, 16);
    world.integrator.rr_depth = no_roulette;
    expect_every_sample(render_full(world, 32), 1.0, 8 * unit_roundoff);
  }
}

// Light sampling and scattering meet the masks in different ways; together they make up 1.
TEST(opacity_image, a_white_diffuse_object_of_any_opacity_is_invisible_in_the_mean) {
  for (const double opacity : {0.0, 0.3, 1.0}) {
    World world;
    add_light(world, LIGHT_CONSTANT, glm::dvec3(1.0));
    add_sphere(world, masked(diffuse(1.0), opacity), Sides::both, {0, 0, 0}, 1.0);
    look(world, {0.4, 0.7, 3}, {0, 0, 0}, {0, 1, 0}, 0.2, 32, 16);
    world.integrator.rr_depth = no_roulette;
    expect_mean(render_full(world, 256), 1.0);
  }
}

TEST(opacity_image, a_stack_of_masks_transmits_the_power_of_its_length_to_the_eye) {
  for (const int m : {1, 3}) {
    World world;
    add_light(world, LIGHT_CONSTANT, glm::dvec3(1.0));
    for (int i = 0; i < m; ++i) add_sheet(world, masked(diffuse(0.0), 0.3), 0.1 * i);
    look_closely(world, {0.2, -2, 0.3}, {0, 0, 0});
    expect_mean(render_full(world, 2048), std::pow(transparency(0.3), m), 0.01);
  }
}

// However near: coincident, one unit in the last place apart, and nearer than a new ray would start off the surface.
TEST(opacity_image, sheets_that_touch_are_passed_one_by_one) {
  for (const double gap : {0.0, 6e-8, 1e-7, 1e-6}) {
    World world;
    add_light(world, LIGHT_CONSTANT, glm::dvec3(1.0));
    for (int i = 0; i < 3; ++i) add_sheet(world, masked(diffuse(0.0), 0.3), 0.5 + gap * i);
    look_closely(world, {0.2, -2, 0.3}, {0, 0, 0});
    expect_mean(render_full(world, 2048), std::pow(transparency(0.3), 3), 0.01);
  }
}

TEST(opacity_image, a_wall_that_touches_a_mask_is_seen_through_it_and_shadows_through_it) {
  for (const double gap : {0.0, 6e-8, 1e-6})
    for (const bool wall_first : {false, true}) {
      World world;
      add_light(world, LIGHT_CONSTANT, glm::dvec3(1.0));
      const auto wall = [&] { add_sheet(world, diffuse(0.0), 0.5 + gap); };
      if (wall_first) wall();
      add_sheet(world, masked(diffuse(0.0), 0.0), 0.5);
      if (!wall_first) wall();
      add_sheet(world, diffuse(0.5), 0.0, 1e-3);  // the floor, which looks at the wall through the mask
      look_closely(world, {0.0, 0.4, 0.1}, {0, 0.5, 0});
      world.integrator.max_depth = 2;
      expect_every_sample(render_full(world, 4), 0.0, 0.0);
      world.lights.clear();
      add_light(world, LIGHT_POINT, glm::dvec3(2.0), {0, 0.9, 0});
      look_closely(world, {0.1, 0.2, 0.15}, {0, 0, 0});
      expect_every_sample(render_full(world, 4), 0.0, 0.0);
    }
}

// The ray meets one and the same primitive twice.
TEST(opacity_image, a_masked_sphere_is_two_masks) {
  World world;
  add_light(world, LIGHT_CONSTANT, glm::dvec3(1.0));
  add_sphere(world, masked(diffuse(0.0), 0.4), Sides::both, {0, 0, 0}, 1.0);
  look(world, {0.4, 0.7, 3}, {0, 0, 0}, {0, 1, 0}, 0.2, 32, 16);
  expect_mean(render_full(world, 2048), std::pow(transparency(0.4), 2), 0.01);
}

// No random number is in a shadow ray's transmission: I cos / d^2 for every sample. Rounding: some 20 operations, and the offset of
// the floor's point, 2e-6 of the distance.
TEST(opacity_image, a_stack_of_masks_transmits_the_power_of_its_length_to_a_point_light) {
  for (const int m : {0, 1, 4}) {
    World world = floor_under_sheets(0.5, 0.3, m);
    add_light(world, LIGHT_POINT, glm::dvec3(2.0), {0, 0.9, 0});
    add_sheet(world, diffuse(0.0), 0.95);  // behind the light: a shadow ray ends before, however many masks it has passed
    const double exact = 0.5 / glm::pi<double>() * 2.0 / (0.9 * 0.9) * std::pow(transparency(0.3), m);
    expect_every_sample(render_full(world, 8), exact, 1e-5);
  }
}

TEST(opacity_image, a_stack_of_masks_transmits_the_power_of_its_length_of_light_from_around) {
  for (const int m : {1, 3}) {
    World world;
    add_sheet(world, diffuse(0.5), 0.0);
    for (int i = 0; i < m; ++i) add_sphere(world, masked(diffuse(0.0), 0.3), Sides::both, {0, 0, 0}, 0.5 + 0.1 * i);
    add_light(world, LIGHT_CONSTANT, glm::dvec3(1.0));
    look_closely(world, {0.1, 0.2, 0.15}, {0, 0, 0});
    world.integrator.max_depth = 2;
    expect_mean(render_full(world, 2048), 0.5 * std::pow(transparency(0.3), m), 0.01);
  }
}

// The rectangle is near and wide: both strategies count, and the weights hold only if both measure the distance from the floor.
// Configuration factor of a rectangle over its centre (Howell, A Catalog of Radiation Heat Transfer Configuration Factors, B-4).
TEST(opacity_image, an_area_light_behind_masks_gives_the_configuration_factor_times_their_transmission) {
  const double h = 0.8, x = 0.7 / h, a = std::sqrt(1 + x * x), factor = 4.0 / glm::pi<double>() * x / a * std::atan(x / a);
  for (const double opacity : {0.0, 0.3, 0.8})
    for (const int m : {1, 3}) {
      World world = floor_under_sheets(0.5, opacity, m);
      add_quad(add_shape(world, diffuse(0.0), Sides::front, 3.0).mesh, {-0.7, h, -0.7}, {1.4, 0, 0}, {0, 0, 1.4});
      const double through = std::pow(transparency(opacity), m);
      if (through < 0.05) continue;  // noise
      expect_mean(render_full(world, 2048), 0.5 * 3.0 * factor * through, 0.02);
    }
}

// The sheet is half wall and half nothing at each meeting: the eye's ray and the shadow ray meet it once each.
TEST(opacity_image, a_blend_decides_anew_for_the_path_and_for_its_shadow_ray) {
  World world;
  add_sheet(world, diffuse(0.5), 0.0);
  add_sheet(world, Material{}, 0.3);
  Material& blend = world.materials[1];
  blend.kind = MATERIAL_BLEND;
  blend.weight = 0.5f;
  blend.first = 2;
  blend.second = 3;
  world.materials.push_back(diffuse(0.0));
  world.materials.push_back(masked(diffuse(0.0), 0.0));
  add_light(world, LIGHT_POINT, glm::dvec3(2.0), {0, 0.9, 0});
  look_closely(world, {0.1, 0.7, 0.15}, {0, 0, 0});
  expect_mean(render_full(world, 1024), 0.25 * 0.5 / glm::pi<double>() * 2.0 / (0.9 * 0.9), 0.015);
}

TEST(opacity_image, what_is_wholly_transparent_does_not_cover_the_pixel) {
  World world;
  add_sheet(world, masked(diffuse(0.5), 0.0), 0.0);
  look_closely(world, {0.2, 1, 0.3}, {0, 0, 0});
  const Film film = render_full(world, 4);
  for (const FilmPixel& pixel : film.pixels) EXPECT_EQ(pixel.hits, 0u);
}

// A texture of holes: black or nothing.
TEST(opacity_image, an_opacity_texture_lets_through_where_it_says) {
  World world;
  add_light(world, LIGHT_CONSTANT, glm::dvec3(1.0));
  Material m = diffuse(0.0);
  m.opacity_texture = add_bitmap(world, 2, 1, 1, {0.0f, 1.0f});
  world.textures[0].nearest = true;
  WorldShape& shape = add_shape(world, m, Sides::both);
  add_quad(shape.mesh, {-1, 0, -1}, {0, 0, 2}, {2, 0, 0});
  shape.mesh.uvs = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};  // u along x
  for (const double x : {-0.5, 0.5}) {
    look_closely(world, {x, 1, 0.1}, {x, 0, 0});
    const Film film = render_full(world, 4);
    for (std::size_t i = 0; i < film.pixels.size(); ++i) EXPECT_EQ(pixel_mean(film, i)[0], x < 0 ? 1.0 : 0.0);
  }
}

TEST(opacity_image, a_thousand_sheets_in_one_plane_and_a_wedge_end_every_path) {
  World sheets, wedge;
  for (int i = 0; i < 1000; ++i) add_sheet(sheets, masked(diffuse(0.5), i % 2 ? 0.0 : 0.01), 0.0);
  add_quad(add_shape(wedge, masked(diffuse(0.5), 0.0), Sides::both).mesh, {-1, 0, -1}, {0, 0, 2}, {2, 0, 0});
  add_quad(add_shape(wedge, masked(diffuse(0.5), 0.0), Sides::both).mesh, {-1, 0, -1}, {0, 0, 2}, {2, 1e-5, 0});
  for (World* world : {&sheets, &wedge}) {
    add_light(*world, LIGHT_CONSTANT, glm::dvec3(1.0));
    add_light(*world, LIGHT_POINT, glm::dvec3(1.0), {-0.3, 0.5, 0.1});
    look(*world, {0.1, 0.8, 2}, {0, 0, 0}, {0, 1, 0}, 0.3, 16, 16);
    EXPECT_EQ(rejected_samples(render_full(*world, 4)), 0u);
  }
  wedge.lights.pop_back();
  expect_every_sample(render_full(wedge, 4), 1.0, 0.0);
}
