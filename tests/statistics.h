// The arithmetic of statistical tests. Seeds are fixed, so a test that passes once passes always; its false-alarm rate says how
// likely a correct renderer was to fail when the seed was chosen.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

namespace oclair::test {

// Of one statistical TEST, by Sidak: 1e-3 over a suite of 50.
inline constexpr double false_alarm = 2e-5;
inline constexpr double sidak_z = 4.27;  // the same as a two-sided bound on a normal deviate

// The same for each of `comparisons` within one TEST.
inline double significance(double comparisons) { return -std::expm1(std::log1p(-false_alarm) / comparisons); }

// Regularised incomplete gamma function Q(a, x) = Gamma(a, x) / Gamma(a): Abramowitz and Stegun 1964, 6.5.29 (series of P) below
// x = a + 1, 6.5.31 (continued fraction, evaluated by Lentz's method) above.
inline double gamma_q(double a, double x) {
  if (!(x > 0)) return 1;
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  const double front = std::exp(a * std::log(x) - x - std::lgamma(a));
  if (x < a + 1) {
    double term = 1 / a, sum = term;
    for (double n = a + 1; term > epsilon * sum; ++n) sum += term *= x / n;
    return 1 - front * sum;
  }
  double b = x + 1 - a, c = std::numeric_limits<double>::max(), d = 1 / b, fraction = d;
  for (double n = 1, step = 0; std::abs(step - 1) > epsilon && n < 1e6; ++n) {
    b += 2;
    const double numerator = n * (a - n);
    d = 1 / (numerator * d + b);
    c = b + numerator / c;
    fraction *= step = c * d;
  }
  return front * fraction;
}

// That a standard normal variable is at least |z| away from 0.
inline double normal_tails(double z) { return std::erfc(std::abs(z) / std::sqrt(2.0)); }

// The bound on |z| for each of `comparisons` within one TEST, by bisection; z_bound(1) is sidak_z.
inline double z_bound(double comparisons) {
  double low = 0, high = 40;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (normal_tails(middle) > significance(comparisons) ? low : high) = middle;
  }
  return high;
}

// That a chi-square variable of so many degrees of freedom is at least `statistic`.
inline double chi_square_tail(double statistic, double degrees) { return gamma_q(degrees / 2, statistic / 2); }

// Pearson's test of counts against expected counts of the same total: its p-value. Cells in which fewer than 5 are expected are
// pooled, smallest first and else in the order given, never by what was counted. A count where none is expected, or an expected
// total that is not the counts', is impossible: 0.
inline double chi_square_test(const std::vector<double>& observed, const std::vector<double>& expected) {
  const double total = std::accumulate(observed.begin(), observed.end(), 0.0);
  if (!(std::abs(std::accumulate(expected.begin(), expected.end(), 0.0) - total) <= 1e-6 * total)) return 0;
  std::vector<std::pair<double, double>> cells;
  for (std::size_t i = 0; i < observed.size(); ++i) {
    if (expected[i] > 0)
      cells.emplace_back(expected[i], observed[i]);
    else if (observed[i] > 0)
      return 0;
  }
  std::stable_sort(cells.begin(), cells.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  double statistic = 0, pooled_expected = 0, pooled_observed = 0;
  int used = 0;
  for (const auto& [e, o] : cells) {
    pooled_expected += e;
    pooled_observed += o;
    if (pooled_expected < 5) continue;
    statistic += (pooled_observed - pooled_expected) * (pooled_observed - pooled_expected) / pooled_expected;
    pooled_expected = pooled_observed = 0;
    ++used;
  }
  return used > 1 ? chi_square_tail(statistic, used - 1) : 1;
}

// The same against equal expectations.
inline double uniformity_test(const std::vector<double>& observed) {
  const double total = std::accumulate(observed.begin(), observed.end(), 0.0);
  return chi_square_test(observed, std::vector<double>(observed.size(), total / static_cast<double>(observed.size())));
}

// Pearson's correlation of pairs.
template <class T>
double correlation(const std::vector<T>& x, const std::vector<T>& y) {
  const double n = static_cast<double>(x.size());
  double sx = 0, sy = 0, sxx = 0, syy = 0, sxy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double a = x[i], b = y[i];
    sx += a, sy += b, sxx += a * a, syy += b * b, sxy += a * b;
  }
  return (sxy - sx * sy / n) / std::sqrt((sxx - sx * sx / n) * (syy - sy * sy / n));
}

}  // namespace oclair::test
