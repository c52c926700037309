// How often the test of equality calls images different that are equal, whose replicas have known distributions, and whether it finds
// what is planted.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "../host/equality.h"
#include "random.h"
#include "statistics.h"

using namespace oclair;
using namespace oclair::test;

namespace {

using Law = std::function<double(Random&)>;  // of a replica's mean

double normal(Random& random) {  // Box and Muller 1958
  const double radius = std::sqrt(-2.0 * std::log(1.0 - random.unit()));
  return radius * std::cos(6.283185307179586 * random.unit());
}

const Law gaussian = [](Random& random) { return 10.0 + normal(random); };
const Law exponential = [](Random& random) { return -std::log(1.0 - random.unit()); };
const Law two_values = [](Random& random) { return random.unit() < 0.5 ? 0.5 : 0.75; };  // the edge of a lamp
const Law fireflies = [](Random& random) { return random.unit() < 0.01 ? 100.0 : 0.01 * random.unit(); };

// Mean and standard error of n replicas, as the film has them.
ImagePlanes image(std::uint64_t width, std::uint64_t height, std::uint64_t n, const Law& law, Random& random, double factor = 1.0) {
  ImagePlanes image;
  image.width = width;
  image.height = height;
  image.channels = {"R", "G", "B"};
  image.ranges = {{0, 16 * n}};
  image.seed = std::to_string(random.engine());
  for (std::size_t i = 0; i < 3 * image.pixels(); ++i) {
    double mean = 0.0, squares = 0.0;
    std::vector<double> replicas(n);
    for (double& x : replicas) mean += (x = factor * law(random)) / static_cast<double>(n);
    for (const double x : replicas) squares += (x - mean) * (x - mean);
    image.values.push_back(static_cast<float>(mean));
    image.errors.push_back(static_cast<float>(std::sqrt(squares / static_cast<double>(n * (n - 1)))));
  }
  return image;
}

// Whether a rate of alpha gives so many of the runs, or more, with a probability of at most the significance: the binomial
// distribution, summed from its start.
bool too_many(int found, int runs, double alpha, int comparisons) {
  double below = 0.0, term = std::exp(runs * std::log1p(-alpha));
  for (int k = 0; k < found; ++k) {
    below += term;
    term *= static_cast<double>(runs - k) / (k + 1) * alpha / (1.0 - alpha);
  }
  return 1.0 - below <= significance(comparisons);
}

}  // namespace

TEST(equality_statistics, equal_images_are_called_different_no_oftener_than_the_rate_says) {
  constexpr int runs = 400;
  const std::pair<const char*, Law> laws[] = {
      {"gaussian", gaussian}, {"exponential", exponential}, {"two values", two_values}, {"fireflies", fireflies}};
  Random random(1);
  for (const auto& [name, law] : laws)
    for (const std::uint64_t n : {2u, 4u, 16u}) {
      int at_1e3 = 0, at_5e2 = 0;
      for (int i = 0; i < runs; ++i) {
        const ImagePlanes a = image(12, 9, n, law, random), b = image(12, 9, n, law, random);
        const Equality equality = test_equality(a, b);
        ASSERT_EQ(equality.tests.size(), 4u);
        at_1e3 += equality.differs(1e-3);
        at_5e2 += equality.differs(0.05);
      }
      EXPECT_FALSE(too_many(at_1e3, runs, 1e-3, 24)) << name << ", " << n << " replicas: " << at_1e3;
      EXPECT_FALSE(too_many(at_5e2, runs, 0.05, 24)) << name << ", " << n << " replicas: " << at_5e2;
    }
}

// 3072 values of 16 replicas with deviation 0.1: a difference of 0.5 % of the mean is 10 deviations of the image's mean.
TEST(equality_statistics, a_bias_of_half_a_percent_is_found) {
  Random random(2);
  const Law law = [](Random& r) { return 1.0 + 0.1 * normal(r); };
  const ImagePlanes a = image(32, 32, 16, law, random), b = image(32, 32, 16, law, random, 1.005);
  const Equality equality = test_equality(a, b);
  EXPECT_LT(equality.tests[0].p, 1e-6);
  EXPECT_LT(equality.tests[0].statistic, 0.0);
  EXPECT_TRUE(equality.differs(1e-3));
}

// Half of the picture is brighter and half darker: no mean shows it.
TEST(equality_statistics, a_pattern_without_a_mean_is_found) {
  Random random(3);
  const Law law = [](Random& r) { return 1.0 + 0.1 * normal(r); };
  const ImagePlanes a = image(32, 32, 16, law, random);
  ImagePlanes b = image(32, 32, 16, law, random);
  for (std::size_t i = 0; i < b.values.size(); ++i) b.values[i] += (i / 3 % 32 < 16 ? 0.02f : -0.02f);
  const Equality equality = test_equality(a, b);
  EXPECT_EQ(equality.tests[2].name, "pattern");
  EXPECT_LT(equality.tests[2].p, 1e-4);
}

TEST(equality_statistics, one_pixel_without_noise_that_differs_is_found_with_enough_replicas_only) {
  const Law law = [](Random&) { return 1.0; };
  for (const std::uint64_t n : {2u, 32u}) {
    Random random(4);
    const ImagePlanes a = image(32, 32, n, law, random);
    ImagePlanes b = image(32, 32, n, law, random);
    EXPECT_FALSE(test_equality(a, b).differs(1e-3));
    b.values[300] = 1.001f;
    EXPECT_EQ(test_equality(a, b).differs(1e-3), n == 32u);
  }
}

TEST(equality_statistics, images_that_share_random_numbers_or_differ_in_samplers_are_not_judged_by_single_pixels) {
  Random random(5);
  ImagePlanes a = image(8, 8, 4, gaussian, random), b = a;
  EXPECT_EQ(test_equality(a, b).left_out.size(), 2u);
  EXPECT_FALSE(test_equality(a, b).differs(0.5));
  b.seed = "other";
  EXPECT_TRUE(test_equality(a, b).left_out.empty());
  b.sampler = "sobol";
  EXPECT_EQ(test_equality(a, b).left_out.size(), 2u);
  b.errors.clear();
  EXPECT_EQ(test_equality(a, b).impossible, "no standard errors of the second image");
}

// All sums of signs of 1 to 14 equal numbers, and of a geometric sequence.
TEST(equality_statistics, the_tail_of_sums_of_signs_is_never_less_than_the_exact_one) {
  for (int n = 1; n <= 14; ++n)
    for (const double ratio : {1.0, 0.7}) {
      double squares = 0.0;
      for (int i = 0; i < n; ++i) squares += std::pow(ratio, 2 * i);
      std::vector<double> sums;
      for (unsigned signs = 0; signs < 1u << n; ++signs) {
        double sum = 0.0;
        for (int i = 0; i < n; ++i) sum += (signs >> i & 1u ? 1.0 : -1.0) * std::pow(ratio, i);
        sums.push_back(std::abs(sum) / std::sqrt(squares));
      }
      std::sort(sums.rbegin(), sums.rend());
      for (std::size_t k = 0; k < sums.size(); ++k)
        ASSERT_GE(sign_tail(sums[k] - 1e-9), static_cast<double>(k + 1) / static_cast<double>(sums.size())) << n << " " << sums[k];
    }
}

TEST(equality_statistics, separation_is_two_of_all_ways_to_choose) {
  EXPECT_NEAR(separation_probability(2, 2), 2.0 / 6.0, 1e-14);
  EXPECT_NEAR(separation_probability(3, 5), 2.0 / 56.0, 1e-14);
  EXPECT_NEAR(separation_probability(16, 16) * 601080390.0, 2.0, 1e-10);
}
