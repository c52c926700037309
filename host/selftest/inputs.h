// The scale of float rounding, and the worst of many errors.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "random.h"

namespace oclair::test {

// Spacing of floats at |x|.
inline double ulp(double x) {
  const double magnitude = std::max(std::abs(x), 0x1p-126);
  return std::ldexp(1.0, std::ilogb(magnitude) - 23);
}

// The worst figure so far. NaN is worse than any number, and stays: a comparison alone would lose it to the next one.
inline void keep_worst(double& worst, double figure) {
  if (!std::isnan(worst) && !(figure <= worst)) worst = figure;
}

inline std::array<double, 3> normalized(std::array<double, 3> v) {
  const double length = std::hypot(v[0], v[1], v[2]);
  return {v[0] / length, v[1] / length, v[2] / length};
}

}  // namespace oclair::test
