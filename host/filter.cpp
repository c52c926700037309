#include "filter.h"

#include <algorithm>
#include <cmath>

namespace oclair {

std::vector<FilterEntry> filter_table(FilterKind kind, double radius, double stddev) {
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
  std::vector<FilterEntry> table(count);
  double integral = 0.0;
  for (int i = 0; i < count; ++i) {
    if (i > 0) integral += 0.5 * width * (density[i - 1] + density[i]) / total;
    table[i] = {static_cast<float>(density[i] / total), static_cast<float>(integral), 0};
  }
  table.back().integral = 1.0f;
  for (int i = 0, first = 0; i < count; ++i) {
    // The device multiplies by count - 1 with a relative error of 2^-24, and may come out here with a little less than i / (count - 1).
    const double least = i / (count - 1.0) * (1.0 - 0x1p-23);
    while (first < count - 2 && table[first + 1].integral <= least) ++first;
    table[i].first = static_cast<uint>(first);
  }
  return table;
}

}  // namespace oclair
