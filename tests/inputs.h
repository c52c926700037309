// Inputs for kernel tests, the same on every machine, and the scale of float rounding.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

namespace oclair::test {

inline constexpr double unit_roundoff = 0x1p-24;  // of float: u; a correctly rounded operation errs by a factor within 1 +- u

// Spacing of floats at |x|.
inline double ulp(double x) {
  const double magnitude = std::max(std::abs(x), 0x1p-126);
  return std::ldexp(1.0, std::ilogb(magnitude) - 23);
}

inline std::array<double, 3> normalized(std::array<double, 3> v) {
  const double length = std::hypot(v[0], v[1], v[2]);
  return {v[0] / length, v[1] / length, v[2] / length};
}

// std::mt19937_64 is specified to the bit; the standard distributions are not.
class Random {
 public:
  explicit Random(std::uint64_t seed) : bits_(seed) {}
  std::uint64_t bits() { return bits_(); }
  double uniform() { return static_cast<double>(bits_() >> 11) * 0x1p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  // Magnitude log-uniform in [low, high], sign random.
  double log_uniform(double low, double high) {
    const double magnitude = low * std::pow(high / low, uniform());
    return (bits_() & 1) ? magnitude : -magnitude;
  }
  std::array<double, 3> direction() {
    const double z = uniform(-1, 1), phi = uniform(0, 2 * 3.14159265358979323846), r = std::sqrt((1 - z) * (1 + z));
    return {r * std::cos(phi), r * std::sin(phi), z};
  }

 private:
  std::mt19937_64 bits_;
};

}  // namespace oclair::test
