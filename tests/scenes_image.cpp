// The scenes of the repository, read from their files: each shows what its header says.
#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>

#include "../host/reader.h"
#include "../host/variant.h"
#include "extremes.h"
#include "worlds.h"

using namespace oclair;
using namespace oclair::test;

namespace {

void shrink(World& world, uint width, uint height) {
  world.film.width = world.film.crop_width = width;
  world.film.height = world.film.crop_height = height;
}

std::filesystem::path scene_directory() { return directory().parent_path() / "scenes"; }

World scene_file(const std::string& name, const Definitions& definitions = {}) {
  return read_scene(scene_directory() / name, definitions);
}

std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(scene_directory()))
    if (entry.path().extension() == ".xml") names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  EXPECT_GE(names.size(), 12u);
  return names;
}

std::set<std::string> names_of(Features features) {
  std::set<std::string> names;
#define INSERT_NAME(name, bit, variant, description) \
  if (features & FEATURE_##name) names.insert(#name);
  FEATURE_LIST(INSERT_NAME)
#undef INSERT_NAME
  return names;
}

// The words between "Features:" and the end of the comment at a scene's head.
std::set<std::string> features_in_header(const std::string& name) {
  std::ifstream file(scene_directory() / name);
  std::set<std::string> names;
  std::string word;
  while (file >> word && word != "Features:" && word != "<scene") {
  }
  while (file >> word && word != "-->") names.insert(word);
  return names;
}

Film render(const Scene& scene, uint samples) {
  const Bvh bvh = build_bvh(scene, device().bvh_width);
  Renderer renderer = start_render(device(), scene, bvh);
  render_pass(renderer, samples);
  return read_film(renderer);
}

std::size_t different_pixels(const Film& a, const Film& b) {
  EXPECT_EQ(a.pixels.size(), b.pixels.size());
  std::size_t different = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i)
    different += std::memcmp(&a.pixels[i], &b.pixels[i], sizeof(FilmPixel)) != 0;
  return different;
}

double mean_of(const Film& film, uint x0, uint y0, uint x1, uint y1) {
  double sum = 0.0;
  for (uint y = y0; y < y1; ++y)
    for (uint x = x0; x < x1; ++x) sum += pixel_mean(film, std::size_t{y} * film.width + x)[1];
  return sum / (static_cast<double>(x1 - x0) * (y1 - y0));
}

}  // namespace

TEST(scenes_image, every_scene_renders_light_and_rejects_no_sample) {
  for (const std::string& name : scene_names()) {
    World world = scene_file(name);
    EXPECT_TRUE(world.warnings.empty()) << name << ": " << world.warnings.front();
    shrink(world, 32, 32);
    const Film film = render(world, 4);
    EXPECT_EQ(rejected_samples(film), 0u) << name;
    EXPECT_GT(mean_of(film, 0, 0, 32, 32), 0.01) << name;
  }
}

// Beside the sampler, which is not the scene's to say.
TEST(scenes_image, a_scene_requires_exactly_the_features_that_its_header_names) {
  for (const std::string& name : scene_names())
    EXPECT_EQ(names_of(place_scene(scene_file(name)).features & ~FEATURE_SOBOL), features_in_header(name)) << name;
}

// Features that a scene does not have draw no random numbers and touch no arithmetic of those that it has.
TEST(scenes_image, kernels_with_more_features_give_the_film_of_the_exact_one) {
  for (const std::string& name : scene_names()) {
    World world = scene_file(name);
    shrink(world, 24, 24);
    Scene scene = place_scene(world);
    const Film shared = render(scene, 3);
    scene.exact_kernel = true;
    const Film exact = render(scene, 3);
    scene.features = every_feature;
    const Film full = render(scene, 3);
    EXPECT_EQ(different_pixels(exact, shared), 0u) << name;
    EXPECT_EQ(different_pixels(exact, full), 0u) << name;
  }
  record_law("X32");
}

TEST(scenes_image, the_scenes_of_the_repository_share_three_kernels) {
  std::set<Variant> variants;
  for (const std::string& name : scene_names()) variants.insert(variant_of(place_scene(scene_file(name)).features));
  EXPECT_EQ(variants, (std::set{Variant::PLAIN, Variant::SURFACES, Variant::TEXTURED}));
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
