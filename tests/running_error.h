// Running error analysis (Wilkinson 1963; Higham 2002, "Accuracy and Stability of Numerical Algorithms", 3.3): a number, and
// a bound of how far float arithmetic may end from it. Written in it, the formula of a kernel gives its own bound: errors of
// what went in are multiplied by the derivatives, each operation adds its rounding.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "random.h"

namespace oclair::test {

struct Rounded {
  double value = 0, error = 0;  // |float - value| <= error
  Rounded() = default;
  Rounded(double exact) : value(exact) {}  // what float holds exactly: inputs and small integers
  Rounded(double v, double e) : value(v), error(e) {}
};

// A result v whose arguments make an error e, rounded within `relative` of itself; or flushed to zero below 2^-126.
inline Rounded rounded(double v, double e, double relative = unit_roundoff) {
  return {v, e + relative * (std::abs(v) + e) + 0x1p-126};
}
// A function that OpenCL C 1.2 (7.4) allows so many ulps: an ulp is at most 2 u of its number.
inline Rounded within_ulps(double v, double e, double ulps) { return rounded(v, e, 2 * ulps * unit_roundoff); }
inline Rounded constant(double c) { return rounded(c, 0); }

inline Rounded operator-(Rounded a) { return {-a.value, a.error}; }
inline Rounded operator+(Rounded a, Rounded b) { return rounded(a.value + b.value, a.error + b.error); }
inline Rounded operator-(Rounded a, Rounded b) { return a + -b; }
inline double product_error(Rounded a, Rounded b) {
  return std::abs(a.value) * b.error + std::abs(b.value) * a.error + a.error * b.error;
}
inline Rounded operator*(Rounded a, Rounded b) { return rounded(a.value * b.value, product_error(a, b)); }
inline Rounded operator/(Rounded a, Rounded b) {
  const double below = std::abs(b.value) - b.error;
  if (!(below > 0)) return {a.value / b.value, std::numeric_limits<double>::infinity()};
  return rounded(a.value / b.value, (a.error + std::abs(a.value / b.value) * b.error) / below);
}
inline Rounded fma(Rounded a, Rounded b, Rounded c) {
  return rounded(a.value * b.value + c.value, product_error(a, b) + c.error);
}

inline double root_error(Rounded a) {
  return a.error > 0 ? a.error / (std::sqrt(a.value) + std::sqrt(std::max(a.value - a.error, 0.0))) : 0;
}
inline Rounded sqrt(Rounded a) {
  return a.value > 0 ? rounded(std::sqrt(a.value), root_error(a)) : Rounded(0, std::sqrt(a.error));
}
inline Rounded rsqrt(Rounded a) {
  const double least = std::max(a.value - a.error, 0.0);
  return within_ulps(1 / std::sqrt(a.value), 1 / std::sqrt(least) - 1 / std::sqrt(a.value), 2);
}
inline Rounded hypot(Rounded a, Rounded b) {
  return within_ulps(std::hypot(a.value, b.value), std::hypot(a.error, b.error), 4);
}
inline Rounded atan2(Rounded y, Rounded x) {
  const double distance = std::hypot(x.value, y.value), error = std::hypot(x.error, y.error);
  return within_ulps(std::atan2(y.value, x.value), error < distance ? std::asin(error / distance) : 4, 6);
}
inline Rounded fabs(Rounded a) { return {std::abs(a.value), a.error}; }
inline Rounded fmax(Rounded a, Rounded b) { return {std::max(a.value, b.value), std::max(a.error, b.error)}; }
inline Rounded fmin(Rounded a, Rounded b) { return {std::min(a.value, b.value), std::max(a.error, b.error)}; }

struct Rounded3 {
  Rounded x, y, z;
};
inline Rounded3 operator+(const Rounded3& a, const Rounded3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Rounded3 operator-(const Rounded3& a) { return {-a.x, -a.y, -a.z}; }
inline Rounded3 operator-(const Rounded3& a, const Rounded3& b) { return a + -b; }
inline Rounded3 operator*(const Rounded3& a, Rounded s) { return {a.x * s, a.y * s, a.z * s}; }
// In whatever order the three are added.
inline Rounded dot(const Rounded3& a, const Rounded3& b) {
  const Rounded x = a.x * b.x, y = a.y * b.y, z = a.z * b.z;
  const double most = std::abs(x.value) + std::abs(y.value) + std::abs(z.value) + x.error + y.error + z.error;
  return {x.value + y.value + z.value, x.error + y.error + z.error + 2.0001 * unit_roundoff * most};
}
inline Rounded3 fabs(const Rounded3& a) { return {fabs(a.x), fabs(a.y), fabs(a.z)}; }
inline Rounded max_component(const Rounded3& a) { return fmax(fmax(a.x, a.y), a.z); }
// 2.75 + n/2 and 2 + n/2 ulps for vectors of n.
inline Rounded length(const Rounded3& a) {
  return within_ulps(std::hypot(a.x.value, a.y.value, a.z.value), std::hypot(a.x.error, a.y.error, a.z.error), 4.25);
}
inline Rounded3 normalize(const Rounded3& a) {
  const double n = std::hypot(a.x.value, a.y.value, a.z.value), error = std::hypot(a.x.error, a.y.error, a.z.error);
  const double turned = error < n ? 2 * error / n : 2;  // of the unit vector: 2 sin(angle / 2) < 2 sin(angle)
  const auto part = [&](Rounded c) { return rounded(c.value / n, turned, 2 * 3.5 * unit_roundoff); };
  return {part(a.x), part(a.y), part(a.z)};
}

// Of the kernels: difference_of_products is right to 1.5 ulps of its result.
inline Rounded difference_of_products(Rounded a, Rounded b, Rounded c, Rounded d) {
  return within_ulps(a.value * b.value - c.value * d.value, product_error(a, b) + product_error(c, d), 1.5);
}
inline Rounded3 cross_exact(const Rounded3& a, const Rounded3& b) {
  return {difference_of_products(a.y, b.z, a.z, b.y), difference_of_products(a.z, b.x, a.x, b.z),
          difference_of_products(a.x, b.y, a.y, b.x)};
}
inline Rounded3 renormalize(const Rounded3& d) { return d * fma(-0.5, dot(d, d), 1.5); }

struct RoundedFrame {
  Rounded3 x, y, z;
};
inline RoundedFrame frame_from_normal(const Rounded3& n) {
  const Rounded s = std::copysign(1.0, n.z.value);
  const Rounded a = -(Rounded(1) / (s + n.z)), b = n.x * n.y * a;
  return {{1 + s * n.x * n.x * a, s * b, -(s * n.x)}, {b, s + n.y * n.y * a, -n.y}, n};
}
inline Rounded3 frame_to_world(const RoundedFrame& f, const Rounded3& v) { return f.x * v.x + f.y * v.y + f.z * v.z; }

}  // namespace oclair::test
