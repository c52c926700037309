// Seeded numbers for tests and the self-test, the same with every standard library.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <random>

#include "../../cl/types.h"

namespace oclair::test {

inline constexpr double unit_roundoff = 0x1p-24;  // u, of float32: a correctly rounded operation errs by a factor within 1 +- u

inline packed_float3 packed(const glm::dvec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}
inline glm::dvec3 unpacked(const packed_float3& v) { return {v.x, v.y, v.z}; }

struct Random {
  std::mt19937_64 engine;
  explicit Random(std::uint64_t seed) : engine(seed) {}

  double unit() { return static_cast<double>(engine() >> 11) * 0x1p-53; }
  double between(double low, double high) { return low + (high - low) * unit(); }
  float unit24() { return static_cast<float>(engine() >> 40) * 0x1p-24f; }
  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(engine() % n); }
  double sign() { return engine() & 1 ? 1.0 : -1.0; }
  double log_between(double low, double high) { return std::exp(between(std::log(low), std::log(high))); }

  double signed_log_between(double low, double high) {
    const double magnitude = log_between(low, high);
    return sign() * magnitude;
  }

  glm::dvec3 in_cube(double half = 1.0) {
    const double x = between(-half, half), y = between(-half, half), z = between(-half, half);
    return {x, y, z};
  }
  glm::dvec3 direction() {
    const double z = between(-1.0, 1.0), phi = between(0.0, 6.283185307179586), r = std::sqrt(1.0 - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
  }
};

}  // namespace oclair::test
