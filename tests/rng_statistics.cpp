// Numbers of neighbouring pixels, samples, dimensions and seeds must look independent; the kernels are those of rng_test.cl.
#include <functional>

#include "extremes.h"
#include "kernel.h"
#include "statistics.h"

using namespace oclair::test;

namespace {

constexpr std::size_t side = 1024;        // streams are the pixels of a frame of this width,
const std::size_t samples = count_or_small(4, 1);  // each with so many samples
const std::size_t rows = count_or_small(256, 1);

struct Place {
  cl_ulong seed, sample;
  cl_uint pixel, dimension;
};

struct Numbers {
  std::vector<float> x, y;
};

// One draw for every stream, after `move` has turned its place into another.
Numbers draw(const std::function<void(Place&)>& move) {
  std::vector<cl_ulong> seed, sample;
  std::vector<cl_uint> pixel, dimension;
  for (std::size_t p = 0; p < side * rows; ++p)
    for (std::size_t s = 0; s < samples; ++s) {
      Place place{1, s, static_cast<cl_uint>(p), 0};
      move(place);
      seed.push_back(place.seed), sample.push_back(place.sample);
      pixel.push_back(place.pixel), dimension.push_back(place.dimension);
    }
  const std::size_t count = seed.size();
  std::vector<cl_ulong> keys(count), bits(count);
  std::vector<cl_float2> points(count);
  run("rng_test.cl", "key", count, seed, pixel, sample, out(keys));
  run("rng_test.cl", "draw", count, keys, dimension, out(bits), out(points));
  Numbers numbers;
  for (const cl_float2& point : points) numbers.x.push_back(point.s[0]), numbers.y.push_back(point.s[1]);
  return numbers;
}

double uniformity(const std::vector<float>& x) {
  std::vector<double> bins(1024);
  for (float u : x) ++bins[static_cast<std::size_t>(u * 1024)];
  return uniformity_test(bins);
}

double joint_uniformity(const std::vector<float>& x, const std::vector<float>& y) {
  std::vector<double> bins(64 * 64);
  for (std::size_t i = 0; i < x.size(); ++i) ++bins[static_cast<std::size_t>(x[i] * 64) * 64 + static_cast<std::size_t>(y[i] * 64)];
  return uniformity_test(bins);
}

// What a neighbour can be.
const std::vector<std::pair<const char*, std::function<void(Place&)>>>& neighbours() {
  static const std::vector<std::pair<const char*, std::function<void(Place&)>>> list{
      {"right pixel", [](Place& p) { p.pixel += 1; }},
      {"pixel below", [](Place& p) { p.pixel += side; }},
      {"far pixel", [](Place& p) { p.pixel += 1u << 30; }},
      {"next sample", [](Place& p) { p.sample += samples; }},
      {"late sample", [](Place& p) { p.sample += cl_ulong{1} << 32; }},
      {"next dimension", [](Place& p) { p.dimension += 1; }},
      {"eighth dimension", [](Place& p) { p.dimension += 8; }},
      {"late dimension", [](Place& p) { p.dimension += 4096; }},
      {"next seed", [](Place& p) { p.seed += 1; }},
      {"seed of another top bit", [](Place& p) { p.seed ^= cl_ulong{1} << 63; }},
  };
  return list;
}

}  // namespace

TEST(rng_statistics, every_dimension_is_uniform) {
  const cl_uint dimensions = 16;
  for (cl_uint d = 0; d < dimensions; ++d) {
    const Numbers numbers = draw([d](Place& p) { p.dimension = d; });
    EXPECT_GT(uniformity(numbers.x), significance(2 * dimensions)) << "x of dimension " << d;
    EXPECT_GT(uniformity(numbers.y), significance(2 * dimensions)) << "y of dimension " << d;
  }
}

TEST(rng_statistics, every_neighbour_is_uniform) {
  for (const auto& [name, move] : neighbours()) {
    const Numbers numbers = draw(move);
    EXPECT_GT(uniformity(numbers.x), significance(20)) << name;
    EXPECT_GT(uniformity(numbers.y), significance(20)) << name;
  }
}

TEST(rng_statistics, points_fill_the_square) {
  for (cl_uint d = 0; d < 16; ++d) {
    const Numbers numbers = draw([d](Place& p) { p.dimension = d; });
    EXPECT_GT(joint_uniformity(numbers.x, numbers.y), significance(16)) << "dimension " << d;
  }
}

TEST(rng_statistics, neighbours_are_independent_of_each_other) {
  const Numbers here = draw([](Place&) {});
  for (const auto& [name, move] : neighbours()) {
    const Numbers there = draw(move);
    EXPECT_GT(joint_uniformity(here.x, there.x), significance(40)) << name;
    EXPECT_GT(joint_uniformity(here.y, there.y), significance(40)) << name;
    EXPECT_GT(joint_uniformity(here.x, there.y), significance(40)) << name;
    EXPECT_GT(joint_uniformity(here.y, there.x), significance(40)) << name;
  }
}

// r sqrt(n) of independent numbers is normal with variance 1: at the false-alarm rate of 40 comparisons, |r| < 5 / sqrt n.
TEST(rng_statistics, neighbours_are_uncorrelated) {
  const Numbers here = draw([](Place&) {});
  const double root = std::sqrt(static_cast<double>(here.x.size()));
  for (const auto& [name, move] : neighbours()) {
    const Numbers there = draw(move);
    for (const auto* a : {&here.x, &here.y})
      for (const auto* b : {&there.x, &there.y})
        EXPECT_GT(normal_tails(correlation(*a, *b) * root), significance(40)) << name;
  }
  record_law("X22");
}

// Along a row of pixels, one sample: neighbours of one stream of calls, whose lattice a weak generator shows in three dimensions.
TEST(rng_statistics, three_successive_pixels_fill_the_cube) {
  const Numbers numbers = draw([](Place&) {});
  std::vector<double> bins(16 * 16 * 16);
  for (std::size_t i = 0; i + 2 * samples < numbers.x.size(); i += 3 * samples) {
    const auto bin = [&](std::size_t k) { return static_cast<std::size_t>(numbers.x[i + k * samples] * 16); };
    ++bins[(bin(0) * 16 + bin(1)) * 16 + bin(2)];
  }
  EXPECT_GT(uniformity_test(bins), false_alarm);
}
