// Which settings oclair tune judges accurate enough, puts on the front and recommends, against brute force.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "../host/tune/tune.h"
#include "random.h"

using namespace oclair;
using namespace oclair::test;
using namespace oclair::tune;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

Interval around(double estimate, double factor) { return {estimate, estimate / factor, estimate * factor}; }

// A setting as it may be measured.
Row random_row(Random& random) {
  Row row;
  row.effect = static_cast<Effect>(random.below(3));
  Estimates& e = row.estimates;
  e.same = row.effect == Effect::none;
  e.speed = around(random.log_between(0.25, 4.0), random.between(1.0, 1.3));
  e.variance = around(random.log_between(0.1, 10.0), random.between(1.0, 1.3));
  const double error = random.log_between(1e-3, 0.1), reach = random.log_between(1e-7, 1e-3);
  e.squared_bias = {error * error, error * error - reach, error * error + reach};
  if (random.below(4) == 0) e.squared_bias.estimate = -1e-6, e.squared_bias.low = -1e-5;
  e.bias_bound = random.log_between(1e-4, 0.1);
  e.replica_variance = 0.04 * e.variance.estimate;
  e.replica_seconds = 2.0 / e.speed.estimate;
  return row;
}

// Time to the error over that of the accurate setting, and the bias: none where there can be none.
double bias_of(const Row& row) {
  return row.effect == Effect::bias && !row.estimates.same ? std::max(0.0, row.estimates.squared_bias.estimate) : 0.0;
}

struct Point {
  double gain, bias;
};
bool dominates(Point a, Point b) { return a.gain >= b.gain && a.bias <= b.bias && (a.gain > b.gain || a.bias < b.bias); }

}  // namespace

TEST(tune_rank_test, gain_is_the_ratio_of_the_times_to_the_error) {
  Random random(1);
  for (const double error : {0.005, 0.02, 0.2})
    for (int i = 0; i < 500; ++i) {
      Row row = random_row(random);
      if (row.estimates.same) row.estimates.variance = {1, 1, 1}, row.estimates.replica_variance = 0.04;
      judge(row, error);
      const double accurate = seconds_to_error(error, 0.0, 0.04, 2.0).value();
      EXPECT_NEAR(row.gain.estimate, row.seconds ? accurate / *row.seconds : 0.0, 1e-9 * row.gain.estimate);
      EXPECT_LE(row.gain.low, row.gain.estimate);
      EXPECT_GE(row.gain.high, row.gain.estimate);
    }
}

// At the worst ends of its intervals a gain is no worse than its low end.
TEST(tune_rank_test, gain_is_between_those_of_the_ends_of_its_intervals) {
  Random random(2);
  constexpr double error = 0.03;
  for (int i = 0; i < 500; ++i) {
    Row row = random_row(random);
    if (row.effect == Effect::none) continue;
    judge(row, error);
    const Estimates& e = row.estimates;
    for (const double speed : {e.speed.low, e.speed.high})
      for (const double variance : {e.variance.low, e.variance.high})
        for (const double bias : {e.squared_bias.low, e.squared_bias.high}) {
          const double square = row.effect == Effect::bias ? bias : 0.0;
          const auto seconds = seconds_to_error(error, square, 0.04 * variance, 2.0 / speed);
          const double gain = seconds ? seconds_to_error(error, 0.0, 0.04, 2.0).value() / *seconds : 0.0;
          EXPECT_LE(row.gain.low, gain * (1 + 1e-9));
          EXPECT_GE(row.gain.high, gain * (1 - 1e-9));
        }
  }
}

TEST(tune_rank_test, a_bias_is_small_enough_only_if_both_its_bounds_are_below_the_error) {
  Random random(3);
  int enough = 0, biased = 0;
  for (int i = 0; i < 1000; ++i) {
    Row row = random_row(random);
    judge(row, 0.03);
    const Estimates& e = row.estimates;
    if (row.effect != Effect::bias) {
      EXPECT_TRUE(row.accurate_enough);
      continue;
    }
    ++biased;
    enough += row.accurate_enough;
    EXPECT_EQ(row.accurate_enough, std::sqrt(std::max(0.0, e.squared_bias.high)) < 0.03 && e.bias_bound < 0.03);
  }
  EXPECT_GT(enough, biased / 10);
  EXPECT_LT(enough, biased * 9 / 10);
}

TEST(tune_rank_test, what_should_have_no_effect_and_shows_one_is_not_accurate_enough) {
  Row row;
  row.estimates.speed = row.estimates.variance = {1, 1, 1};
  const auto enough = [&](Effect effect, bool same, Interval bias) {
    row.effect = effect;
    row.estimates.same = same;
    row.estimates.bias = bias;
    judge(row, 0.05);
    return row.accurate_enough;
  };
  const Interval around_none{0.001, -0.001, 0.002}, none{0, 0, 0}, darker{-0.085, -0.09, -0.08};
  EXPECT_TRUE(enough(Effect::none, true, none));
  EXPECT_FALSE(enough(Effect::none, false, around_none));
  EXPECT_TRUE(enough(Effect::noise, true, none));
  EXPECT_TRUE(enough(Effect::noise, false, around_none));
  EXPECT_FALSE(enough(Effect::noise, false, darker));
  // The samples seen do not bound what others may lose.
  EXPECT_FALSE(enough(Effect::bias, true, none));
}

// And it is worth no more than what owns up to as much bias.
TEST(tune_rank_test, a_bias_that_should_not_be_there_counts_as_one) {
  Result result;
  result.request.error = 0.05;
  for (const Effect effect : {Effect::bias, Effect::noise, Effect::none}) {
    Row row;
    row.effect = effect;
    row.estimates.speed = {3, 2.9, 3.1};
    row.estimates.variance = {1, 0.9, 1.1};
    row.estimates.bias = {-0.03, -0.031, -0.029};
    row.estimates.squared_bias = {1e-3, 0.9e-3, 1.1e-3};
    row.estimates.bias_bound = 0.031;
    row.estimates.replica_variance = 0.04;
    row.estimates.replica_seconds = 1.0;
    judge(row, result.request.error);
    EXPECT_NEAR(row.gain.estimate, 3.0 * (1.0 - 1e-3 / 0.0025), 1e-12);
    EXPECT_EQ(row.accurate_enough, effect == Effect::bias);
    result.rows.push_back(row);
  }
  Row honest;  // slower, without a bias
  honest.effect = Effect::noise;
  honest.estimates.speed = {1.5, 1.4, 1.6};
  honest.estimates.variance = {1, 0.99, 1.01};
  honest.estimates.replica_variance = 0.04;
  honest.estimates.replica_seconds = 2.0;
  judge(honest, result.request.error);
  result.rows.push_back(honest);
  rank(result);
  for (const Row& row : result.rows) EXPECT_TRUE(row.on_front) << static_cast<int>(row.effect);
  EXPECT_EQ(result.rows.at(result.recommended.value()).effect, Effect::bias);
}

// A setting may have no noise at all where the accurate one has some (a path cut short in a uniform room), and the reverse.
TEST(tune_rank_test, gains_are_numbers_where_a_variance_is_zero_or_unbounded) {
  for (const Interval variance : {Interval{0, 0, 0}, Interval{infinity, 0, infinity}, Interval{1, 0, infinity}, Interval{1, 1, 1}})
    for (const double bias : {0.0, 1e-4, 1.0, 100.0}) {
      Row row;
      row.effect = Effect::bias;
      row.estimates.speed = {2, 1, 4};
      row.estimates.variance = variance;
      row.estimates.squared_bias = {bias, bias, bias};
      row.estimates.replica_variance = 0.0;
      row.estimates.replica_seconds = 1.0;
      judge(row, 0.05);
      for (const double gain : {row.gain.estimate, row.gain.low, row.gain.high}) EXPECT_FALSE(std::isnan(gain)) << variance.estimate << " " << bias;
      EXPECT_LE(row.gain.low, row.gain.estimate);
      EXPECT_LE(row.gain.estimate, row.gain.high);
      if (bias >= 1.0) {
        EXPECT_EQ(row.gain.high, 0.0) << "no time makes up for the bias";
        EXPECT_FALSE(row.seconds);
        EXPECT_FALSE(row.accurate_enough);
      }
    }
}

TEST(tune_rank_test, front_and_recommendation_are_those_of_brute_force) {
  Random random(4);
  constexpr double error = 0.03;
  int recommended = 0, none = 0;
  for (int run = 0; run < 500; ++run) {
    Result result;
    result.request.error = error;
    for (std::uint32_t i = 0, n = random.below(12); i < n; ++i) {
      Row row = random_row(random);
      row.name = std::to_string(i);
      judge(row, error);
      result.rows.push_back(row);
      if (random.below(6) == 0) result.rows.push_back(row);  // two settings that are alike
    }
    result.recommended = 5;  // of an earlier ranking
    rank(result);
    EXPECT_TRUE(std::is_sorted(result.rows.begin(), result.rows.end(), [](const Row& a, const Row& b) { return a.gain.estimate > b.gain.estimate; }));
    const Row* best = nullptr;
    for (const Row& row : result.rows) {
      const Point point{row.gain.estimate, bias_of(row)};
      bool front = row.seconds.has_value() && !dominates({1.0, 0.0}, point);
      for (const Row& other : result.rows) front = front && !dominates({other.gain.estimate, bias_of(other)}, point);
      EXPECT_EQ(row.on_front, front) << point.gain << " " << point.bias;
      if (row.accurate_enough && row.gain.low > 1.0 && (!best || row.gain.estimate > best->gain.estimate)) best = &row;
    }
    ASSERT_EQ(result.recommended.has_value(), best != nullptr);
    if (best) { EXPECT_EQ(result.rows[*result.recommended].gain.estimate, best->gain.estimate); }
    ++(best ? recommended : none);
  }
  EXPECT_GT(recommended, 50);
  EXPECT_GT(none, 20);
}

TEST(tune_rank_test, the_accurate_setting_is_recommended_where_nothing_surely_gains) {
  Row row;
  row.effect = Effect::noise;
  row.estimates.speed = {1.2, 0.99, 1.5};
  row.estimates.variance = {1, 1, 1};
  row.estimates.replica_variance = row.estimates.replica_seconds = 1.0;
  judge(row, 0.02);
  Result result;
  result.rows = {row};
  rank(result);
  EXPECT_FALSE(result.recommended);
  EXPECT_TRUE(result.rows[0].on_front);
}
