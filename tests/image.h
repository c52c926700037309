// What the image tests share: renders by the kernel with every feature (one compilation for all of them; that specialised kernels
// give the same bits is a law of metamorphic_image), and how a mean is judged.
#pragma once

#include <cstdio>

#include "statistics.h"
#include "worlds.h"

namespace oclair::test {

inline constexpr double unit_roundoff = 0x1p-24;

// Two-sided false-alarm rate of 2e-5 for one judgement: 1e-3 for a family of 50 (Sidak).
inline constexpr double z_limit = sidak_z;
// A bias of (z_limit + 1.28) standard errors is found with a probability of 90 %.
inline constexpr double z_power = z_limit + 1.28;

inline Film render_scene(Scene scene, uint samples, int bvh_width = 0) {
  const Bvh bvh = build_bvh(scene, bvh_width ? bvh_width : device().bvh_width);
  Renderer renderer = start_render(device(), scene, bvh);
  render_pass(renderer, samples);
  return read_film(renderer);
}

// With second moments, whatever the world asks for.
inline Film render_full(const World& world, uint samples) {
  Scene scene = place_scene(world);
  scene.features = every_feature;
  return render_scene(scene, samples);
}

// Mean over all pixels of one channel, and its standard error from the spread of the samples within each pixel: what differs
// between pixels is no error.
inline Estimate estimate(const Film& film, int channel = 0) {
  double sum = 0.0, variance = 0.0;
  for (std::size_t i = 0; i < film.pixels.size(); ++i) {
    const double mean = pixel_mean(film, i)[channel];
    const double n = static_cast<double>(film.samples - film.pixels[i].rejected);
    sum += mean;
    variance += std::max(0.0, pixel_mean_products(film, i)[channel][channel] - mean * mean) / (n - 1.0);
  }
  const double pixels = static_cast<double>(film.pixels.size());
  return {sum / pixels, std::sqrt(variance) / pixels};
}

// Relative standard deviation of one sample.
inline double relative_deviation(const Film& film, int channel = 0) {
  const Estimate e = estimate(film, channel);
  return e.error / e.mean * std::sqrt(static_cast<double>(film.samples * film.pixels.size()));
}

// The mean is exact within the noise, and the noise is small enough to find a relative bias of `finds`. Rounding: a sample sums
// some tens of float32 roundings, below 64 u.
// Returns how many standard errors it is off beyond them.
inline double expect_mean(const Film& film, double exact, double finds = 0.005, int channel = 0) {
  EXPECT_EQ(rejected_samples(film), 0u);
  const Estimate e = estimate(film, channel);
  EXPECT_NEAR(e.mean, exact, z_limit * e.error + 64 * unit_roundoff * exact) << "z = " << (e.mean - exact) / e.error;
  EXPECT_LE(z_power * e.error, finds * exact) << "too few samples: standard error " << e.error / exact << " of the mean";
  const double beyond = std::abs(e.mean - exact) - 64 * unit_roundoff * exact;
  return beyond > 0.0 ? beyond / e.error : 0.0;
}

// Every sample of every pixel is the same number to within `relative`. Returns how far the mean of a pixel is off, relative
// too.
inline double expect_every_sample(const Film& film, double exact, double relative, int channel = 0) {
  EXPECT_EQ(rejected_samples(film), 0u);
  double low = 1e300, high = -1e300, spread = 0.0;
  for (std::size_t i = 0; i < film.pixels.size(); ++i) {
    const double mean = pixel_mean(film, i)[channel];
    low = std::min(low, mean);
    high = std::max(high, mean);
    spread = std::max(spread, pixel_mean_products(film, i)[channel][channel] - mean * mean);
  }
  EXPECT_GE(low, exact * (1.0 - relative));
  EXPECT_LE(high, exact * (1.0 + relative));
  // The mean square is rounded to double, and holds its samples to 2^-38 of the film's scale.
  EXPECT_LE(spread, exact * exact * (relative * relative + 1e-15));
  return std::max(exact - low, high - exact) / exact;
}

// A narrow view: all rays start at `from` and meet within a square of half width 1e-5 |to - from| around `to`; over it any
// smooth function is its value at the middle to 1e-10.
inline void look_closely(World& world, glm::dvec3 from, glm::dvec3 to, uint width = 32, uint height = 16) {
  const glm::dvec3 d = glm::normalize(to - from);
  const glm::dvec3 up = std::abs(d.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
  look(world, from, to, up, 1e-5, width, height);
  world.camera.near_clip = 1e-6 * glm::length(to - from);
}

inline WorldLight& add_light(World& world, LightKind kind, glm::dvec3 value, glm::dvec3 position = {}) {
  WorldLight& light = world.lights.emplace_back();
  light.kind = kind;
  light.value = value;
  light.position = position;
  return light;
}

inline WorldShape& add_sphere(World& world, const Material& front, Sides sides, glm::dvec3 center, double radius, double radiance = 0.0) {
  WorldShape& shape = add_shape(world, front, sides, radiance);
  shape.geometry = Geometry::sphere;
  shape.to_world = glm::dmat4(glm::dvec4(radius, 0, 0, 0), glm::dvec4(0, radius, 0, 0), glm::dvec4(0, 0, radius, 0), glm::dvec4(center, 1));
  return shape;
}

// A shape that absorbs everything on both sides, and emits on its front if radiance > 0.
inline WorldShape& add_black(World& world, glm::dvec3 radiance = glm::dvec3(0.0)) {
  WorldShape& shape = world.shapes.emplace_back();
  if (radiance != glm::dvec3(0.0)) shape.radiance = radiance;
  return shape;
}

inline constexpr uint no_roulette = 1u << 30;

}  // namespace oclair::test
