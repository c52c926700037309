// What oclair tune reports of pictures whose truth is known: they are drawn from distributions with given means and variances, and two
// settings share a part of their noise, as renders on the same random numbers do. An interval of confidence C may miss the truth in 1 - C
// of the runs: if that is kept, a TEST finds `tolerated` misses or more in one of its comparisons with a probability of 2e-5 or less.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <utility>

#include "../host/tune/estimates.h"
#include "random.h"
#include "statistics.h"

using namespace oclair;
using namespace oclair::test;
using namespace oclair::tune;

namespace {

constexpr std::size_t replica_count = 16;

// Of so many runs, the least number of misses that a rate of `miss` reaches with a probability of significance(comparisons) at most.
int tolerated(int runs, double miss, int comparisons) {
  double term = std::exp(runs * std::log1p(-miss)), below = 0.0;
  for (int k = 0; k <= runs; ++k) {
    below += term;
    if (1.0 - below <= significance(comparisons)) return k + 1;
    term *= static_cast<double>(runs - k) / (k + 1) * miss / (1.0 - miss);
  }
  return runs + 1;
}

// And the largest number that it stays below with such a probability.
int expected_at_least(int runs, double miss, int comparisons) {
  double term = std::exp(runs * std::log1p(-miss)), below = 0.0;
  for (int k = 0; k <= runs; ++k) {
    below += term;
    if (below > significance(comparisons)) return k;
    term *= static_cast<double>(runs - k) / (k + 1) * miss / (1.0 - miss);
  }
  return runs;
}

double normal(Random& random) {  // Box and Muller 1958
  const double radius = std::sqrt(-2.0 * std::log(1.0 - random.unit()));
  return radius * std::cos(6.283185307179586 * random.unit());
}

// Exponential, less its mean: a skewness of 2.
double exponential(Random& random) { return -std::log(1.0 - random.unit()) - 1.0; }

using Noise = std::function<double(Random&)>;        // of mean 0 and variance 1
using Bias = std::function<double(std::size_t)>;     // of a pixel, over its mean

// Two settings of a picture of grey pixels of different brightness.
struct Synthetic {
  std::size_t pixels;
  Noise noise;
  double deviation;              // of a value of a replica of the accurate setting, over its mean
  double shared;                 // part of the variance that both have in common
  double deviation_ratio = 1.0;  // of the other setting
  Bias bias = [](std::size_t) { return 0.0; };

  double mean(std::size_t p) const { return 0.5 + static_cast<double>(p % 7) / 6.0; }
};

struct Pair {
  std::vector<Picture> reference;  // without noise
  Replicas accurate, other;
};

Pair drawn(const Synthetic& world, std::uint64_t seed, std::size_t replicas = replica_count) {
  Random random(seed);
  Pair pair;
  Picture exact;
  for (std::size_t i = 0; i < 3 * world.pixels; ++i) exact.push_back(static_cast<float>(world.mean(i / 3)));
  pair.reference.assign(replicas, exact);
  const double own = std::sqrt(1.0 - world.shared), common = std::sqrt(world.shared);
  for (std::size_t k = 0; k < replicas; ++k) {
    Picture a(3 * world.pixels), b(a.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      const double mu = world.mean(i / 3), both = common * world.noise(random);
      a[i] = static_cast<float>(mu * (1.0 + world.deviation * (both + own * world.noise(random))));
      b[i] = static_cast<float>(mu * (1.0 + world.bias(i / 3) + world.deviation * world.deviation_ratio * (both + own * world.noise(random))));
    }
    pair.accurate.pictures.push_back(std::move(a));
    pair.other.pictures.push_back(std::move(b));
    pair.accurate.seconds.push_back(2.0 * std::exp(0.1 * normal(random)));
    pair.other.seconds.push_back(std::exp(0.1 * normal(random)));
  }
  return pair;
}

struct Truth {
  double bias = 0.0, squared_bias = 0.0;
};

// From the definitions in estimates.h.
Truth truth_of(const Synthetic& world) {
  double mean = 0.0, shift = 0.0;
  for (std::size_t p = 0; p < world.pixels; ++p) mean += world.mean(p), shift += world.mean(p) * world.bias(p);
  mean /= static_cast<double>(world.pixels);
  Truth truth{shift / static_cast<double>(world.pixels) / mean, 0.0};
  for (std::size_t p = 0; p < world.pixels; ++p) {
    const double b = world.mean(p) * world.bias(p), square = world.mean(p) * world.mean(p);
    truth.squared_bias += 3.0 * b * b / (3.0 * square + 0.03 * mean * mean) / static_cast<double>(world.pixels);
  }
  return truth;
}

struct Misses {
  int runs = 0, bias = 0, bound = 0, squared_bias = 0, variance = 0, speed = 0;
};

Misses misses(const char* name, const Synthetic& world, int runs, double confidence, std::size_t replicas = replica_count) {
  const Truth truth = truth_of(world);
  Misses m;
  m.runs = runs;
  double squares = 0.0;
  for (int run = 0; run < runs; ++run) {
    const Pair pair = drawn(world, 1000 + static_cast<std::uint64_t>(run), replicas);
    const Estimates e = estimate(pair.reference, pair.accurate, pair.other, confidence);
    m.bias += !e.bias.contains(truth.bias);
    m.bound += !(std::abs(truth.bias) < e.bias_bound);
    m.squared_bias += !e.squared_bias.contains(truth.squared_bias);
    m.variance += !e.variance.contains(world.deviation_ratio * world.deviation_ratio);
    m.speed += !e.speed.contains(2.0);
    squares += e.squared_bias.estimate / runs;
  }
  std::printf("%-28s of %d runs at %g missed: bias %d, bound %d, squared bias %d, variance %d, speed %d; mean squared bias %.3g of %.3g\n", name,
              runs, confidence, m.bias, m.bound, m.squared_bias, m.variance, m.speed, squares, truth.squared_bias);
  return m;
}

const Noise gaussian = normal, skewed = exponential;
const auto none = [](std::size_t) { return 0.0; };
const auto half_a_percent = [](std::size_t) { return 0.005; };
const auto up_and_down = [](std::size_t p) { return p % 2 ? 0.03 : -0.03; };

}  // namespace

// Of normal values Student's t is exact, so it misses neither more nor less often than it says.
TEST(tune_statistics, bias_intervals_miss_at_their_nominal_rate) {
  constexpr int runs = 1000, comparisons = 6;
  for (const double confidence : {0.8, 0.95, 0.99}) {
    const double miss = 1.0 - confidence;
    for (const Bias& bias : {Bias(none), Bias(half_a_percent)}) {
      const Misses m = misses("normal", {8, gaussian, 0.05, 0.9, 1.0, bias}, runs, confidence);
      EXPECT_LT(m.bias, tolerated(runs, miss, comparisons)) << confidence;
      EXPECT_GE(m.bias, expected_at_least(runs, miss, comparisons)) << confidence;
    }
  }
}

TEST(tune_statistics, intervals_of_skewed_noise_cover_the_truth) {
  constexpr int runs = 1000, comparisons = 8;
  for (const double confidence : {0.9, 0.99}) {
    const int most = tolerated(runs, 1.0 - confidence, comparisons);
    const Misses m = misses("skewed", {32, skewed, 0.3, 0.8, 1.0, half_a_percent}, runs, confidence);
    EXPECT_LT(m.bias, most);
    EXPECT_LT(m.bound, most);
    EXPECT_LT(m.squared_bias, most);
    EXPECT_LT(m.speed, most);
  }
}

// A bias that the mean of the picture does not show.
TEST(tune_statistics, intervals_of_the_squared_bias_cover_the_truth) {
  constexpr int runs = 1000, comparisons = 8;
  const std::pair<const char*, Bias> named_biases[] = {{"squared bias", up_and_down}, {"no squared bias", none}};
  for (const double confidence : {0.9, 0.99})
    for (const auto& [name, bias] : named_biases)
      for (const double deviation : {0.05, 0.5}) {
        const Misses m = misses(name, {64, gaussian, deviation, 0.5, 1.0, bias}, runs, confidence);
        EXPECT_LT(m.squared_bias, tolerated(runs, 1.0 - confidence, comparisons)) << confidence << " " << deviation;
      }
}

// A loss that is the same share of every sample: what the differences are divided by, the reference, has as much noise as they. Intervals
// that took it as exact would be too narrow by the root of 2 and miss three times as often (0.153 at 0.95: Student's t of 15 degrees).
TEST(tune_statistics, bias_intervals_count_the_noise_of_the_reference) {
  constexpr int runs = 1000, comparisons = 6;
  const Synthetic world{1, gaussian, 0.05 * std::sqrt(3.0), 0.0};  // three channels: 5 % of noise in the mean
  for (const double confidence : {0.8, 0.95}) {
    int missed = 0, bound_missed = 0, square_missed = 0;
    for (int run = 0; run < runs; ++run) {
      Pair pair = drawn(world, 100000 + static_cast<std::uint64_t>(run));
      for (std::size_t k = 0; k < replica_count; ++k)
        for (std::size_t i = 0; i < 3; ++i) pair.other.pictures[k][i] = 0.8f * pair.accurate.pictures[k][i];
      const std::vector<Picture> reference = drawn(world, 200000 + static_cast<std::uint64_t>(run)).accurate.pictures;
      const Estimates e = estimate(reference, pair.accurate, pair.other, confidence);
      missed += !e.bias.contains(-0.2);
      bound_missed += !(0.2 < e.bias_bound);
      square_missed += !e.squared_bias.contains(0.04 / 1.01);
    }
    std::printf("of %d runs at %g missed: bias %d, bound %d, squared bias %d\n", runs, confidence, missed, bound_missed, square_missed);
    EXPECT_LT(missed, tolerated(runs, 1.0 - confidence, comparisons)) << confidence;
    EXPECT_LT(bound_missed, tolerated(runs, 1.0 - confidence, comparisons)) << confidence;
    EXPECT_LT(square_missed, tolerated(runs, 1.0 - confidence, comparisons)) << confidence;
  }
}

// Its mean over the runs is the truth, though the squared noise is a hundred times as large. The tolerance is that of the mean of so
// many runs, with their own deviation.
TEST(tune_statistics, squared_bias_is_without_bias) {
  constexpr int runs = 2000;
  const Synthetic world{64, gaussian, 0.3, 0.5, 1.0, up_and_down};
  double sum = 0.0, squares = 0.0;
  for (int run = 0; run < runs; ++run) {
    const Pair pair = drawn(world, 50000 + static_cast<std::uint64_t>(run));
    const double value = estimate(pair.reference, pair.accurate, pair.other, 0.95).squared_bias.estimate;
    sum += value, squares += value * value;
  }
  const double mean = sum / runs, deviation = std::sqrt((squares / runs - mean * mean) / (runs - 1.0));
  EXPECT_NEAR(mean, truth_of(world).squared_bias, sidak_z * deviation);
  EXPECT_LT(deviation, 0.1 * truth_of(world).squared_bias);  // so that it says something
}

TEST(tune_statistics, variance_ratios_cover_the_truth) {
  constexpr int runs = 1000, comparisons = 6;
  for (const double confidence : {0.9, 0.99})
    for (const double ratio : {0.5, 1.0, 3.0}) {
      const Misses m = misses("variance", {64, gaussian, 0.1, 0.5, ratio}, runs, confidence);
      EXPECT_LT(m.variance, tolerated(runs, 1.0 - confidence, comparisons)) << confidence << " " << ratio;
    }
}

TEST(tune_statistics, variance_ratios_of_skewed_noise_cover_the_truth) {
  constexpr int runs = 1000;
  const Misses m = misses("skewed variance", {256, skewed, 0.1, 0.5, 2.0}, runs, 0.95);
  EXPECT_LT(m.variance, tolerated(runs, 0.05, 1));
}

// Of 200 samples one brings nearly all the light. Weights from one of the two settings themselves would take its bright samples for bright
// pixels, and the other setting would seem many times as noisy (its misses: all runs).
TEST(tune_statistics, a_rare_bright_sample_counts_alike_in_both_settings) {
  constexpr int runs = 300;
  const Noise rare = [](Random& random) { return random.unit() < 0.005 ? 14.1 : -0.071; };  // mean 0, variance 1 within 1 %
  const Synthetic world{1024, rare, 10.0, 0.0};
  int missed = 0, missed_by_own_weights = 0;
  for (int run = 0; run < runs; ++run) {
    Pair pair = drawn(world, 70000 + static_cast<std::uint64_t>(run));
    const std::vector<Picture> reference = drawn(world, 80000 + static_cast<std::uint64_t>(run)).accurate.pictures;
    missed += !estimate(reference, pair.accurate, pair.other, 0.95).variance.contains(1.0);
    missed_by_own_weights += !estimate(pair.accurate.pictures, pair.accurate, pair.other, 0.95).variance.contains(1.0);
  }
  EXPECT_LT(missed, tolerated(runs, 0.05, 1));
  EXPECT_GT(missed_by_own_weights, runs / 2);
}

// The ratio of two times has a median of 2 here, whatever its mean is.
TEST(tune_statistics, speed_intervals_cover_the_median) {
  constexpr int runs = 1000, comparisons = 4;
  for (const double confidence : {0.8, 0.95, 0.99}) {
    const Misses m = misses("speed", {1, gaussian, 0.1, 0.0}, runs, confidence);
    EXPECT_LT(m.speed, tolerated(runs, 1.0 - confidence, comparisons)) << confidence;
  }
  const Misses few = misses("speed of four", {1, gaussian, 0.1, 0.0}, runs, 0.8, 4);  // their range: 7/8
  EXPECT_LT(few.speed, tolerated(runs, 0.125, comparisons));
  EXPECT_GE(few.speed, expected_at_least(runs, 0.125, comparisons));
}

// The bound is that of two one-sided tests at 1 - C each: of a bias of just that size it is too low in 1 - C of the runs, where
// one of the tests decides alone (bias far above its standard error), and never more often.
TEST(tune_statistics, bias_bounds_are_exceeded_at_their_nominal_rate_at_most) {
  constexpr int runs = 1000, comparisons = 3;
  const auto far = misses("bound, large bias", {8, gaussian, 0.05, 0.9, 1.0, [](std::size_t) { return 0.05; }}, runs, 0.9);
  EXPECT_LT(far.bound, tolerated(runs, 0.1, comparisons));
  EXPECT_GE(far.bound, expected_at_least(runs, 0.1, comparisons));
  const auto near = misses("bound, small bias", {8, gaussian, 0.05, 0.9, 1.0, half_a_percent}, runs, 0.9);
  EXPECT_LT(near.bound, tolerated(runs, 0.1, comparisons));
}

TEST(tune_statistics, an_option_without_effect_is_reported_as_none) {
  const Pair pair = drawn({16, skewed, 0.3, 1.0}, 3);
  Estimates e = estimate(pair.reference, pair.accurate, pair.accurate, 0.99);
  EXPECT_TRUE(e.same);
  EXPECT_EQ(e.bias.low, 0.0);
  EXPECT_EQ(e.bias.high, 0.0);
  EXPECT_EQ(e.bias_bound, 0.0);
  EXPECT_EQ(e.squared_bias.high, 0.0);
  EXPECT_EQ(e.variance.estimate, 1.0);
  Replicas other = pair.accurate;
  other.pictures.back().back() = std::nextafter(other.pictures.back().back(), 10.0f);
  EXPECT_FALSE(estimate(pair.reference, pair.accurate, other, 0.99).same);
}

// Half a percent is 5.83 standard errors here: of 48 values a replica, where each setting has a tenth of the variance for itself, the error
// is 0.05 sqrt(2 * 0.1) sqrt(mean of mu^2 / (mean of mu)^2 / 48 / 16) = 0.0858 %. A t of 15 degrees around 5.83 is below the 2.131 of the
// interval with a probability of 2.64e-4 (integrated over the chi-square density).
TEST(tune_statistics, a_bias_of_half_a_percent_is_found) {
  constexpr int runs = 500;
  const Synthetic world{16, gaussian, 0.05, 0.9, 1.0, half_a_percent};
  int unseen = 0, wrong_sign = 0;
  for (int run = 0; run < runs; ++run) {
    const Pair pair = drawn(world, 9000 + static_cast<std::uint64_t>(run));
    const Interval bias = estimate(pair.reference, pair.accurate, pair.other, 0.95).bias;
    unseen += bias.contains(0.0);
    wrong_sign += bias.high < 0.0;
  }
  EXPECT_LT(unseen, tolerated(runs, 2.64e-4, 1));
  EXPECT_EQ(wrong_sign, 0);
}

// What sharing noise is for: the same bias drowns if each has noise of its own.
TEST(tune_statistics, shared_noise_narrows_the_bias_by_the_root_of_the_part_that_is_not_shared) {
  constexpr int runs = 200;
  double shared = 0.0, apart = 0.0;
  for (int run = 0; run < runs; ++run) {
    const auto width = [&](double part) {
      const Pair pair = drawn({16, gaussian, 0.05, part}, 20000 + static_cast<std::uint64_t>(run));
      const Interval bias = estimate(pair.reference, pair.accurate, pair.other, 0.95).bias;
      return bias.high - bias.low;
    };
    shared += width(0.96), apart += width(0.0);
  }
  // The mean of 200 widths with 15 degrees of freedom has a relative deviation of 1 / sqrt(30 * 200) = 1.3 %, their ratio 1.8 %.
  EXPECT_NEAR(shared / apart, 0.2, 0.2 * sidak_z * 0.018);
}

// Five statements about each of several settings: one miss anywhere spoils a run.
TEST(tune_statistics, all_statements_about_all_settings_hold_together) {
  constexpr int runs = 400, settings = 6;
  constexpr double confidence = 0.8;
  const double each = confidence_of_each(confidence, settings);
  int spoiled = 0;
  for (int run = 0; run < runs; ++run) {
    bool all = true;
    for (int setting = 0; setting < settings; ++setting) {
      const Synthetic world{8, gaussian, 0.05, 0.5, 1.0 + 0.2 * setting, half_a_percent};
      const Truth truth = truth_of(world);
      const Pair pair = drawn(world, 40000 + static_cast<std::uint64_t>(run * settings + setting));
      const Estimates e = estimate(pair.reference, pair.accurate, pair.other, each);
      all = all && e.bias.contains(truth.bias) && std::abs(truth.bias) < e.bias_bound && e.squared_bias.contains(truth.squared_bias) &&
            e.variance.contains(world.deviation_ratio * world.deviation_ratio) && e.speed.contains(2.0);
    }
    spoiled += !all;
  }
  std::printf("of %d runs at %g something missed in %d\n", runs, confidence, spoiled);
  EXPECT_LT(spoiled, tolerated(runs, 1.0 - confidence, 1));
}

TEST(tune_statistics, confidence_of_each_is_bonferronis) {
  EXPECT_DOUBLE_EQ(confidence_of_each(0.95, 1), 0.99);
  EXPECT_DOUBLE_EQ(confidence_of_each(0.8, 4), 0.99);
  EXPECT_LT(confidence_of_each(1.0 - 1e-16, 100), 1.0);
}
