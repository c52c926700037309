// The variance that the film's second moments promise is the spread of independent renders.
#include "image.h"

using namespace oclair;
using namespace oclair::test;

namespace {

constexpr uint samples = 64;
constexpr int renders = 64;

// A room with coloured walls, lit through a window by its sky and by a lamp.
World room() {
  World world;
  WorldShape& walls = add_shape(world, diffuse(0.6), Sides::front);
  world.materials[walls.material_front].reflectance = {0.7f, 0.5f, 0.2f};
  add_box(walls.mesh, {-1, -1, -1}, {1, 1, 1}, true);
  walls.mesh.triangles.pop_back();
  add_quad(add_shape(world, diffuse(0.2), Sides::front, 3.0).mesh, {-0.3, 0.9, -0.3}, {0.6, 0, 0}, {0, 0, 0.6});
  add_light(world, LIGHT_CONSTANT, {0.2, 0.5, 1.0});
  look(world, {0, 0, 0.9}, {0, -0.2, -1}, {0, 1, 0}, 1.0, 16, 16);
  return world;
}

struct Replicate {
  std::vector<glm::dvec3> mean;
  std::vector<glm::dmat3> products;
};

Replicate replicate(const Film& film) {
  Replicate r;
  for (std::size_t i = 0; i < film.pixels.size(); ++i) {
    const auto m = pixel_mean(film, i);
    r.mean.emplace_back(m[0], m[1], m[2]);
    r.products.push_back(pixel_mean_products(film, i));
  }
  return r;
}

// How the covariance of channels a and b between renders differs from the one that moments promise, in units of the promised
// deviations, mean of all pixels: each pixel counts alike, as few bright edges would otherwise decide alone. Of k renders a pixel's
// relative deviation is sqrt(2 / (k - 1)) at most; 1.3 for means of 64 samples that are not quite normal. And the same for the
// picture's mean, in which pixels must be independent.
void expect_consistent(const std::vector<Replicate>& replicates) {
  const double k = static_cast<double>(replicates.size());
  const std::size_t pixels = replicates[0].mean.size();
  glm::dmat3 excess(0.0), promised_sum(0.0), image_spread(0.0);
  double noisy = 0.0;  // pixels
  for (std::size_t i = 0; i < pixels; ++i) {
    glm::dvec3 mean(0.0);
    for (const Replicate& r : replicates) mean += r.mean[i] / k;
    glm::dmat3 promised(0.0), spread(0.0);
    for (const Replicate& r : replicates) {
      promised += (r.products[i] - glm::outerProduct(r.mean[i], r.mean[i])) / ((samples - 1.0) * k);
      spread += glm::outerProduct(r.mean[i] - mean, r.mean[i] - mean) / (k - 1.0);
    }
    promised_sum += promised;
    if (std::max({promised[0][0], promised[1][1], promised[2][2]}) < 1e-12) {  // sees the sky alone
      EXPECT_LT(std::max({spread[0][0], spread[1][1], spread[2][2]}), 1e-12);
      continue;
    }
    noisy += 1.0;
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b)
        excess[a][b] += (spread[a][b] - promised[a][b]) / std::sqrt(promised[a][a] * promised[b][b]);
  }
  std::vector<glm::dvec3> image(replicates.size(), glm::dvec3(0.0));
  glm::dvec3 middle(0.0);
  for (std::size_t r = 0; r < replicates.size(); ++r) {
    for (const glm::dvec3& m : replicates[r].mean) image[r] += m;
    middle += image[r] / k;
  }
  for (const glm::dvec3& m : image) image_spread += glm::outerProduct(m - middle, m - middle) / (k - 1.0);
  EXPECT_GT(noisy, 0.8 * static_cast<double>(pixels));
  for (int a = 0; a < 3; ++a)
    for (int b = a; b < 3; ++b) {
      EXPECT_NEAR(excess[a][b] / noisy, 0.0, z_limit * 1.3 * std::sqrt(2.0 / ((k - 1.0) * noisy))) << a << b;
      if (a != b) continue;
      // Wilson and Hilferty 1931: the cube root of a chi-square is close to normal.
      const double w = 2.0 / (9.0 * (k - 1.0)), ratio = image_spread[a][a] / promised_sum[a][a];
      EXPECT_LT(ratio, std::pow(1.0 - w + z_limit * std::sqrt(w), 3)) << a;
      EXPECT_GT(ratio, std::pow(1.0 - w - z_limit * std::sqrt(w), 3)) << a;
    }
}

}  // namespace

TEST(noise_image, renders_of_different_seeds_spread_as_their_moments_promise) {
  std::vector<Replicate> replicates;
  for (int i = 0; i < renders / 2; ++i) {
    World world = room();
    world.seed = static_cast<std::uint64_t>(i);
    replicates.push_back(replicate(render_full(world, samples)));
  }
  expect_consistent(replicates);
}

// What a pass adds is as independent of the passes before as another seed is.
TEST(noise_image, passes_of_one_render_spread_as_their_moments_promise) {
  Scene scene = place_scene(room());
  scene.features = every_feature;
  const Bvh bvh = build_bvh(scene, device().bvh_width);
  Renderer renderer = start_render(device(), scene, bvh);
  std::vector<Replicate> replicates;
  Replicate before;
  for (int i = 0; i < renders; ++i) {
    render_pass(renderer, samples);
    const Replicate now = replicate(read_film(renderer));
    Replicate pass = now;
    for (std::size_t p = 0; i > 0 && p < pass.mean.size(); ++p) {
      pass.mean[p] = now.mean[p] * (i + 1.0) - before.mean[p] * static_cast<double>(i);
      pass.products[p] = now.products[p] * (i + 1.0) - before.products[p] * static_cast<double>(i);
    }
    replicates.push_back(pass);
    before = now;
  }
  expect_consistent(replicates);
}
