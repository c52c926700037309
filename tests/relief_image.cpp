// Tilted normals and blends in whole renders.
#include <cstring>

#include "extremes.h"
#include "image.h"
#include "textured.h"

using namespace oclair;
using namespace oclair::test;

namespace {

glm::dvec3 tilted(double degrees) { return {std::sin(glm::radians(degrees)), 0, std::cos(glm::radians(degrees))}; }

// A diffuse sheet in light that is 1 from everywhere, seen along its normal.
World sheet(const Material& material, World world = {}) {
  WorldShape& shape = add_shape(world, material, Sides::both);
  add_quad(shape.mesh, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
  shape.mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  add_light(world, LIGHT_CONSTANT, glm::dvec3(1.0));
  look_closely(world, {0.1, 0.2, 2}, {0.1, 0.2, 0});
  return world;
}

bool same_bits(const Film& a, const Film& b) {
  return a.pixels.size() == b.pixels.size() && std::memcmp(a.pixels.data(), b.pixels.data(), a.pixels.size() * sizeof(FilmPixel)) == 0;
}

Material blend(double weight, uint first, uint second) {
  Material m{};
  m.kind = MATERIAL_BLEND;
  m.weight = static_cast<float>(weight);
  m.first = first;
  m.second = second;
  return m;
}

// A room with everything in it that this part of the renderer decides on.
World room_of_reliefs() {
  World world;
  Material wall = diffuse(0.7);
  wall.bump_texture = add_bitmap(world, 4, 4, 1, random_numbers(16, 1));
  wall.bump_scale = 0.2f;
  add_box(add_shape(world, wall, Sides::front).mesh, {-1, -1, -1}, {1, 1, 1}, true);
  add_quad(add_shape(world, diffuse(0.2), Sides::front, 5.0).mesh, {-0.3, 0.99, -0.3}, {0.6, 0, 0}, {0, 0, 0.6});
  Material screen = diffuse(0.4);
  screen.opacity_texture = add_bitmap(world, 2, 2, 1, {0.1f, 0.9f, 0.6f, 0.3f});
  screen.normal_texture = add_constant(world, normal_color(tilted(30)));
  const uint first = static_cast<uint>(world.materials.size());
  world.materials.push_back(screen);
  world.materials.push_back(mirror(0.9));
  world.materials.push_back(dielectric(1.5));
  world.materials.push_back(blend(0.3, first + 1, first + 2));
  add_box(add_shape(world, blend(0.6, first, first + 3), Sides::both).mesh, {-0.8, -0.9, -0.5}, {-0.2, -0.4, 0.1});
  add_sphere(world, screen, Sides::both, {0.4, -0.5, 0.2}, 0.4);
  add_light(world, LIGHT_POINT, glm::dvec3(0.5), {0.5, 0.5, 0.5});
  look(world, {0, 0, 0.9}, {0, -0.2, -1}, {0, 1, 0}, 1.0, 37, 29);
  return world;
}

}  // namespace

// Of cosine-distributed directions around a normal tilted by t, the share (1 + cos t)/2 lies above the true surface; the rest is
// rejected (extreme X41).
TEST(relief_image, a_normal_tilted_by_t_keeps_1_plus_cos_t_over_2_of_the_light) {
  double worst = 0.0;
  for (const double t : {10.0, 30.0, 60.0, 80.0}) {
    SCOPED_TRACE(t);
    World maps;
    Material m = diffuse(0.8);
    m.normal_texture = add_constant(maps, normal_color(tilted(t)));
    worst = std::max(worst, expect_mean(render_full(sheet(m, maps), 2048), 0.8f * (1 + std::cos(glm::radians(t))) / 2));
  }
  record_extreme("X41", worst, z_limit);
}

// A plane that rises by tan t: from behind too, where the map is mirrored or turned.
TEST(relief_image, a_ramp_as_a_bump_map_keeps_the_same) {
  const double t = 30.0;
  for (const bool behind : {false, true}) {
    World maps;
    Material m = diffuse(0.8);
    m.bump_texture = add_bitmap(maps, 4, 1, 1, {0.0f, 1.0f, 2.0f, 3.0f});  // u = 1 is 4 of them, 2 long
    m.bump_scale = static_cast<float>(std::tan(glm::radians(t)) / 2.0);
    World world = sheet(m, maps);
    if (behind) look_closely(world, {0.1, 0.2, -2}, {0.1, 0.2, 0});
    expect_mean(render_full(world, 512), 0.8f * (1 + std::cos(glm::radians(t))) / 2);
  }
}

TEST(relief_image, maps_that_say_nothing_change_no_bit) {
  const Film plain = render_full(sheet(diffuse(0.8)), 4);
  World maps;
  Material m = diffuse(0.8);
  m.normal_texture = add_constant(maps, {0.5f, 0.5f, 1.0f});
  m.bump_texture = add_bitmap(maps, 2, 2, 1, {0.7f, 0.7f, 0.7f, 0.7f});
  m.bump_scale = 3.0f;
  EXPECT_TRUE(same_bits(render_full(sheet(m, maps), 4), plain));
}

// One of two Lambert materials at each vertex is in the mean the Lambert material between them, bounce after bounce.
TEST(relief_image, a_closed_room_of_two_blended_albedos_is_the_room_of_their_mean) {
  World world;
  world.materials = {diffuse(0.2), diffuse(0.9)};
  Material both = blend(0.4, 0, 1);
  add_box(add_shape(world, both, Sides::front, 1.0).mesh, {-1, -1, -1}, {1, 1, 1}, true);
  look(world, {0.2, 0.1, 0.3}, {1, 0.3, 0.2}, {0, 1, 0}, 1.0, 32, 16);
  world.integrator.rr_depth = no_roulette;
  const double mean = 0.6 * 0.2f + 0.4 * 0.9f;
  for (const uint depth : {2u, 40u}) {
    world.integrator.max_depth = depth;
    expect_mean(render_full(world, 1280), (1 - std::pow(mean, depth)) / (1 - mean));
  }
}

TEST(relief_image, a_blend_of_weight_0_or_1_is_the_one_it_chooses_bit_for_bit) {
  for (const double weight : {0.0, 1.0}) {
    World world;
    world.materials = {diffuse(0.2), diffuse(0.9)};
    World alone = sheet(diffuse(weight == 1.0 ? 0.9 : 0.2));
    EXPECT_TRUE(same_bits(render_full(sheet(blend(weight, 0, 1), world), 4), render_full(alone, 4)));
  }
}

TEST(relief_image, a_kernel_with_every_feature_gives_the_bits_of_one_with_just_the_needed) {
  const World world = room_of_reliefs();
  const Film film = render(world, 4);
  EXPECT_TRUE(same_bits(film, render_full(world, 4)));
  EXPECT_GT(image_mean(film).mean, 0.0);
}
