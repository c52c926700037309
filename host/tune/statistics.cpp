#include "statistics.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace oclair::tune {
namespace {

// P(|T| < t), n degrees of freedom: Abramowitz and Stegun 1964, 26.7.3 (n odd) and 26.7.4 (n even).
double within(double t, unsigned n) {
  const double angle = std::atan(t / std::sqrt(static_cast<double>(n)));
  const double sine = std::sin(angle), cosine = std::cos(angle);
  if (n == 1) return 2.0 * angle / std::numbers::pi;
  const bool odd = n % 2 == 1;
  double term = odd ? cosine : 1.0, sum = term;
  for (unsigned k = odd ? 3 : 2; k < n - 1; k += 2) {
    term *= cosine * cosine * (k - 1.0) / k;
    sum += term;
  }
  return odd ? 2.0 / std::numbers::pi * (angle + sine * sum) : sine * sum;
}

double mean_of(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

Interval student_interval(double estimate, double standard_error, std::size_t values, double confidence) {
  const double reach = student_quantile(0.5 * (1.0 + confidence), static_cast<unsigned>(values - 1)) * standard_error;
  return {estimate, estimate - reach, estimate + reach};
}

}  // namespace

double student_quantile(double p, unsigned degrees) {
  assert(degrees >= 1 && p > 0.0 && p < 1.0);
  const double inside = std::abs(2.0 * p - 1.0);
  double low = 0.0, high = 1.0;
  while (within(high, degrees) < inside && high < 1e15) high *= 2.0;
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (within(middle, degrees) < inside ? low : high) = middle;
  }
  return p < 0.5 ? -high : high;
}

Interval mean_interval(std::span<const double> values, double confidence) {
  assert(values.size() >= 2);
  const double mean = mean_of(values), n = static_cast<double>(values.size());
  double squares = 0.0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return student_interval(mean, std::sqrt(squares / (n - 1.0) / n), values.size(), confidence);
}

Interval median_interval(std::vector<double> values, double confidence) {
  assert(!values.empty());
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  const double median = 0.5 * (values[(n - 1) / 2] + values[n / 2]);
  // The median lies below the (k + 1)-th least with probability P(binomial(n, 1/2) <= k), and likewise above. By logarithms: from
  // n = 1075 on 2^-n is no double.
  double outside = 0.0, log_probability = -static_cast<double>(n) * std::numbers::ln2;
  std::size_t count = 0;  // of values that lie outside on each side, and one
  for (std::size_t i = 0; i < n / 2; ++i) {
    outside += std::exp(log_probability);
    if (2.0 * outside > 1.0 - confidence) break;
    count = i + 1;
    log_probability += std::log(static_cast<double>(n - i) / static_cast<double>(i + 1));
  }
  if (count == 0) return {median, -std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  return {median, values[count - 1], values[n - count]};
}

std::size_t values_for_median(double confidence) {
  std::size_t count = 1;  // the range misses the median if all lie on one side of it
  while (std::exp2(1.0 - static_cast<double>(count)) > 1.0 - confidence) ++count;
  return count;
}

Interval jackknife_interval(double all, std::span<const double> without, double confidence) {
  assert(without.size() >= 2);
  const double mean = mean_of(without), n = static_cast<double>(without.size());
  double squares = 0.0;
  for (const double value : without) squares += (value - mean) * (value - mean);
  return student_interval(all, std::sqrt((n - 1.0) / n * squares), without.size(), confidence);
}

}  // namespace oclair::tune
