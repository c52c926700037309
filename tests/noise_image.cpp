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

// Over all pixels, how the covariance of channels a and b between renders relates to the one that moments promise; and the same for
// the variance of the picture's mean, in which pixels must be independent. A variance of v degrees of freedom has relative deviation
// sqrt(2 / v); the pixels' means are close to normal with 64 samples: 1.3 for what is left.
void expect_consistent(const std::vector<Replicate>& replicates) {
  const double k = static_cast<double>(replicates.size());
  const std::size_t pixels = replicates[0].mean.size();
  for (int a = 0; a < 3; ++a)
    for (int b = a; b < 3; ++b) {
      double promised = 0.0, spread = 0.0;
      std::vector<glm::dvec3> image(replicates.size(), glm::dvec3(0.0));
      for (std::size_t i = 0; i < pixels; ++i) {
        glm::dvec3 mean(0.0);
        for (std::size_t r = 0; r < replicates.size(); ++r) {
          const glm::dvec3& m = replicates[r].mean[i];
          mean += m / k;
          image[r] += m;
          promised += (replicates[r].products[i][a][b] - m[a] * m[b]) / (samples - 1.0) / k;
        }
        for (const Replicate& r : replicates) spread += (r.mean[i][a] - mean[a]) * (r.mean[i][b] - mean[b]) / (k - 1.0);
      }
      EXPECT_NEAR(spread / promised, 1.0, z_limit * 1.3 * std::sqrt(2.0 / ((k - 1.0) * static_cast<double>(pixels)))) << a << b;
      glm::dvec3 middle(0.0);
      for (const glm::dvec3& m : image) middle += m / k;
      double image_spread = 0.0;
      for (const glm::dvec3& m : image) image_spread += (m[a] - middle[a]) * (m[b] - middle[b]) / (k - 1.0);
      // Wilson and Hilferty 1931: the cube root of a chi-square is close to normal.
      const double w = 2.0 / (9.0 * (k - 1.0));
      EXPECT_LT(image_spread / promised, std::pow(1.0 - w + z_limit * std::sqrt(w), 3)) << a << b;
      EXPECT_GT(image_spread / promised, std::pow(1.0 - w - z_limit * std::sqrt(w), 3)) << a << b;
    }
}

}  // namespace

TEST(noise_image, renders_of_different_seeds_spread_as_their_moments_promise) {
  std::vector<Replicate> replicates;
  for (int i = 0; i < renders; ++i) {
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
