#include "filter.h"

#include <algorithm>
#include <cmath>

namespace oclair {

std::vector<std::array<float, 2>> filter_table(FilterKind kind, double radius, double stddev) {
  // The Gaussian's density is off by at most width^2 f''/8 = 3e-5 of its peak between the entries.
  const int count = kind == FilterKind::box ? 2 : kind == FilterKind::tent ? 3 : 513;
  const double width = 2.0 * radius / (count - 1);
  std::vector<double> density(count, 1.0);
  if (kind == FilterKind::tent) density = {0.0, 1.0, 0.0};
  if (kind == FilterKind::gaussian) {
    const double edge = std::exp(-0.5 * radius * radius / (stddev * stddev));
    for (int i = 0; i < count; ++i) {
      const double x = -radius + i * width;
      density[i] = std::max(0.0, std::exp(-0.5 * x * x / (stddev * stddev)) - edge);
    }
  }
  double total = 0.0;
  for (int i = 0; i + 1 < count; ++i) total += 0.5 * width * (density[i] + density[i + 1]);
  std::vector<std::array<float, 2>> table(count);
  double integral = 0.0;
  for (int i = 0; i < count; ++i) {
    if (i > 0) integral += 0.5 * width * (density[i - 1] + density[i]) / total;
    table[i] = {static_cast<float>(density[i] / total), static_cast<float>(integral)};
  }
  table.back()[1] = 1.0f;
  return table;
}

}  // namespace oclair
