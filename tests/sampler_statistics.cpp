// Each Sobol point is uniform, and nets know nothing of each other; the kernels are those of sampler_test.
#include <functional>

#include "samplers.h"
#include "statistics.h"

using namespace oclair;
using namespace oclair::test;

namespace {

const std::size_t pixels = count_or_small(1 << 16, 64);

std::vector<cl_ulong> draw(const std::function<SamplerPlace(cl_uint pixel)>& place) {
  std::vector<SamplerPlace> places;
  for (cl_uint pixel = 0; pixel < pixels; ++pixel) places.push_back(place(pixel));
  return draw_bits(SAMPLER_SOBOL, 11, places).bits;
}

// Cells of the digits of a and b: 16 x 16.
double joint_uniformity(const std::vector<cl_ulong>& a, int of_a, const std::vector<cl_ulong>& b, int of_b) {
  std::vector<double> cells(REPLICA_SAMPLES * REPLICA_SAMPLES);
  for (std::size_t i = 0; i < a.size(); ++i) ++cells[net_digits(a[i], of_a) * REPLICA_SAMPLES + net_digits(b[i], of_b)];
  return uniformity_test(cells);
}

}  // namespace

// Over pixels, for the first, a middle and the last sample of a replica, in cells finer than the net's.
TEST(sampler_statistics, every_sobol_point_is_uniform) {
  const std::vector<cl_ulong> samples{0, 5, REPLICA_SAMPLES - 1, (cl_ulong{1} << 33) - 1};
  const double least = significance(static_cast<double>(sobol_dimensions() * samples.size()));
  for (cl_uint dimension = 0; dimension < sobol_dimensions(); ++dimension)
    for (const cl_ulong sample : samples) {
      std::vector<double> cells(64 * 64);
      for (const cl_ulong bits : draw([&](cl_uint pixel) { return SamplerPlace{pixel, sample, dimension}; }))
        ++cells[(bits >> 58) * 64 + (bits >> 26 & 63)];
      EXPECT_GT(uniformity_test(cells), least) << "dimension " << dimension << ", sample " << sample;
    }
}

// A sample's place in one net and its, or another's, in the net beside.
TEST(sampler_statistics, nets_of_neighbouring_dimensions_replicas_and_pixels_are_independent) {
  const auto here = draw([](cl_uint pixel) { return SamplerPlace{2 * pixel, 5, 2}; });
  const std::vector<std::pair<const char*, std::vector<cl_ulong>>> others{
      {"next dimension", draw([](cl_uint pixel) { return SamplerPlace{2 * pixel, 5, 3}; })},
      {"next vertex", draw([](cl_uint pixel) { return SamplerPlace{2 * pixel, 5, 6}; })},
      {"next dimension, another sample", draw([](cl_uint pixel) { return SamplerPlace{2 * pixel, 4, 3}; })},
      {"next dimension, farthest sample", draw([](cl_uint pixel) { return SamplerPlace{2 * pixel, 13, 3}; })},
      {"next replica", draw([](cl_uint pixel) { return SamplerPlace{2 * pixel, 5 + REPLICA_SAMPLES, 2}; })},
      {"late replica", draw([](cl_uint pixel) { return SamplerPlace{2 * pixel, 5 + (cl_ulong{1} << 32), 2}; })},
      {"next pixel", draw([](cl_uint pixel) { return SamplerPlace{2 * pixel + 1, 5, 2}; })}};
  const double least = significance(4.0 * static_cast<double>(others.size()));
  for (const auto& [name, other] : others)
    for (int a = 0; a < 2; ++a)
      for (int b = 0; b < 2; ++b) EXPECT_GT(joint_uniformity(here, a, other, b), least) << name << " " << a << b;
}

// Whether two samples lie in the same half of one net and of another. Were the points of both in the same order, it would be
// always, or never.
TEST(sampler_statistics, order_of_a_net_says_nothing_of_the_order_of_another) {
  for (const cl_ulong sample : {1, 7, 13})
    for (const cl_uint dimension : {3u, 4u, 6u})
      for (int a = 0; a < 2; ++a)
        for (int b = 0; b < 2; ++b) {
          const auto together = [&](cl_uint in, int coordinate) {
            const auto one = draw([in](cl_uint pixel) { return SamplerPlace{pixel, 5, in}; });
            const auto other = draw([in, sample](cl_uint pixel) { return SamplerPlace{pixel, sample, in}; });
            std::vector<double> same(pixels);
            for (std::size_t i = 0; i < pixels; ++i)
              same[i] = ((net_digits(one[i], coordinate) ^ net_digits(other[i], coordinate)) & (REPLICA_SAMPLES / 2)) == 0;
            return same;
          };
          const double z = correlation(together(2, a), together(dimension, b)) * std::sqrt(static_cast<double>(pixels));
          EXPECT_GT(normal_tails(z), significance(36)) << "sample " << sample << ", dimension " << dimension << ", " << a << b;
        }
}

// Of two points, the first four of those digits.
TEST(sampler_statistics, digits_beyond_the_net_are_independent_between_the_points_of_a_replica) {
  const auto a = draw([](cl_uint pixel) { return SamplerPlace{pixel, 5, 2}; });
  for (const cl_ulong sample : {4, 1, 13}) {
    const auto b = draw([sample](cl_uint pixel) { return SamplerPlace{pixel, sample, 2}; });
    std::vector<double> cells(256);
    for (std::size_t i = 0; i < a.size(); ++i)
      ++cells[(a[i] >> (60 - REPLICA_BITS) & 15) * 16 + (b[i] >> (60 - REPLICA_BITS) & 15)];
    EXPECT_GT(uniformity_test(cells), significance(3)) << sample;
  }
}
