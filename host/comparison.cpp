#include "comparison.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace oclair {

// Relative MSE: Rousselle, Knaus, Zwicker 2011, "Adaptive sampling and reconstruction using greedy error minimization",
// where the 0.01 keeps dark pixels from deciding alone. SMAPE: Armstrong 1985, "Long-Range Forecasting", p. 348, here
// without its factor 2 so that 1 is the most; two zeros agree.
Metrics compare(std::span<const float> x, std::span<const float> r) {
  assert(x.size() == r.size());
  Metrics m;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!std::isfinite(x[i]) || !std::isfinite(r[i])) {
      ++m.left_out;
      continue;
    }
    ++m.values;
    const double xi = x[i], ri = r[i], difference = xi - ri, size = std::abs(xi) + std::abs(ri);
    m.mean += ri;
    m.signed_mean += difference;
    m.mse += difference * difference;
    m.relative_mse += difference * difference / (ri * ri + 0.01);
    m.smape += size > 0.0 ? std::abs(difference) / size : 0.0;
    if (std::abs(difference) > m.maximum) {
      m.maximum = std::abs(difference);
      m.maximum_at = i;
    }
  }
  const double count = static_cast<double>(std::max<std::uint64_t>(m.values, 1));
  for (double* sum : {&m.mean, &m.signed_mean, &m.mse, &m.relative_mse, &m.smape}) *sum /= count;
  return m;
}

Quantiles quantiles(std::vector<float> values) {
  if (values.empty()) return {};
  const auto at = [&](double p) {
    const double rank = std::ceil(p * static_cast<double>(values.size()));
    const auto position = values.begin() + static_cast<std::ptrdiff_t>(std::max(rank, 1.0)) - 1;
    std::nth_element(values.begin(), position, values.end());
    return static_cast<double>(*position);
  };
  return {at(0.5), at(0.99), at(1.0)};
}

Quantiles deviations(std::span<const float> a, std::span<const float> b, std::span<const float> sa,
                     std::span<const float> sb) {
  assert(a.size() == b.size() && a.size() == sa.size() && a.size() == sb.size());
  std::vector<float> z;
  z.reserve(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double error = std::hypot(double{sa[i]}, double{sb[i]}), difference = std::abs(double{a[i]} - b[i]);
    if (std::isfinite(error) && std::isfinite(difference) && error > 0.0)
      z.push_back(static_cast<float>(difference / error));
  }
  return quantiles(std::move(z));
}

}  // namespace oclair
