#include "statistics.h"

#include <gtest/gtest.h>

#include "inputs.h"

using namespace oclair::test;

// For even degrees the tail is a finite Poisson sum: exp(-x/2) sum_{k < degrees/2} (x/2)^k / k!. Both branches of gamma_q are hit.
TEST(statistics_test, chi_square_tail_is_the_poisson_sum_for_even_degrees) {
  for (int degrees = 2; degrees <= 200; degrees += 2)
    for (double ratio : {0.2, 0.7, 0.95, 1.0, 1.1, 1.5, 3.0}) {
      const double half = ratio * degrees / 2;
      double term = 1, sum = 1;
      for (int k = 1; k < degrees / 2; ++k) sum += term *= half / k;
      const double expected = std::exp(-half) * sum;
      EXPECT_NEAR(chi_square_tail(2 * half, degrees), expected, 1e-13 + 1e-11 * expected) << degrees << " " << ratio;
    }
}

TEST(statistics_test, chi_square_tail_of_one_degree_is_that_of_a_squared_normal) {
  for (double z = 0.1; z < 8; z += 0.1) EXPECT_NEAR(chi_square_tail(z * z, 1), normal_tails(z), 1e-14 + 1e-11 * normal_tails(z));
}

// Upper quantiles of the normal distribution: 1.959964 and 4.264891 leave 5 % and 2e-5 in both tails.
TEST(statistics_test, normal_tails_meet_known_quantiles) {
  EXPECT_NEAR(normal_tails(1.959963984540054), 0.05, 1e-12);
  EXPECT_NEAR(normal_tails(-4.264890793922602), 2e-5, 1e-13);
}

TEST(statistics_test, fifty_tests_together_raise_a_false_alarm_in_a_thousand) {
  EXPECT_NEAR(-std::expm1(50 * std::log1p(-false_alarm)), 1e-3, 1e-6);
  EXPECT_NEAR(-std::expm1(7 * std::log1p(-significance(7))), false_alarm, 1e-12);
}

TEST(statistics_test, a_count_where_none_is_expected_is_impossible) {
  EXPECT_EQ(chi_square_test({50, 49, 1}, {50, 50, 0}), 0);
  EXPECT_EQ(chi_square_test({50, 50, 0}, {50, 50, 0}), 1);
}

TEST(statistics_test, expectations_with_another_total_are_impossible) { EXPECT_EQ(chi_square_test({50, 50}, {50, 51}), 0); }

// 8 of 2 + 2 + 2, then 60 of 2 + 50, then 40 of 50: three cells, two degrees of freedom, whose tail is exp(-statistic / 2).
TEST(statistics_test, small_cells_are_pooled_with_the_next_larger) {
  const double statistic = 4.0 / 6 + 64.0 / 52 + 100.0 / 50;
  EXPECT_NEAR(chi_square_test({60, 40, 8, 0, 0, 0}, {50, 50, 2, 2, 2, 2}), std::exp(-statistic / 2), 1e-12);
}

TEST(statistics_test, uniformity_test_accepts_uniform_and_rejects_a_slope_of_five_percent) {
  Random random(1);
  std::vector<double> flat(64), sloped(64);
  for (int i = 0; i < 1 << 18; ++i) {
    const double x = random.unit();
    ++flat[static_cast<std::size_t>(x * 64)];
    ++sloped[static_cast<std::size_t>((random.unit() < 0.05 ? std::sqrt(x) : x) * 64)];  // 5 % have density 2x
  }
  EXPECT_GT(uniformity_test(flat), false_alarm);
  EXPECT_LT(uniformity_test(sloped), false_alarm);
}

TEST(statistics_test, correlation_is_the_cosine_of_centred_vectors) {
  EXPECT_NEAR(correlation<double>({1, 2, 3, 4}, {2, 4, 6, 8}), 1, 1e-15);
  EXPECT_NEAR(correlation<double>({1, 2, 3, 4}, {4, 3, 2, 1}), -1, 1e-15);
  EXPECT_NEAR(correlation<double>({1, 2, 3}, {1, 3, 1}), 0, 1e-15);
}
