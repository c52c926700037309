// Pearson's chi-square test, as a standard normal deviate (Wilson and Hilferty 1931: good to .01 for 30 degrees of freedom and more).
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace oclair::test {

// Two-sided bound on a normal deviate: 50 tests with a family false-alarm rate of 1e-3 (Sidak: 2e-5 each).
inline constexpr double sidak_z = 4.27;

// Deviate of counts against expected numbers, which sum to the same total.
inline double chi_square_z(const std::vector<double>& counts, const std::vector<double>& expected) {
  double x = 0.0;
  for (std::size_t i = 0; i < counts.size(); ++i) x += (counts[i] - expected[i]) * (counts[i] - expected[i]) / expected[i];
  const double k = static_cast<double>(counts.size()) - 1.0, v = 2.0 / (9.0 * k);
  return (std::cbrt(x / k) - (1.0 - v)) / std::sqrt(v);
}

inline double chi_square_z_uniform(const std::vector<double>& counts) {
  double total = 0.0;
  for (double c : counts) total += c;
  return chi_square_z(counts, std::vector<double>(counts.size(), total / static_cast<double>(counts.size())));
}

}  // namespace oclair::test
