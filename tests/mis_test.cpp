#include "extremes.h"
#include "inputs.h"
#include "kernel.h"

using namespace oclair;
using namespace oclair::test;

namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

// Extreme X26: where a * a would overflow or vanish. Denormals only where the device keeps them: elsewhere they are 0.
std::vector<float> grid() {
  std::vector<float> values{0.0f,  FLT_MIN, 1e-30f, 1e-23f,  1e-19f, 1e-10f, 1e-3f,  0.1f, 0.5f,    1.0f,
                            1.5f,  3.0f,    1e3f,   1e10f,   1e18f,  1.9e19f, 1e25f, 1e38f, FLT_MAX, infinity};
  if (keeps_denormals())
    values.insert(values.end(), {1e-45f, 1e-44f, 1e-40f, 1e-38f});
  return values;
}

struct Pairs {
  std::vector<float> a, b, weight;
};

Pairs run_pairs(std::vector<float> a, std::vector<float> b) {
  Pairs pairs{std::move(a), std::move(b), {}};
  pairs.weight.resize(pairs.a.size());
  run("mis_test.cl", "power", pairs.a.size(), pairs.a, pairs.b, out(pairs.weight));
  return pairs;
}

Pairs run_grid() {
  std::vector<float> a, b;
  for (float x : grid())
    for (float y : grid()) a.push_back(x), b.push_back(y);
  return run_pairs(a, b);
}

// The definition (Veach 1997, eq. 9.13 with beta = 2); squares of floats neither overflow nor vanish in long double.
double power_heuristic(long double a, long double b) { return static_cast<double>(a * a / (a * a + b * b)); }

// Rounding: r = b/a (u), r^2 (3u), 1 + r^2 (1 + 3/2)u since r <= 1, and the last division: below 8u relative for the smaller
// weight r^2 / (1 + r^2), 3.5u for the larger. A weight below FLT_MIN may vanish.
double tolerance(double weight) { return 8 * unit_roundoff * weight + FLT_MIN; }

// With which of the strategies the kernel is compiled: both, scattering alone, light sampling alone.
struct Weights {
  std::vector<float> by_scattering, by_light;
};

Weights run_strategies(Approximations approximations, const std::vector<float>& scattering, const std::vector<float>& light) {
  Weights weights{std::vector<float>(light.size()), std::vector<float>(light.size())};
  KernelOptions options{every_feature};
  options.approximations = approximations;
  run_with(options, "mis_test.cl", "strategies", light.size(), scattering, light, out(weights.by_scattering), out(weights.by_light));
  return weights;
}

}  // namespace

TEST(mis_test, power_heuristic_is_the_ratio_of_squares) {
  Random random(10);
  std::vector<float> a(count_or_small(100000, 500)), b(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    a[i] = static_cast<float>(std::abs(random.signed_log_between(1e-30, 1e30)));
    b[i] = static_cast<float>(a[i] * std::abs(random.signed_log_between(1e-3, 1e3)));
  }
  const Pairs pairs = run_pairs(a, b);
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double expected = power_heuristic(a[i], b[i]);
    ASSERT_NEAR(pairs.weight[i], expected, tolerance(expected)) << a[i] << " " << b[i];
  }
}

TEST(mis_test, power_heuristic_is_right_where_squares_overflow_or_vanish) {
  const Pairs pairs = run_grid();
  double worst = 0;
  for (std::size_t i = 0; i < pairs.a.size(); ++i) {
    const float a = pairs.a[i], b = pairs.b[i];
    if (std::isinf(a) || std::isinf(b) || (a == 0 && b == 0)) continue;
    const double expected = power_heuristic(a, b);
    EXPECT_NEAR(pairs.weight[i], expected, tolerance(expected)) << a << " " << b;
    worst = std::max(worst, std::abs(pairs.weight[i] - expected) / tolerance(expected));
  }
  record_extreme("X26", worst, 1);
}

// 2u: each of the two weights is rounded once at its end, and the errors of the shared ratio cancel.
TEST(mis_test, weights_of_two_strategies_sum_to_one) {
  const std::size_t n = grid().size();
  const Pairs pairs = run_grid();
  double worst = 0;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) {
      const float w = pairs.weight[i * n + j], other = pairs.weight[j * n + i];
      EXPECT_TRUE(w >= 0 && w <= 1) << pairs.a[i * n + j] << " " << pairs.b[i * n + j] << " -> " << w;
      if (pairs.a[i * n + j] == 0 && pairs.b[i * n + j] == 0) continue;
      const double off = std::abs(static_cast<double>(w) + other - 1) / unit_roundoff;
      EXPECT_LE(off, 2) << pairs.a[i * n + j] << " " << pairs.b[i * n + j];
      worst = std::max(worst, off);
    }
  record_extreme("X26", worst, 2);
}

TEST(mis_test, limits_of_the_power_heuristic) {
  const std::vector<float> a{0.0f, infinity, 1.0f, infinity, 0.0f, infinity, 0.0f, 5.0f, FLT_MAX, FLT_MIN};
  const std::vector<float> b{0.0f, 1.0f, infinity, infinity, infinity, 0.0f, 1.0f, 0.0f, FLT_MAX, FLT_MIN};
  const std::vector<float> expected{0.0f, 1.0f, 0.0f, 0.5f, 0.0f, 1.0f, 0.0f, 1.0f, 0.5f, 0.5f};
  EXPECT_EQ(run_pairs(a, b).weight, expected);
}

// 2u as above; one strategy alone gives exactly one and nothing.
TEST(mis_test, light_that_is_found_both_ways_counts_once_with_any_strategy) {
  std::vector<float> scattering, light;
  for (float x : grid())
    for (float y : grid())
      if (x > 0 && y > 0) scattering.push_back(x), light.push_back(y);
  for (const Approximations one : {Approximations{0}, APPROXIMATION_BSDF_SAMPLING}) {
    const Weights w = run_strategies(one, scattering, light);
    for (std::size_t i = 0; i < light.size(); ++i) {
      EXPECT_LE(std::abs(static_cast<double>(w.by_scattering[i]) + w.by_light[i] - 1), one ? 0 : 2 * unit_roundoff)
          << one << ": " << scattering[i] << " " << light[i];
      if (one) { EXPECT_EQ(w.by_light[i], 0.0f) << scattering[i] << " " << light[i]; }
    }
  }
}

// What one strategy cannot find, density 0, the other has all of: point lights are left to light sampling, and emission that light
// sampling never picks to scattering.
TEST(mis_test, light_that_is_found_one_way_only_counts_whole_with_any_strategy) {
  std::vector<float> found;
  for (float x : grid())
    if (x > 0) found.push_back(x);
  const std::vector<float> never(found.size(), 0.0f), whole(found.size(), 1.0f);
  for (const Approximations one : {Approximations{0}, APPROXIMATION_BSDF_SAMPLING}) {
    EXPECT_EQ(run_strategies(one, found, never).by_scattering, whole) << one;
    EXPECT_EQ(run_strategies(one, never, found).by_light, whole) << one;
  }
}
