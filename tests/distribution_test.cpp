// Choosing an item: which one, where in its share, with what probability, against integers on the host.
#include "../host/distribution.h"
#include "kernel.h"
#include "random.h"
#include "statistics.h"

using namespace oclair;
using namespace oclair::test;

namespace {

struct Choices {
  std::vector<cl_uint> which;
  std::vector<float> rest, probability;
};

Choices choose(const std::vector<uint>& cdf, const std::vector<cl_uint>& bits) {
  Choices c{std::vector<cl_uint>(bits.size()), std::vector<float>(bits.size()), std::vector<float>(bits.size())};
  run("distribution_test.cl", "choose", bits.size(), cdf, static_cast<cl_uint>(cdf.size()), bits, out(c.which), out(c.rest), out(c.probability));
  return c;
}

// Interval [begin, end) of item i; the last one ends at 2^32.
std::uint64_t begin_of(const std::vector<uint>& cdf, std::size_t i) { return i == 0 ? 0 : cdf[i - 1]; }
std::uint64_t end_of(const std::vector<uint>& cdf, std::size_t i) { return i + 1 == cdf.size() ? std::uint64_t{1} << 32 : cdf[i]; }

std::vector<std::vector<uint>> tables() {
  Random random(11);
  std::vector<std::vector<uint>> all = {{0xffffffffu}, {1u, 0xffffffffu}, {0x80000000u, 0xffffffffu}, {0xffffffffu, 0xffffffffu}, {3u, 4u, 5u, 0xffffffffu},
                                        {0u, 7u, 7u, 7u, 0xffffffffu}};
  for (const int n : {2, 3, 5, 17, 64, 1000}) {
    std::vector<double> weights(static_cast<std::size_t>(n));
    for (double& w : weights) w = random.unit() < 0.2 ? 0.0 : random.log_between(1e-12, 1e3);
    weights[0] = 1.0;
    all.push_back(distribution(weights));
  }
  return all;
}

}  // namespace

// At both ends of every interval and at random between; rest = (bits - begin + 1/2) / width with three roundings, below 1.
TEST(distribution_test, an_item_is_chosen_by_the_numbers_of_its_interval_and_the_rest_is_the_place_in_it) {
  Random random(1);
  for (const std::vector<uint>& cdf : tables()) {
    std::vector<cl_uint> bits = {0u, 0xffffffffu};
    for (std::size_t i = 0; i < cdf.size(); ++i) {
      const std::uint64_t begin = begin_of(cdf, i), end = end_of(cdf, i);
      if (begin == end) continue;
      for (const std::uint64_t b : {begin, end - 1, begin + random.engine() % (end - begin)}) bits.push_back(static_cast<cl_uint>(b));
    }
    const Choices c = choose(cdf, bits);
    for (std::size_t k = 0; k < bits.size(); ++k) {
      std::size_t i = 0;
      while (bits[k] >= end_of(cdf, i)) ++i;
      ASSERT_EQ(c.which[k], i) << bits[k];
      const double begin = static_cast<double>(begin_of(cdf, i)), width = static_cast<double>(end_of(cdf, i)) - begin;
      const double rest = (bits[k] - begin + 0.5) / width;
      EXPECT_NEAR(c.rest[k], rest, 4 * unit_roundoff * rest);
      EXPECT_GT(c.rest[k], 0.0f);
      EXPECT_LT(c.rest[k], 1.0f);
      EXPECT_NEAR(c.probability[k], std::ldexp(width, -32), unit_roundoff * std::ldexp(width, -32));
    }
  }
}

// 2^8 intervals of 2^24 and less: all 2^16 numbers with the low bits 0 and with the low bits set.
TEST(distribution_test, numbers_from_end_to_end_choose_in_the_order_of_the_items) {
  Random random(2);
  std::vector<double> weights(256);
  for (double& w : weights) w = random.unit();
  const std::vector<uint> cdf = distribution(weights);
  const std::size_t n = count_or_small(65536, 256);
  std::vector<cl_uint> bits;
  for (std::size_t i = 0; i < n; ++i) bits.insert(bits.end(), {static_cast<cl_uint>(i * (0x100000000ull / n)), static_cast<cl_uint>((i + 1) * (0x100000000ull / n) - 1)});
  const Choices c = choose(cdf, bits);
  for (std::size_t k = 0; k < bits.size(); ++k)
    ASSERT_EQ(c.which[k], static_cast<cl_uint>(std::upper_bound(cdf.begin(), cdf.end() - 1, bits[k]) - cdf.begin()));
}

TEST(distribution_test, widths_are_those_of_the_intervals_and_add_up_to_two_to_the_32) {
  for (const std::vector<uint>& cdf : tables()) {
    std::vector<cl_ulong> width(cdf.size());
    run("distribution_test.cl", "widths", cdf.size(), cdf, out(width));
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < cdf.size(); ++i) {
      EXPECT_EQ(width[i], end_of(cdf, i) - begin_of(cdf, i));
      sum += width[i];
    }
    EXPECT_EQ(sum, std::uint64_t{1} << 32);
  }
}

TEST(distribution_test, an_item_of_weight_zero_has_one_unit_and_no_more) {
  const std::vector<uint> cdf = distribution({0.0, 1.0, 0.0, 0.0, 3.0, 0.0});
  for (const std::size_t i : {0, 2, 3}) EXPECT_EQ(end_of(cdf, i) - begin_of(cdf, i), 1u) << i;
  EXPECT_LE(end_of(cdf, 5) - begin_of(cdf, 5), 2u);
}
