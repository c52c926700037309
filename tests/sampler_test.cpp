// The two samplers: where they agree, and that the Sobol one keeps its nets together.
#include <array>
#include <set>

#include "extremes.h"
#include "random.h"
#include "samplers.h"

using namespace oclair;
using namespace oclair::test;

namespace {

// Samples of many pixels, replicas up to the last of 2^33 samples, and dimensions on both sides of the nets' end.
std::vector<SamplerPlace> places() {
  Random random(1);
  const cl_uint dimensions = sobol_dimensions();
  std::vector<SamplerPlace> list;
  for (std::size_t i = 0; i < count_or_small(20000, 50); ++i)
    list.push_back({random.below(1u << 31), random.engine() >> 31,
                    i % 2 ? random.below(2 * dimensions) : random.below(16388)});
  return list;
}

}  // namespace

TEST(sampler_test, independent_numbers_are_those_of_the_path_and_the_dimension) {
  for (const Features features : {every_feature, every_feature & ~FEATURE_SOBOL}) {
    const SamplerBits draw = draw_bits(SAMPLER_INDEPENDENT, 7, places(), features);
    EXPECT_EQ(draw.bits, draw.independent);
  }
}

// In all dimensions the numbers differ in the digits of the net alone, and behind the nets not at all.
TEST(sampler_test, sobol_points_differ_from_independent_ones_in_the_digits_of_the_nets_alone) {
  const std::vector<SamplerPlace> list = places();
  const SamplerBits draw = draw_bits(SAMPLER_SOBOL, 7, list);
  const cl_ulong digits = cl_ulong{0xffffffffu << (32 - REPLICA_BITS)} * 0x100000001u;
  std::size_t different = 0, within = 0;
  for (std::size_t i = 0; i < list.size(); ++i) {
    ASSERT_EQ((draw.bits[i] ^ draw.independent[i]) & ~digits, 0u);
    if (list[i].dimension >= sobol_dimensions()) {
      ASSERT_EQ(draw.bits[i], draw.independent[i]);
    } else {
      ++within;
      different += draw.bits[i] != draw.independent[i];
    }
  }
  EXPECT_GT(different, within * 9 / 10);  // 1 - 2^-8
}

TEST(sampler_test, a_point_is_the_first_24_of_each_32_bits) {
  const std::vector<SamplerPlace> list = places();
  for (const SamplerKind kind : {SAMPLER_INDEPENDENT, SAMPLER_SOBOL}) {
    const std::vector<cl_ulong> bits = draw_bits(kind, 7, list).bits;
    Settings settings{};
    settings.sampler = kind;
    settings.seed = 7;
    std::vector<cl_uint> pixel, dimension;
    std::vector<cl_ulong> sample;
    for (const SamplerPlace& p : list)
      pixel.push_back(p.pixel), sample.push_back(p.sample), dimension.push_back(p.dimension);
    std::vector<std::array<float, 2>> points(list.size());
    run("sampler_test.cl", "points", list.size(), std::vector<Settings>{settings}, pixel, sample, dimension, out(points));
    for (std::size_t i = 0; i < list.size(); ++i) {
      const double x = std::ldexp(static_cast<double>(bits[i] >> 40), -24),
                   y = std::ldexp(static_cast<double>(bits[i] >> 8 & 0xffffff), -24);
      ASSERT_EQ(static_cast<double>(points[i][0]), x);
      ASSERT_EQ(static_cast<double>(points[i][1]), y);
    }
  }
}

// Whatever the replica, pixel, seed and dimension: one point in every elementary interval.
TEST(sampler_test, samples_of_a_replica_are_a_net_in_every_dimension) {
  Random random(2);
  for (cl_uint dimension = 0; dimension < sobol_dimensions(); ++dimension) {
    std::vector<SamplerPlace> list;
    for (std::size_t i = 0; i < count_or_small(200, 2); ++i) {
      const cl_uint pixel = random.below(1u << 31);
      const cl_ulong first = (random.engine() >> 31) & ~cl_ulong{REPLICA_SAMPLES - 1};
      for (cl_uint k = 0; k < REPLICA_SAMPLES; ++k) list.push_back({pixel, first + k, dimension});
    }
    const SamplerBits draw = draw_bits(SAMPLER_SOBOL, 3, list);
    for (std::size_t first = 0; first < list.size(); first += REPLICA_SAMPLES)
      for (int across = 0; across <= REPLICA_BITS; ++across) {
        std::set<cl_uint> cells;
        for (std::size_t i = first; i < first + REPLICA_SAMPLES; ++i)
          cells.insert((net_digits(draw.bits[i], 0) >> (REPLICA_BITS - across)) << (REPLICA_BITS - across) |
                       net_digits(draw.bits[i], 1) >> across);
        ASSERT_EQ(cells.size(), static_cast<std::size_t>(REPLICA_SAMPLES)) << dimension;
      }
  }
  record_law("X23");
}

// 48 bits choose a net: of a few hundred, two of the same would come once in 10^9 suites.
TEST(sampler_test, nets_differ_between_seeds_pixels_replicas_and_dimensions) {
  std::set<std::vector<cl_ulong>> distinct;
  std::size_t count = 0;
  for (const cl_ulong seed : {1, 2}) {
    std::vector<SamplerPlace> list;
    for (const cl_uint pixel : {0u, 1u, 1u << 30})
      for (const cl_ulong first : {cl_ulong{0}, cl_ulong{REPLICA_SAMPLES}, (cl_ulong{1} << 33) - REPLICA_SAMPLES})
        for (cl_uint dimension = 0; dimension < sobol_dimensions(); ++dimension)
          for (cl_uint k = 0; k < REPLICA_SAMPLES; ++k) list.push_back({pixel, first + k, dimension});
    const SamplerBits draw = draw_bits(SAMPLER_SOBOL, seed, list);
    for (std::size_t first = 0; first < list.size(); first += REPLICA_SAMPLES, ++count) {
      std::vector<cl_ulong> net;
      for (std::size_t i = first; i < first + REPLICA_SAMPLES; ++i)
        net.push_back(net_digits(draw.bits[i], 0) << REPLICA_BITS | net_digits(draw.bits[i], 1));
      distinct.insert(net);
    }
  }
  EXPECT_EQ(distinct.size(), count);
}
