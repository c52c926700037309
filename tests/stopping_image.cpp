// The stopping rule on real renders whose every pixel is known in closed form: how often is the certified error not kept?
#include <array>

#include "../host/stopping.h"
#include "image.h"

using namespace oclair;
using namespace oclair::test;

namespace {

constexpr double confidence = 0.95;

// Form factor of a point to a rectangle a x b parallel to it at distance 1, one corner straight above it (Howell, Menguc, Daun,
// Siegel 2020, C-12).
double corner_factor(double a, double b) {
  const double x = std::sqrt(1.0 + a * a), y = std::sqrt(1.0 + b * b);
  return (a / x * std::atan(b / x) + b / y * std::atan(a / y)) / (2.0 * glm::pi<double>());
}

// A plate of albedo 1/2 below a square light of radiance 1 and side 1 at distance 1; the camera between them sees the plate from
// -half to half in both directions.
constexpr uint side = 16;
constexpr double half = 0.4;

World plate() {
  World world;
  add_quad(add_shape(world, diffuse(0.5), Sides::front).mesh, {-2, -2, 0}, {4, 0, 0}, {0, 4, 0});
  add_quad(add_black(world, glm::dvec3(1.0)).mesh, {-0.5, -0.5, 1}, {0, 1, 0}, {1, 0, 0});
  look(world, {0, 0, 0.5}, {0, 0, 0}, {0, 1, 0}, half / 0.5, side, side);
  world.integrator.max_depth = 2;
  return world;
}

// The mean over each pixel by the midpoint rule. The plate looks the same from all four sides, so that the camera's orientation does
// not matter.
std::vector<double> plate_truth() {
  constexpr int n = 8;
  std::vector<double> truth;
  for (uint j = 0; j < side; ++j)
    for (uint i = 0; i < side; ++i) {
      double sum = 0.0;
      for (int k = 0; k < n * n; ++k) {
        const double x = half * (2.0 * (i + (k % n + 0.5) / n) / side - 1.0), y = half * (2.0 * (j + (k / n + 0.5) / n) / side - 1.0);
        for (const double a : {0.5 - x, 0.5 + x})
          for (const double b : {0.5 - y, 0.5 + y}) sum += 0.5 * corner_factor(a, b) / (n * n);
      }
      truth.push_back(sum);
    }
  return truth;
}

// A closed room that emits 1 everywhere: radiance 1 / (1 - albedo). Its only noise is Russian roulette.
World furnace() {
  World world;
  add_box(add_shape(world, diffuse(0.5), Sides::front, 1.0).mesh, {-1, -1, -1}, {1, 1, 1}, true);
  look(world, {0.1, 0.2, 0.3}, {1, 0.5, 0.2}, {0, 1, 0}, 1.0, side, side);
  world.integrator.rr_depth = 1;
  return world;
}

double error(const Film& film, const std::vector<double>& truth) {
  double mean = 0.0, sum = 0.0;
  for (const double t : truth) mean += t / static_cast<double>(truth.size());
  for (std::size_t p = 0; p < truth.size(); ++p) {
    const auto x = pixel_mean(film, p);
    double squares = 0.0;
    for (int c = 0; c < 3; ++c) squares += (x[c] - truth[p]) * (x[c] - truth[p]);
    sum += squares / (3.0 * (truth[p] * truth[p] + 0.01 * mean * mean));
  }
  return std::sqrt(sum / static_cast<double>(truth.size()));
}

// Renders until the monitor is content, with so many seeds. If each render breaks its promise with a probability of 5 %, then k or
// more of n do so with a probability of exp(-n KL(k / n, 0.05)) at most (Chernoff 1952).
void expect_kept(World world, SamplerKind sampler, const std::vector<double>& truth, double target, int renders) {
  world.sampler = sampler;
  int missed = 0;
  double samples = 0.0, errors = 0.0;
  for (int r = 0; r < renders; ++r) {
    Scene scene = place_scene(world);
    scene.features = every_feature;
    scene.settings.seed = 100 + static_cast<ulong>(r);
    const Bvh bvh = build_bvh(scene, device().bvh_width);
    Renderer renderer = start_render(device(), scene, bvh);
    ErrorMonitor monitor(target, confidence);
    Film film;
    while (!monitor.certified() && renderer.samples < 100000) {
      render_pass(renderer, ErrorMonitor::usual_block);
      film = read_film(renderer);
      monitor.add(film);
    }
    ASSERT_TRUE(monitor.certified()) << monitor.why_not();
    const double e = error(film, truth);
    missed += e > target;
    samples += static_cast<double>(film.samples) / renders;
    errors += e / renders;
  }
  std::printf("%s sampler, error %g: of %d renders %d missed, mean error %.4g, mean samples per pixel %.0f\n",
              sampler == SAMPLER_SOBOL ? "Sobol" : "independent", target, renders, missed, errors, samples);
  const double n = renders, share = missed / n, promised = 1.0 - confidence;
  if (share > promised) {
    const double divergence = share * std::log(share / promised) + (1.0 - share) * std::log((1.0 - share) / (1.0 - promised));
    EXPECT_GT(std::exp(-n * divergence), false_alarm) << missed << " missed";
  }
  // And the bound is not idle. With weighted variances in the pixels that differ by a factor of 4 at most, Y deviates by
  // s <= sqrt(2 4/256) = 0.18 of V; after the fewest pairs, 16, the sequence is 0.83 s wide, the deviation of the picture
  // counts sqrt(2 3.7) s and its largest pixel 2 3.7 4/256: the bound is the root of 1.76 times the expectation at most,
  // whose root the errors have to 1 % in the mean of all renders.
  EXPECT_GT(errors, 0.7 * target) << "a rule that waits for so long is of no use";
}

}  // namespace

TEST(stopping_image, a_plate_below_a_square_light_has_the_error_that_was_certified) {
  expect_kept(plate(), SAMPLER_INDEPENDENT, plate_truth(), 0.012, 100);
}

// With fewer samples, as the sampler's error is smaller: replicas, not samples, are what is independent.
TEST(stopping_image, the_plate_rendered_by_sobol_points_has_the_error_that_was_certified) {
  expect_kept(plate(), SAMPLER_SOBOL, plate_truth(), 0.006, 100);
}

TEST(stopping_image, a_furnace_with_roulette_has_the_error_that_was_certified) {
  expect_kept(furnace(), SAMPLER_INDEPENDENT, std::vector<double>(std::size_t{side} * side, 2.0), 0.028, 100);
}
