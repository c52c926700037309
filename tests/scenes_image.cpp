// The scenes of the repository, read from their files: each shows what its header says.
#include "../host/reader.h"
#include "worlds.h"

using namespace oclair;
using namespace oclair::test;

namespace {

World scene_file(const std::string& name, const Definitions& definitions = {}) {
  return read_scene(directory().parent_path() / "scenes" / name, definitions);
}

void shrink(World& world, uint width, uint height) {
  world.film.width = world.film.crop_width = width;
  world.film.height = world.film.crop_height = height;
}

double mean_of(const Film& film, uint x0, uint y0, uint x1, uint y1) {
  double sum = 0.0;
  for (uint y = y0; y < y1; ++y)
    for (uint x = x0; x < x1; ++x) sum += pixel_mean(film, std::size_t{y} * film.width + x)[1];
  return sum / (static_cast<double>(x1 - x0) * (y1 - y0));
}

}  // namespace

TEST(scenes_image, every_scene_renders_light_and_rejects_no_sample) {
  for (const char* name : {"cornell.xml", "cornell-boxes.xml", "furnace.xml", "mirrors.xml", "slab.xml"}) {
    World world = scene_file(name);
    EXPECT_TRUE(world.warnings.empty()) << name << ": " << world.warnings.front();
    shrink(world, 32, 32);
    const Film film = render(world, 4);
    EXPECT_EQ(rejected_samples(film), 0u) << name;
    EXPECT_GT(mean_of(film, 0, 0, 32, 32), 0.01) << name;
  }
}

TEST(scenes_image, a_scene_requires_exactly_its_features) {
  const std::map<std::string, Features> required = {
      {"cornell.xml", FEATURE_DIFFUSE | FEATURE_MIRROR | FEATURE_DIELECTRIC | FEATURE_TRIANGLES | FEATURE_SPHERES |
                          FEATURE_TRIANGLE_LIGHTS},
      {"cornell-boxes.xml", FEATURE_DIFFUSE | FEATURE_TRIANGLES | FEATURE_TRIANGLE_LIGHTS},
      {"furnace.xml", FEATURE_DIFFUSE | FEATURE_TRIANGLES | FEATURE_TRIANGLE_LIGHTS},
      {"mirrors.xml", FEATURE_DIFFUSE | FEATURE_MIRROR | FEATURE_CONDUCTOR | FEATURE_TRIANGLES | FEATURE_SMOOTH_NORMALS |
                          FEATURE_SPHERES | FEATURE_QUADRIC_LIGHTS | FEATURE_CONSTANT_LIGHT},
      {"slab.xml", FEATURE_DIFFUSE | FEATURE_DIELECTRIC | FEATURE_TRIANGLES | FEATURE_TRIANGLE_LIGHTS}};
  for (const auto& [name, features] : required) EXPECT_EQ(place_scene(scene_file(name)).features, features) << name;
}

// Radiance 1 / (1 - 0.5) everywhere. 4096 pixels of 16 samples; the spread between pixels gives the standard error.
TEST(scenes_image, furnace_is_two_everywhere) {
  World world = scene_file("furnace.xml");
  shrink(world, 64, 64);
  const Estimate e = image_mean(render(world, 16));
  EXPECT_NEAR(e.mean, 2.0, 4.27 * e.error);
  EXPECT_LT(e.error, 0.004);
}

// T = (1 - R)/(1 + R): 0.923076923 at normal incidence, 0.836232463 at 60 degrees; index 1.5; each times the wall's 0.5.
// The directions of the pixels that are averaged lie within 0.1 degrees, symmetrically: T is linear over them to 1e-6.
TEST(scenes_image, slabs_transmit_what_fresnel_says) {
  World world = scene_file("slab.xml");
  shrink(world, 64, 64);
  const Film film = render(world, 1024);
  EXPECT_NEAR(mean_of(film, 0, 0, 64, 6), 0.5, 1e-7);
  // A sample is 0.5 or 0: standard error of n samples 0.5 sqrt(T (1 - T) / n), n = 10 x 30 x 1024.
  EXPECT_NEAR(mean_of(film, 17, 11, 47, 21), 0.5 * 0.923076923, 4.27 * 0.5 * 0.267 / 554.0);
  EXPECT_NEAR(mean_of(film, 24, 43, 40, 53), 0.5 * 0.836232463, 4.27 * 0.5 * 0.370 / 404.0);
}
