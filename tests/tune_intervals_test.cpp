// The intervals of oclair tune against tables, closed forms and the enumeration of all cases.
#include "../host/tune/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "random.h"

using namespace oclair::test;
using namespace oclair::tune;

namespace {

// NIST/SEMATECH e-Handbook of Statistical Methods, 1.3.6.7.2: critical values of Student's t, cut to three decimals.
struct Tabled {
  unsigned degrees;
  double p90, p95, p975, p99, p995;
};
constexpr Tabled table[] = {{1, 3.078, 6.314, 12.706, 31.821, 63.657}, {2, 1.886, 2.920, 4.303, 6.965, 9.925},
                            {3, 1.638, 2.353, 3.182, 4.541, 5.841},    {4, 1.533, 2.132, 2.776, 3.747, 4.604},
                            {5, 1.476, 2.015, 2.571, 3.365, 4.032},    {7, 1.415, 1.895, 2.365, 2.998, 3.499},
                            {10, 1.372, 1.812, 2.228, 2.764, 3.169},   {15, 1.341, 1.753, 2.131, 2.602, 2.947},
                            {30, 1.310, 1.697, 2.042, 2.457, 2.750},   {60, 1.296, 1.671, 2.000, 2.390, 2.660}};

// P(T < t) by Simpson's rule over the density, in x = atan(t / sqrt(n)): the density is then cos(x)^(n - 1) up to a factor.
double distribution(double t, unsigned n) {
  const double end = std::atan(t / std::sqrt(static_cast<double>(n)));
  const auto density = [&](double x) { return std::pow(std::cos(x), static_cast<double>(n) - 1.0); };
  constexpr int steps = 4000;
  double sum = density(0.0) + density(end);
  for (int i = 1; i < steps; ++i) sum += (i % 2 ? 4.0 : 2.0) * density(end * i / steps);
  const double factor = std::exp(std::lgamma(0.5 * (n + 1.0)) - std::lgamma(0.5 * n)) / std::sqrt(std::numbers::pi);
  return 0.5 + factor * sum * end / (3.0 * steps);
}

double choose(unsigned n, unsigned k) {
  double product = 1.0;
  for (unsigned i = 0; i < k; ++i) product *= static_cast<double>(n - i) / (i + 1.0);
  return product;
}

// That the median of a continuous distribution lies between the (k + 1)-th least and the (k + 1)-th largest of n values.
double covered(unsigned n, unsigned k) {
  double outside = 0.0;
  for (unsigned i = 0; i <= k; ++i) outside += choose(n, i);
  return 1.0 - 2.0 * outside / std::exp2(n);
}

std::vector<double> counted(std::size_t n) {  // 0, 1, ... in another order
  std::vector<double> values(n);
  for (std::size_t i = 0; i < n; ++i) values[i] = static_cast<double>((i * 7 + 3) % n);
  std::sort(values.begin(), values.end());
  for (std::size_t i = 0; i + 1 < n; i += 2) std::swap(values[i], values[i + 1]);
  return values;
}

}  // namespace

TEST(tune_intervals_test, student_quantiles_are_those_of_the_table) {
  for (const Tabled& row : table) {
    const double p[] = {0.9, 0.95, 0.975, 0.99, 0.995}, t[] = {row.p90, row.p95, row.p975, row.p99, row.p995};
    for (int i = 0; i < 5; ++i) EXPECT_NEAR(student_quantile(p[i], row.degrees), t[i], 0.5001e-3) << row.degrees << " " << p[i];
  }
}

// One degree: Cauchy's distribution. Two: t = a sqrt(2 / (1 - a^2)), a = 2 p - 1. Of 1 - p only 1e-16 is known.
TEST(tune_intervals_test, student_quantiles_of_one_and_two_degrees_are_closed_forms) {
  for (const double tail : {0.4, 0.1, 0.01, 1e-3, 1e-4, 1e-6}) {
    const double p = 1.0 - tail, a = 2.0 * p - 1.0;
    const double one = std::tan(std::numbers::pi * (p - 0.5)), two = a * std::sqrt(2.0 / ((1.0 - a) * (1.0 + a)));
    EXPECT_NEAR(student_quantile(p, 1), one, 1e-15 / tail * one + 1e-12 * one) << tail;
    EXPECT_NEAR(student_quantile(p, 2), two, 1e-15 / tail * two + 1e-12 * two) << tail;
  }
}

TEST(tune_intervals_test, student_quantile_inverts_the_integral_of_the_density) {
  for (const unsigned degrees : {1u, 2u, 3u, 4u, 7u, 8u, 15u, 31u, 63u, 64u, 255u, 1023u, 4095u})
    for (const double p : {0.51, 0.6, 0.8, 0.95, 0.975, 0.999, 0.99997})
      EXPECT_NEAR(distribution(student_quantile(p, degrees), degrees), p, 1e-9) << degrees << " " << p;
}

TEST(tune_intervals_test, student_quantiles_are_odd_about_one_half_and_fall_with_the_degrees) {
  for (const double p : {0.6, 0.9, 0.999})
    for (unsigned degrees = 1; degrees < 40; ++degrees) {
      EXPECT_NEAR(student_quantile(1.0 - p, degrees), -student_quantile(p, degrees), 1e-9 * student_quantile(p, degrees));
      EXPECT_GT(student_quantile(p, degrees), student_quantile(p, degrees + 1));
    }
  EXPECT_NEAR(student_quantile(0.5, 3), 0.0, 1e-12);
  EXPECT_NEAR(student_quantile(0.975, 1000000), 1.959964, 3e-6);  // the normal one: the next term is (z^3 + z) / (4 n)
}

// The signs of n values around the median are all equally likely: every case is tried. Values around a median of 0 with the signs
// of the bits; whether the interval holds it depends on nothing else.
TEST(tune_intervals_test, median_interval_covers_in_as_many_cases_as_it_says_and_a_shorter_one_would_not) {
  for (const double confidence : {0.5, 0.8, 0.9, 0.95, 0.99})
    for (unsigned n = 1; n <= 13; ++n) {
      unsigned cases = 0, held = 0, held_by_shorter = 0;
      const bool possible = 1.0 - std::exp2(1.0 - n) >= confidence;
      for (unsigned signs = 0; signs < 1u << n; ++signs) {
        std::vector<double> values(n);
        for (unsigned i = 0; i < n; ++i) values[i] = (signs >> i & 1 ? 1.0 : -1.0) * (1.0 + i);
        const Interval interval = median_interval(values, confidence);
        if (!possible) {
          ASSERT_EQ(interval.low, -std::numeric_limits<double>::infinity());
          ASSERT_EQ(interval.high, std::numeric_limits<double>::infinity());
          continue;
        }
        std::sort(values.begin(), values.end());
        const auto low = std::find(values.begin(), values.end(), interval.low), high = std::find(values.begin(), values.end(), interval.high);
        ASSERT_TRUE(low != values.end() && high != values.end());
        ASSERT_EQ(low - values.begin(), values.end() - 1 - high);
        ++cases;
        held += interval.contains(0.0);
        held_by_shorter += low + 1 <= high - 1 && *(low + 1) <= 0.0 && 0.0 <= *(high - 1);
      }
      if (!possible) continue;
      EXPECT_GE(held, confidence * cases) << n << " " << confidence;
      EXPECT_LT(held_by_shorter, confidence * cases) << n << " " << confidence;
    }
}

// Up to the most replicas that tune takes; two to their number is no double from 1024 on.
TEST(tune_intervals_test, median_interval_of_many_values_has_the_binomials_order) {
  for (const std::size_t n : {16u, 17u, 100u, 501u, 1000u})
    for (const double confidence : {0.9, 0.99, 0.9994}) {
      const Interval interval = median_interval(counted(n), confidence);
      unsigned k = 0;
      while (covered(static_cast<unsigned>(n), k + 1) >= confidence) ++k;
      EXPECT_EQ(interval.low, k) << n << " " << confidence;
      EXPECT_EQ(interval.high, static_cast<double>(n - 1 - k)) << n << " " << confidence;
      EXPECT_EQ(interval.estimate, 0.5 * static_cast<double>(n - 1));
    }
  // The normal approximation of the binomial: k + 1/2 is n/2 - z sqrt(n)/2, to within one.
  for (const std::size_t n : {1024u, 1100u, 2048u, 4096u})
    EXPECT_NEAR(median_interval(counted(n), 0.95).low, 0.5 * static_cast<double>(n) - 0.98 * std::sqrt(static_cast<double>(n)) - 0.5, 1.0)
        << n;
}

TEST(tune_intervals_test, few_values_say_nothing_of_their_median) {
  const Interval interval = median_interval({3.0}, 0.95);
  EXPECT_EQ(interval.estimate, 3.0);
  EXPECT_EQ(interval.low, -std::numeric_limits<double>::infinity());
  EXPECT_EQ(interval.high, std::numeric_limits<double>::infinity());
  for (const double confidence : {0.5, 0.9, 0.95, 0.9969}) {
    const std::size_t least = values_for_median(confidence);
    EXPECT_EQ(median_interval(counted(least), confidence).low, 0.0) << confidence;
    EXPECT_LT(median_interval(counted(least - 1), confidence).low, 0.0) << confidence;
  }
}

// 1 2 3 4 5: mean 3, variance 5/2, so that the standard error is sqrt(1/2); t of four degrees at 97.5 % is 2.776445.
TEST(tune_intervals_test, mean_interval_of_five_numbers_is_that_worked_by_hand) {
  const double values[] = {1, 2, 3, 4, 5};
  const Interval interval = mean_interval(values, 0.95);
  EXPECT_DOUBLE_EQ(interval.estimate, 3.0);
  EXPECT_NEAR(interval.low, 3.0 - 2.776445 * std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(interval.high, 3.0 + 2.776445 * std::sqrt(0.5), 1e-6);
}

TEST(tune_intervals_test, mean_interval_moves_and_grows_with_its_values) {
  Random random(1);
  std::vector<double> values(9), moved;
  for (double& value : values) value = random.unit();
  for (const double value : values) moved.push_back(7.0 - 3.0 * value);
  const Interval before = mean_interval(values, 0.9), after = mean_interval(moved, 0.9);
  EXPECT_NEAR(after.estimate, 7.0 - 3.0 * before.estimate, 1e-13);
  EXPECT_NEAR(after.low, 7.0 - 3.0 * before.high, 1e-13);
  EXPECT_NEAR(after.high, 7.0 - 3.0 * before.low, 1e-13);
}

TEST(tune_intervals_test, values_that_are_all_the_same_have_an_interval_of_length_zero) {
  const std::vector<double> values(11, 0.25);
  for (const Interval& interval : {mean_interval(values, 0.999), median_interval(values, 0.999), jackknife_interval(0.25, values, 0.999)}) {
    EXPECT_EQ(interval.low, 0.25);
    EXPECT_EQ(interval.high, 0.25);
    EXPECT_TRUE(interval.contains(0.25));
    EXPECT_FALSE(interval.contains(std::nextafter(0.25, 1.0)));
  }
}

// (Efron 1982, 3.1): of the mean, the jackknife's variance is the usual one.
TEST(tune_intervals_test, jackknife_of_the_mean_is_students_interval) {
  Random random(2);
  for (const std::size_t n : {2u, 3u, 4u, 16u, 33u}) {
    std::vector<double> values(n), without(n);
    double sum = 0.0;
    for (double& value : values) sum += value = random.unit() * random.unit();
    for (std::size_t i = 0; i < n; ++i) without[i] = (sum - values[i]) / static_cast<double>(n - 1);
    const Interval student = mean_interval(values, 0.95), jackknife = jackknife_interval(sum / static_cast<double>(n), without, 0.95);
    EXPECT_NEAR(jackknife.estimate, student.estimate, 1e-14);
    EXPECT_NEAR(jackknife.low, student.low, 1e-12);
    EXPECT_NEAR(jackknife.high, student.high, 1e-12);
  }
}
