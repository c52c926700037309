// Metrics of two images against closed forms.
#include "../host/comparison.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

using namespace oclair;

// Values k / 64 and 2^-4 more are exact in float: so are the sums in double, but for the quotients.
TEST(comparison_test, an_image_that_is_brighter_by_a_constant_has_its_closed_forms) {
  std::vector<float> x, r;
  double relative = 0.0, smape = 0.0;
  for (int k = 1; k <= 64; ++k) {
    r.push_back(static_cast<float>(k) / 64.0f);
    x.push_back(r.back() + 0.0625f);
    relative += 0.0625 * 0.0625 / (k * k / 4096.0 + 0.01) / 64.0;
    smape += 4.0 / (2.0 * k + 4.0) / 64.0;
  }
  const Metrics m = compare(x, r);
  EXPECT_EQ(m.values, 64u);
  EXPECT_EQ(m.mean, 65.0 / 128.0);
  EXPECT_EQ(m.signed_mean, 0.0625);
  EXPECT_EQ(m.mse, 0.0625 * 0.0625);
  EXPECT_EQ(m.maximum, 0.0625);
  EXPECT_NEAR(m.relative_mse, relative, 64 * 0x1p-52 * relative);
  EXPECT_NEAR(m.smape, smape, 64 * 0x1p-52 * smape);
  EXPECT_EQ(compare(r, x).signed_mean, -0.0625);
}

// 1 / 0.01; 4 / (1 + 0.01); the floats are exact, the figures have three roundings.
TEST(comparison_test, relative_errors_have_a_floor_that_is_0_01) {
  EXPECT_NEAR(compare(std::vector{1.0f}, std::vector{0.0f}).relative_mse, 100.0, 100.0 * 0x1p-51);
  EXPECT_NEAR(compare(std::vector{3.0f}, std::vector{1.0f}).relative_mse, 4.0 / 1.01, 4.0 * 0x1p-51);
  EXPECT_EQ(compare(std::vector{3.0f}, std::vector{1.0f}).smape, 0.5);
  EXPECT_EQ(compare(std::vector{1.0f}, std::vector{0.0f}).smape, 1.0);
}

TEST(comparison_test, the_largest_difference_is_the_first_of_its_size) {
  const Metrics m = compare(std::vector{1.0f, 2.0f, 9.0f, 4.0f}, std::vector{1.0f, 4.0f, 9.0f, 2.0f});
  EXPECT_EQ(m.maximum, 2.0);
  EXPECT_EQ(m.maximum_at, 1u);
}

TEST(comparison_test, equal_images_have_no_error_and_black_ones_agree) {
  const std::vector<float> r = {0.0f, 1.0f, 3e38f, 1e-45f};
  const Metrics m = compare(r, r);
  for (const double figure : {m.signed_mean, m.mse, m.relative_mse, m.smape, m.maximum}) EXPECT_EQ(figure, 0.0);
  EXPECT_EQ(m.values, 4u);
}

TEST(comparison_test, values_that_are_not_finite_are_counted_and_left_out) {
  constexpr float infinity = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<float> x = {1.0f, nan, 2.0f, infinity}, r = {1.0f, 1.0f, infinity, infinity};
  const Metrics m = compare(x, r);
  EXPECT_EQ(m.values, 1u);
  EXPECT_EQ(m.left_out, 3u);
  EXPECT_EQ(m.mse, 0.0);
}

TEST(comparison_test, quantiles_are_the_values_of_their_rank) {
  std::vector<float> values;
  for (int k = 0; k < 1000; ++k) values.push_back(static_cast<float>((k * 7) % 1000 + 1));  // 1 to 1000, mixed
  const Quantiles q = quantiles(values);
  EXPECT_EQ(q.median, 500.0);
  EXPECT_EQ(q.p99, 990.0);
  EXPECT_EQ(q.maximum, 1000.0);
  EXPECT_EQ(quantiles({}).maximum, 0.0);
}

// 3-4-5 triangles.
TEST(comparison_test, deviations_are_in_units_of_both_errors) {
  const std::vector<float> a = {15.0f, 1.0f, 7.0f}, b = {5.0f, 1.5f, 7.0f}, sa = {3.0f, 0.0f, 0.0f},
                           sb = {4.0f, 0.25f, 0.0f};
  const Quantiles z = deviations(a, b, sa, sb);
  EXPECT_EQ(z.maximum, 2.0);
  EXPECT_EQ(z.median, 2.0);  // of two: the third has no error
}
