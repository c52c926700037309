#include "distribution.h"

#include <algorithm>
#include <cmath>

namespace oclair {

std::vector<uint> distribution(const std::vector<double>& weights) {
  const std::size_t n = weights.size();
  long double total = 0.0L;
  for (double w : weights) total += w;
  const long double units = 4294967296.0L - static_cast<long double>(n);  // one unit for each item is set aside
  std::vector<uint> cdf(n);
  long double sum = 0.0L;
  for (std::size_t i = 0; i + 1 < n; ++i) {
    sum += weights[i];
    cdf[i] = static_cast<uint>(std::min(units, std::floor(sum / total * units)) + static_cast<long double>(i + 1));
  }
  cdf[n - 1] = 0xffffffffu;
  return cdf;
}

}  // namespace oclair
