// What oclair tune makes of its replicas, on pictures for which each figure is known exactly, and its ranking against brute force.
#include "../host/tune/estimates.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "../host/tune/tune.h"
#include "random.h"

using namespace oclair;
using namespace oclair::test;
using namespace oclair::tune;

namespace {

constexpr std::size_t pixels = 6;

// Replicas without noise: grey, `value` everywhere, with all partial pictures.
Replicas flat(float value, std::size_t count, double seconds = 1.0) {
  Replicas replicas;
  const Picture picture(3 * pixels, value);
  replicas.pictures.assign(count, picture);
  replicas.seconds.assign(count, seconds);
  for (auto& level : replicas.levels) level.assign(std::min(count, leveled_replicas), picture);
  return replicas;
}

Replicas random_replicas(std::uint64_t seed, std::size_t count, double least = 0.5) {
  Random random(seed);
  Replicas replicas;
  for (std::size_t k = 0; k < count; ++k) {
    Picture& picture = replicas.pictures.emplace_back(3 * pixels);
    for (float& value : picture) value = static_cast<float>(random.between(least, least + 1.0));
    replicas.seconds.push_back(random.between(1.0, 2.0));
  }
  return replicas;
}

// Over the squared radiance, 3 g^2 for grey, and 0.01 times that of the mean: of a flat picture 1 / (1.01 * 3 g^2).
constexpr double flat_weight_factor = 1.01;

double weight(const Picture& mean, std::size_t p) {
  double colour[3] = {}, square = 0.0, floor = 0.0;
  for (std::size_t i = 0; i < mean.size(); ++i) colour[i % 3] += mean[i] / (static_cast<double>(mean.size()) / 3.0);
  for (int c = 0; c < 3; ++c) square += std::pow(mean[3 * p + c], 2.0), floor += 0.01 * colour[c] * colour[c];
  return 1.0 / (square + floor);
}

}  // namespace

TEST(tune_estimates_test, noise_and_bias_together_reach_the_error_when_the_time_is_up) {
  // 0.1^2 = 0.0036 + 0.0064; a replica has twice the variance that is left: 2 replicas of 3 s.
  EXPECT_NEAR(seconds_to_error(0.1, 0.0036, 0.0128, 3.0).value(), 6.0, 1e-12);
  EXPECT_NEAR(seconds_to_error(0.1, 0.0, 0.01, 3.0).value(), 3.0, 1e-12);
  EXPECT_EQ(seconds_to_error(0.1, -0.5, 0.01, 3.0), seconds_to_error(0.1, 0.0, 0.01, 3.0));
  EXPECT_EQ(seconds_to_error(0.1, 0.0, 0.0, 3.0), 0.0);
}

TEST(tune_estimates_test, a_bias_as_large_as_the_error_is_never_made_up_for) {
  EXPECT_FALSE(seconds_to_error(0.5, 0.25, 1.0, 1.0));
  EXPECT_FALSE(seconds_to_error(0.5, std::numeric_limits<double>::infinity(), 1.0, 1.0));
  EXPECT_TRUE(seconds_to_error(0.5, std::nextafter(0.25, 0.0), 1.0, 1.0));
}

TEST(tune_estimates_test, slope_of_a_power_of_the_time_is_its_exponent) {
  for (const double exponent : {-1.5, -0.5, 0.0, 0.25}) {
    std::vector<CurvePoint> curve;
    for (const double seconds : {0.001, 0.01, 0.03, 2.0, 1000.0}) curve.push_back({seconds * 16.0, seconds, 3.0 * std::pow(seconds, exponent)});
    EXPECT_NEAR(slope(curve).value(), exponent, 1e-12);
  }
}

TEST(tune_estimates_test, slope_is_the_least_squares_line) {
  // log x = 0 1 2, log y = 0 1 0: the line is flat; with 0 1 1 it rises by 1/2.
  const double e = std::exp(1.0);
  EXPECT_NEAR(slope({{1, 1.0, 1.0}, {1, e, e}, {1, e * e, 1.0}}).value(), 0.0, 1e-12);
  EXPECT_NEAR(slope({{1, 1.0, 1.0}, {1, e, e}, {1, e * e, e}}).value(), 0.5, 1e-12);
}

TEST(tune_estimates_test, slope_needs_two_points_at_different_times) {
  EXPECT_FALSE(slope({}));
  EXPECT_FALSE(slope({{1, 1.0, 1.0}}));
  EXPECT_FALSE(slope({{1, 1.0, 1.0}, {1, 1.0, 2.0}}));
  EXPECT_TRUE(slope({{1, 1.0, 1.0}, {1, 2.0, 2.0}}));
}

// Without noise every picture of the other setting is off by the same: its relative error is |b| / sqrt(1.01) at any number of samples.
TEST(tune_estimates_test, error_of_a_bias_without_noise_does_not_fall) {
  for (const std::size_t count : {4u, 8u, 16u, 33u}) {
    Replicas other = flat(1.5f, count, 3.2);
    const std::vector<CurvePoint> curve = convergence(flat(2.0f, count), other);
    double samples = 1.0;
    for (const CurvePoint& point : curve) {
      EXPECT_EQ(point.samples, samples);
      EXPECT_NEAR(point.seconds, 3.2 * samples / 16.0, 1e-12);
      EXPECT_NEAR(point.error, 0.25 / std::sqrt(flat_weight_factor), 1e-7) << samples;
      samples *= 2.0;
    }
    // 1, 2, 4, 8, 16 samples and then as long as there are four groups.
    EXPECT_EQ(curve.size(), 5 + static_cast<std::size_t>(std::log2(count / 4))) << count;
    EXPECT_NEAR(slope(curve).value(), 0.0, 1e-9);
  }
}

TEST(tune_estimates_test, errors_that_are_not_there_are_no_points) {
  EXPECT_TRUE(convergence(flat(2.0f, 16), flat(2.0f, 16)).empty());
  EXPECT_TRUE(convergence(flat(0.0f, 16), flat(0.0f, 16)).empty());
}

// The definition, term by term: each picture against the mean of the reference, less what that mean is off itself.
TEST(tune_estimates_test, error_of_a_replica_is_measured_against_the_reference) {
  const std::size_t n = 6;
  const Replicas reference = random_replicas(1, n), other = random_replicas(2, n, 1.2);
  const Picture mean = mean_picture(reference.pictures);
  double square = 0.0, noise = 0.0;
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t i = 0; i < 3 * pixels; ++i) {
      square += weight(mean, i / 3) * std::pow(other.pictures[k][i] - mean[i], 2.0) / static_cast<double>(n * pixels);
      noise += weight(mean, i / 3) * std::pow(reference.pictures[k][i] - mean[i], 2.0) / ((n - 1.0) * static_cast<double>(pixels));
    }
  const std::vector<CurvePoint> curve = convergence(reference, other);
  ASSERT_EQ(curve.size(), 1u);  // no partial pictures here
  EXPECT_EQ(curve[0].samples, 16.0);
  EXPECT_NEAR(curve[0].error, std::sqrt(square - noise / n), 1e-6);
}

// Pairs of different replicas, one by one.
TEST(tune_estimates_test, figures_are_those_of_the_definitions) {
  const std::size_t n = 5;
  const Replicas accurate = random_replicas(3, n), other = random_replicas(4, n, 0.7);
  const std::vector<Picture> reference = random_replicas(7, n).pictures;
  const Picture mean = mean_picture(reference);
  const Estimates e = estimate(reference, accurate, other, 0.9);
  double products = 0.0, variance[2] = {}, level = 0.0, shift = 0.0;
  for (std::size_t i = 0; i < 3 * pixels; ++i) {
    const double w = weight(mean, i / 3) / static_cast<double>(pixels);
    level += mean[i];
    for (std::size_t j = 0; j < n; ++j) {
      shift += (static_cast<double>(other.pictures[j][i]) - accurate.pictures[j][i]) / static_cast<double>(n);
      for (std::size_t k = 0; k < n; ++k) {
        const auto apart = [&](std::size_t r) { return static_cast<double>(other.pictures[r][i]) - accurate.pictures[r][i]; };
        if (j != k) products += w * apart(j) * apart(k) / (n * (n - 1.0));
        // Half the mean square of the difference of two replicas.
        variance[0] += w * std::pow(accurate.pictures[j][i] - accurate.pictures[k][i], 2.0) / (2.0 * n * (n - 1.0));
        variance[1] += w * std::pow(other.pictures[j][i] - other.pictures[k][i], 2.0) / (2.0 * n * (n - 1.0));
      }
    }
  }
  EXPECT_FALSE(e.same);
  EXPECT_NEAR(e.bias.estimate, shift / level, 1e-6);
  EXPECT_NEAR(e.squared_bias.estimate, products, 1e-6);
  EXPECT_NEAR(e.variance.estimate, variance[1] / variance[0], 1e-6);
  EXPECT_NEAR(e.replica_variance, variance[1], 1e-6);
  for (const Interval& i : {e.speed, e.bias, e.squared_bias, e.variance}) EXPECT_TRUE(i.contains(i.estimate) && i.low < i.high);
  EXPECT_GE(e.bias_bound, std::abs(e.bias.estimate));
}

TEST(tune_estimates_test, brightness_of_the_scene_changes_no_figure) {
  const Replicas accurate = random_replicas(5, 8), other = random_replicas(6, 8, 0.6);
  const auto scaled = [](Replicas replicas, float factor) {
    for (Picture& picture : replicas.pictures)
      for (float& value : picture) value *= factor;
    return replicas;
  };
  const auto estimated = [](const Replicas& a, const Replicas& b) { return estimate(a.pictures, a, b, 0.9); };
  const Estimates e = estimated(accurate, other);
  for (const float factor : {0x1p-60f, 0x1p60f}) {
    const Estimates f = estimated(scaled(accurate, factor), scaled(other, factor));
    EXPECT_DOUBLE_EQ(f.bias.low, e.bias.low);
    EXPECT_DOUBLE_EQ(f.squared_bias.high, e.squared_bias.high);
    EXPECT_DOUBLE_EQ(f.variance.high, e.variance.high);
    EXPECT_DOUBLE_EQ(f.replica_variance, e.replica_variance);
  }
}

// Constant pictures: sums of squares of a number like 0.1f are not exact for most numbers of replicas, and what is left over is no noise.
TEST(tune_estimates_test, pictures_without_noise_have_no_variance_for_any_number_of_replicas) {
  for (std::size_t n = 2; n <= 40; ++n)
    for (const float value : {0.1f, 0.3333f, 7.7f}) {
      const Estimates e = estimate(flat(value, n).pictures, flat(value, n), flat(2.0f * value, n), 0.95);
      EXPECT_EQ(e.replica_variance, 0.0) << n << " " << value;
      EXPECT_EQ(e.variance.estimate, 1.0) << n << " " << value;
      EXPECT_NEAR(e.bias.estimate, 1.0, 1e-6);
      EXPECT_NEAR(e.squared_bias.estimate, 1.0 / flat_weight_factor, 1e-6);
    }
}

TEST(tune_estimates_test, black_pictures_have_neither_bias_nor_variance) {
  const Estimates e = estimate(flat(0.0f, 4).pictures, flat(0.0f, 4), flat(0.0f, 4), 0.95);
  EXPECT_TRUE(e.same);
  for (const double value : {e.bias.low, e.bias.high, e.squared_bias.low, e.squared_bias.high, e.replica_variance, e.bias_bound})
    EXPECT_EQ(value, 0.0);
}
