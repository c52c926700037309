// How often the test of equality calls images different that are equal, whose replicas have known distributions, and whether
// it finds what is planted.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>

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

// Mean and standard error of replicas that each value has, as the film has them.
ImagePlanes image(std::uint64_t width, std::uint64_t height, std::uint64_t n, const std::string& seed,
                  const std::function<double(std::size_t value, std::size_t replica)>& replica) {
  ImagePlanes image;
  image.width = width;
  image.height = height;
  image.channels = {"R", "G", "B"};
  image.ranges = {{0, 16 * n}};
  image.seed = seed;
  for (std::size_t i = 0; i < 3 * image.pixels(); ++i) {
    double mean = 0.0, squares = 0.0;
    std::vector<double> replicas(n);
    for (std::size_t k = 0; k < n; ++k) mean += (replicas[k] = replica(i, k)) / static_cast<double>(n);
    for (const double x : replicas) squares += (x - mean) * (x - mean);
    image.values.push_back(static_cast<float>(mean));
    image.errors.push_back(static_cast<float>(std::sqrt(squares / static_cast<double>(n * (n - 1)))));
  }
  return image;
}

ImagePlanes image(std::uint64_t width, std::uint64_t height, std::uint64_t n, const Law& law, Random& random,
                  double factor = 1.0) {
  return image(width, height, n, std::to_string(random.engine()),
               [&](std::size_t, std::size_t) { return factor * law(random); });
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

struct Counts {
  std::uint64_t a, b;  // replicas
};

// How often they are called different, out of so many runs, must not be more often than the rates say.
void expect_few_alarms(const std::vector<std::pair<const char*, Law>>& laws, const std::vector<Counts>& counts,
                       std::size_t tests, const std::string& other_sampler, std::uint64_t seed) {
  constexpr int runs = 400;
  const int comparisons = static_cast<int>(2 * laws.size() * counts.size());
  Random random(seed);
  for (const auto& [name, law] : laws)
    for (const auto& [na, nb] : counts) {
      int at_1e3 = 0, at_5e2 = 0;
      for (int i = 0; i < runs; ++i) {
        const ImagePlanes a = image(12, 9, na, law, random);
        ImagePlanes b = image(12, 9, nb, law, random);
        b.sampler = other_sampler;
        const Equality equality = test_equality(a, b);
        ASSERT_EQ(equality.tests.size(), tests);
        ASSERT_EQ(equality.approximate.empty(), other_sampler.empty()) << equality.approximate;
        at_1e3 += equality.differs(1e-3);
        at_5e2 += equality.differs(0.05);
      }
      EXPECT_FALSE(too_many(at_1e3, runs, 1e-3, comparisons))
          << name << ", " << na << " and " << nb << " replicas: " << at_1e3;
      EXPECT_FALSE(too_many(at_5e2, runs, 0.05, comparisons))
          << name << ", " << na << " and " << nb << " replicas: " << at_5e2;
    }
}

const std::vector<std::pair<const char*, Law>> laws = {
    {"gaussian", gaussian}, {"exponential", exponential}, {"two values", two_values}, {"fireflies", fireflies}};

}  // namespace

TEST(equality_statistics, equal_images_are_called_different_no_oftener_than_the_rate_says) {
  expect_few_alarms(laws, {{2, 2}, {4, 4}, {16, 16}}, 4, "", 1);
}

// With fireflies a normal approximation calls 28 of 100 pairs of 2 and 32 replicas different at the rate 1e-3: there the
// image of fewer samples often has none.
TEST(equality_statistics, nor_are_equal_images_of_different_numbers_of_samples) {
  expect_few_alarms(laws, {{2, 32}, {4, 5}, {16, 2}}, 3, "", 6);
}

TEST(equality_statistics, nor_are_images_of_unlike_samplers_whose_means_are_nearly_normal) {
  expect_few_alarms({{"gaussian", gaussian}, {"two values", two_values}}, {{2, 2}, {4, 16}, {16, 16}}, 2, "another", 7);
}

// The replicas of four values of a row of pixels are given. Of all ways to tell which of them are A's, a share of p at most
// may have the bound p, for each test: with as many in B 6^4 ways, else 10^4.
TEST(equality_statistics, of_all_ways_to_draw_the_replicas_a_share_of_p_at_most_has_the_bound_p) {
  constexpr std::size_t pixels = 4;
  Random random(8);
  for (const std::size_t nb : {2u, 3u})
    for (const Law& law :
         {gaussian, two_values, fireflies, Law([](Random& r) { return r.unit() < 0.3 ? 50.0 + r.unit() : r.unit(); })}) {
      std::vector<double> pool(3 * pixels * (2 + nb));
      for (double& value : pool) value = law(random);
      std::vector<std::pair<std::size_t, std::size_t>> draws;  // the two of A
      for (std::size_t i = 0; i < 2 + nb; ++i)
        for (std::size_t j = i + 1; j < 2 + nb; ++j) draws.emplace_back(i, j);
      std::map<std::string, std::vector<double>> bounds;
      const std::size_t ways = static_cast<std::size_t>(std::pow(draws.size(), pixels) + 0.5);
      for (std::size_t way = 0; way < ways; ++way) {
        const auto draw_of = [&](std::size_t value) {
          std::size_t rest = way;
          for (std::size_t pixel = value / 3; pixel > 0; --pixel) rest /= draws.size();
          return draws[rest % draws.size()];
        };
        const auto drawn = [&](std::size_t value, std::size_t k) {
          const auto [i, j] = draw_of(value);
          return pool[value * (2 + nb) + (k == 0 ? i : j)];
        };
        const auto left = [&](std::size_t value, std::size_t k) {
          const auto [i, j] = draw_of(value);
          for (std::size_t at = 0;; ++at)
            if (at != i && at != j && k-- == 0) return pool[value * (2 + nb) + at];
        };
        const Equality equality = test_equality(image(pixels, 1, 2, "1", drawn), image(pixels, 1, nb, "2", left));
        for (const EqualityTest& test : equality.tests) bounds[test.name].push_back(test.p);
        bounds["all"].push_back(equality.p);
      }
      for (auto& [name, p] : bounds) {
        ASSERT_EQ(p.size(), ways);
        std::sort(p.begin(), p.end());
        for (std::size_t k = 0; k < ways; ++k)
          ASSERT_GE(p[k] * (1.0 + 1e-6), static_cast<double>(k + 1) / static_cast<double>(ways)) << name << ", " << nb;
      }
    }
}

// Of the ten ways to draw two of five replicas, the standard deviation of the difference of means.
TEST(equality_statistics, with_different_numbers_a_difference_is_in_units_of_its_deviation_over_all_draws) {
  const std::vector<double> pool = {1.0, 4.0, 2.0, 8.0, 16.0};
  double squares = 0.0;
  const double sum = std::accumulate(pool.begin(), pool.end(), 0.0);
  const auto difference = [&](std::size_t i, std::size_t j) {
    return (pool[i] + pool[j]) / 2.0 - (sum - pool[i] - pool[j]) / 3.0;
  };
  for (std::size_t i = 0; i < 5; ++i)
    for (std::size_t j = i + 1; j < 5; ++j) squares += difference(i, j) * difference(i, j) / 10.0;
  const ImagePlanes a = image(1, 1, 2, "1", [&](std::size_t, std::size_t k) { return pool[k]; });
  const ImagePlanes b = image(1, 1, 3, "2", [&](std::size_t, std::size_t k) { return pool[2 + k]; });
  const Equality equality = test_equality(a, b);
  ASSERT_EQ(equality.tests[1].name, "weighted");
  EXPECT_NEAR(equality.tests[1].statistic, difference(0, 1) / std::sqrt(squares),
              1e-6);  // values and errors are rounded to float
  EXPECT_NEAR(equality.tests[0].statistic, equality.tests[1].statistic, 1e-12);
}

TEST(equality_statistics, which_image_is_first_changes_the_sign_alone) {
  Random random(9);
  for (const std::uint64_t n : {4u, 7u}) {
    const ImagePlanes a = image(9, 9, 4, exponential, random), b = image(9, 9, n, exponential, random, 1.1);
    const Equality one = test_equality(a, b), other = test_equality(b, a);
    for (std::size_t i = 0; i < one.tests.size(); ++i) {
      EXPECT_EQ(one.tests[i].p, other.tests[i].p) << one.tests[i].name;
      EXPECT_EQ(std::abs(one.tests[i].statistic), std::abs(other.tests[i].statistic)) << one.tests[i].name;
    }
  }
}

// 4096 values of a channel, 16 replicas each with deviation 0.1: the mean of the difference to as many replicas, or to twice
// as many, has the deviation 0.1 sqrt(1/16 + 1/16) / 64 = 0.00055, or 0.00048: 0.005 is 9 of them, or 10.
TEST(equality_statistics, a_bias_of_half_a_percent_is_found) {
  Random random(2);
  const Law law = [](Random& r) { return 1.0 + 0.1 * normal(r); };
  for (const std::uint64_t n : {16u, 32u}) {
    const ImagePlanes a = image(64, 64, 16, law, random), b = image(64, 64, n, law, random, 1.005);
    const Equality equality = test_equality(a, b);
    EXPECT_EQ(equality.tests[0].name, "mean");
    EXPECT_LT(equality.tests[0].p, 1e-6) << n;
    EXPECT_LT(equality.tests[0].statistic, 0.0);
    EXPECT_TRUE(equality.differs(1e-3));
    EXPECT_EQ(equality.approximate, "");
  }
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

// 128 blocks of 8x8 pixels are brighter and darker in turn by 0.15 of the noise of a difference, 0.1 sqrt(2/16). Products of
// neighbours have the mean 3 0.15^2 and the deviation sqrt(3): 2.5 deviations in 4096. Those of two halves of a block have
// the mean 3 (32 0.15)^2 = 69 and the deviation 87: 128 of them are sqrt(128) 69 / hypot(69, 87) = 7 deviations of random
// signs.
TEST(equality_statistics, a_faint_pattern_of_blocks_is_found) {
  Random random(12);
  const Law law = [](Random& r) { return 1.0 + 0.1 * normal(r); };
  const ImagePlanes a = image(128, 64, 16, law, random);
  ImagePlanes b = image(128, 64, 16, law, random);
  const auto sign = [](std::size_t pixel) { return (pixel % 128 / 8 + pixel / 128 / 8) % 2 == 0 ? 1.0 : -1.0; };
  for (std::size_t i = 0; i < b.values.size(); ++i)
    b.values[i] += static_cast<float>(sign(i / 3) * 0.15 * 0.1 * std::sqrt(2.0 / 16.0));
  const Equality equality = test_equality(a, b);
  EXPECT_EQ(equality.tests[2].name, "pattern");
  EXPECT_LT(equality.tests[2].p, 1e-6);
  EXPECT_GT(equality.tests[2].statistic, 0.0);
}

// Of 64 replicas of each of six values half are 1 and half -1; in B one value is 0.9 more, so that the replicas of neither
// image are above the others. z = 64 0.9 / sqrt(2 S), S the sum of squares around the common mean.
TEST(equality_statistics, a_pixel_that_is_far_off_has_the_bound_of_random_pairs) {
  constexpr std::uint64_t n = 64;
  const auto replica = [](std::size_t, std::size_t k) { return k % 2 ? 1.0 : -1.0; };
  const ImagePlanes a = image(2, 1, n, "1", replica);
  const ImagePlanes b =
      image(2, 1, n, "2", [&](std::size_t i, std::size_t k) { return replica(i, k) + (i == 4 ? 0.9 : 0.0); });
  const double squares = 2.0 * n + 2.0 * n * 0.45 * 0.45, z = n * 0.9 / std::sqrt(2.0 * squares);
  const EqualityTest pixel = test_equality(a, b).tests[3];
  EXPECT_EQ(pixel.name, "pixel");
  EXPECT_EQ(pixel.statistic, 0.0);  // none is apart
  // Better of two bounds, six values, and 3.178 (2 P(Z >= z)); float: z is off by some 2^-22, its tail by z^2 times that.
  EXPECT_NEAR(pixel.p, 2.0 * 6.0 * sign_tail(z), 1e-4 * pixel.p);
  EXPECT_LT(pixel.p, 0.1);
}

// A's replicas are 1 and 1, B's 0, 0 and 0, in eight pixels: squares around the mean of five are 6/5, the variance of a
// difference 6/5 5/(6 4) = 1/4. None is larger than 1 = 2 deviations.
TEST(equality_statistics, with_different_numbers_the_bound_is_bernsteins) {
  const ImagePlanes a = image(8, 1, 2, "1", [](std::size_t, std::size_t) { return 1.0; });
  const ImagePlanes b = image(8, 1, 3, "2", [](std::size_t, std::size_t) { return 0.0; });
  const Equality equality = test_equality(a, b);
  const double bound = 2.0 * std::exp(-8.0 * 8.0 / (2.0 * (8.0 / 4.0 + 1.0 * 8.0 / 3.0)));
  EXPECT_NEAR(equality.tests[0].p, 3.0 * bound, 1e-6 * bound);
  EXPECT_NEAR(equality.tests[1].p, 3.0 * bound, 1e-6 * bound);
}

TEST(equality_statistics, p_is_the_smallest_of_the_tests_times_their_number) {
  Random random(13);
  for (const std::uint64_t n : {8u, 9u}) {
    const Equality equality = test_equality(image(9, 9, 8, exponential, random), image(9, 9, n, exponential, random, 1.3));
    double smallest = 1.0;
    for (const EqualityTest& test : equality.tests) smallest = std::min(smallest, test.p);
    EXPECT_EQ(equality.p, static_cast<double>(equality.tests.size()) * smallest);
    EXPECT_LT(equality.p, 1.0);
    EXPECT_TRUE(equality.differs(1.01 * equality.p));
    EXPECT_FALSE(equality.differs(equality.p));
  }
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

// A lamp out of sight that is 10^10 times as bright sets the unit of the standard errors: noise below it is not resolved.
TEST(equality_statistics, noise_that_the_standard_errors_do_not_resolve_is_no_difference) {
  for (const std::uint64_t n : {2u, 32u}) {
    Random random(12);
    const Law law = [](Random& r) { return 0.3 + 1e-5 * normal(r); };
    ImagePlanes a = image(32, 32, n, law, random), b = image(32, 32, n, law, random);
    for (ImagePlanes* const planes : {&a, &b}) planes->errors.assign(planes->errors.size(), 0.0f);
    EXPECT_EQ(test_equality(a, b).differs(1e-3), n == 32u);
    a.error_unit = 1e-3;
    EXPECT_FALSE(test_equality(a, b).differs(1e-3));
    EXPECT_EQ(test_equality(a, b).p, test_equality(b, a).p);
    b.values[300] = 0.5f;  // far beyond it
    EXPECT_EQ(test_equality(a, b).differs(1e-3), n == 32u);
  }
}

TEST(equality_statistics, a_number_of_samples_that_error_has_chosen_makes_the_rate_approximate) {
  Random random(13);
  ImagePlanes a = image(8, 8, 4, gaussian, random), b = image(8, 8, 4, gaussian, random);
  EXPECT_EQ(test_equality(a, b).approximate, "");
  b.stopped_by_error = true;
  EXPECT_EQ(test_equality(a, b).approximate, "--error has chosen the number of samples by what they were");
}

// The numbers depend on the seed alone, not on the scene.
TEST(equality_statistics, images_that_share_random_numbers_or_differ_in_samplers_are_not_judged_by_single_pixels) {
  Random random(5);
  ImagePlanes a = image(8, 8, 4, gaussian, random), b = a;
  EXPECT_EQ(test_equality(a, b).left_out.size(), 2u);
  EXPECT_EQ(test_equality(a, b).approximate, "the images share random numbers");
  EXPECT_FALSE(test_equality(a, b).differs(0.5));
  b.ranges = {{64, 64}};
  EXPECT_TRUE(test_equality(a, b).left_out.empty());
  EXPECT_EQ(test_equality(a, b).approximate, "");
  b.seed = "other";
  b.sampler = "sobol";
  EXPECT_EQ(test_equality(a, b).approximate, "the samplers are not the same");
  b.ranges.clear();
  EXPECT_EQ(test_equality(a, b).approximate, "a header does not say which samples there are");
  b.errors.clear();
  EXPECT_EQ(test_equality(a, b).impossible, "no standard errors of the second image");
}

// 40 samples are two replicas and a half, in one range or in two.
TEST(equality_statistics, samples_beyond_the_replicas_must_be_as_many_in_both_images) {
  Random random(10);
  ImagePlanes a = image(4, 4, 2, gaussian, random), b = image(4, 4, 2, gaussian, random);
  b.ranges = {{0, 40}};
  EXPECT_FALSE(replicas_of(a, b).alike);
  EXPECT_EQ(test_equality(a, b).approximate, "the numbers of samples are not the same and a replica is not complete");
  a.ranges = {{0, 24}, {32, 16}};
  EXPECT_TRUE(replicas_of(a, b).alike);
  const Equality equality = test_equality(a, b);
  EXPECT_EQ(equality.approximate, "");
  EXPECT_EQ(equality.left_out, std::vector<std::string>{"pixel: a replica is not complete"});
}

TEST(equality_statistics, rejected_samples_leave_what_rests_on_standard_errors_out) {
  Random random(11);
  ImagePlanes a = image(4, 4, 2, gaussian, random), b = image(4, 4, 2, gaussian, random);
  b.rejected = true;
  EXPECT_EQ(test_equality(a, b).left_out, std::vector<std::string>{"pixel: samples were rejected"});
  b.ranges = {{0, 48}};
  EXPECT_EQ(test_equality(a, b).approximate, "the numbers of samples are not the same and samples were rejected");
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
        ASSERT_GE(sign_tail(sums[k] - 1e-9), static_cast<double>(k + 1) / static_cast<double>(sums.size()))
            << n << " " << sums[k];
    }
}

TEST(equality_statistics, separation_is_two_of_all_ways_to_choose) {
  EXPECT_NEAR(separation_probability(2, 2), 2.0 / 6.0, 1e-14);
  EXPECT_NEAR(separation_probability(3, 5), 2.0 / 56.0, 1e-14);
  EXPECT_NEAR(separation_probability(16, 16) * 601080390.0, 2.0, 1e-10);
}
