#include "quadrature.h"

#include <gtest/gtest.h>

using namespace oclair::test;

TEST(quadrature_test, gauss_legendre_is_exact_up_to_degree_2n_minus_1_and_not_beyond) {
  for (int n : {2, 3, 8, 16}) {
    const auto integral = [&](int degree) {
      double sum = 0;
      for (const Node& node : gauss_legendre(n, 0, 1)) sum += node.weight * std::pow(node.x, degree);
      return sum;
    };
    for (int degree = 0; degree <= 2 * n - 1; ++degree)
      EXPECT_NEAR(integral(degree), 1.0 / (degree + 1), 1e-14) << n << " " << degree;
    if (n <= 3) {
      EXPECT_GT(std::abs(integral(2 * n) - 1.0 / (2 * n + 1)), 1e-4) << n;
    }
  }
}

TEST(quadrature_test, gauss_legendre_meets_the_integral_of_a_transcendental_function_on_any_interval) {
  double sum = 0;
  for (const Node& node : gauss_legendre(12, -1, 2)) sum += node.weight * std::exp(node.x);
  EXPECT_NEAR(sum, std::exp(2.0) - std::exp(-1.0), 1e-13);
}
