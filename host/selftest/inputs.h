// The scale of float rounding.
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

inline std::array<double, 3> normalized(std::array<double, 3> v) {
  const double length = std::hypot(v[0], v[1], v[2]);
  return {v[0] / length, v[1] / length, v[2] / length};
}

}  // namespace oclair::test
