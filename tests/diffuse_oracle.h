// pi f of the rough diffuse models as their papers print them, in angles and long double.
#pragma once

#include <algorithm>
#include <cmath>

namespace oclair::test {

using Exact = long double;

inline constexpr Exact exact_pi = 3.14159265358979323846264338327950288L;

// A pair of directions: polar angles, and the difference of the azimuths. Where one is the normal, any azimuth will do.
struct Angles {
  Exact in, out, azimuth;
};

template <class Vector>
Angles angles_of(const Vector& wi, const Vector& wo) {
  const auto polar = [](const Vector& w) { return std::atan2(std::hypot(Exact(w.s[0]), Exact(w.s[1])), Exact(w.s[2])); };
  return {polar(wi), polar(wo), std::atan2(Exact(wi.s[1]), Exact(wi.s[0])) - std::atan2(Exact(wo.s[1]), Exact(wo.s[0]))};
}

// Oren and Nayar 1994, eqs. 27 to 29, one channel; 0 where the fit is negative.
inline Exact exact_oren_nayar(const Angles& a, Exact sigma, Exact rho) {
  const Exact alpha = std::max(a.in, a.out), beta = std::min(a.in, a.out), azimuth = std::cos(a.azimuth), s2 = sigma * sigma;
  const Exact c1 = 1 - 0.5L * s2 / (s2 + 0.33L);
  const Exact c2 = 0.45L * s2 / (s2 + 0.09L) * (std::sin(alpha) - (azimuth >= 0 ? 0 : std::pow(2 * beta / exact_pi, 3)));
  const Exact c3 = 0.125L * s2 / (s2 + 0.09L) * std::pow(4 * alpha * beta / (exact_pi * exact_pi), 2);
  const Exact single = c1 + azimuth * c2 * std::tan(beta) + (1 - std::abs(azimuth)) * c3 * std::tan((alpha + beta) / 2);
  const Exact twofold = 0.17L * s2 / (s2 + 0.13L) * (1 - azimuth * std::pow(2 * beta / exact_pi, 2));
  return std::max(rho * single + rho * rho * twofold, Exact(0));
}

// Oren and Nayar 1994, eq. 30, for a reflectance of 1.
inline Exact exact_oren_nayar_fast(const Angles& a, Exact sigma) {
  const Exact s2 = sigma * sigma, A = 1 - 0.5L * s2 / (s2 + 0.33L), B = 0.45L * s2 / (s2 + 0.09L);
  return A + B * std::max(std::cos(a.azimuth), Exact(0)) * std::sin(std::max(a.in, a.out)) * std::tan(std::min(a.in, a.out));
}

// Its directional albedo in closed form.
inline Exact exact_oren_nayar_fast_albedo(Exact theta, Exact sigma) {
  const Exact s2 = sigma * sigma, A = 1 - 0.5L * s2 / (s2 + 0.33L), B = 0.45L * s2 / (s2 + 0.09L);
  const Exact s = std::sin(theta), c = std::cos(theta);
  return A + 2 * B / exact_pi * (s * (theta - s * c) / 2 + s / c * (1 - s * s * s) / 3);
}

// Burley 2012, 5.3, for a base colour of 1. cos_d: between either direction and the half vector.
inline Exact exact_disney(Exact cos_i, Exact cos_o, Exact cos_d, Exact roughness) {
  const Exact f90 = 0.5L + 2 * roughness * cos_d * cos_d;
  return (1 + (f90 - 1) * std::pow(1 - cos_i, 5)) * (1 + (f90 - 1) * std::pow(1 - cos_o, 5));
}

// Its directional albedo in closed form, m the cosine: the integral of a polynomial.
inline Exact exact_disney_albedo(Exact m, Exact r) {
  const Exact a = r - 0.5L, q = std::pow(1 - m, 5);
  return 1 + a / 21 + r * m / 84 +
         q * (a + 2 * r * m / 3 + a * a / 21 + a * r * m / 42 + r * r * m * m / 252 + 11 * r * r * (1 - m * m) / 504);
}

inline Exact exact_disney_hemispherical_albedo(Exact r) {
  const Exact a = r - 0.5L;
  return 1 + a / 21 + r / 126 + (a + a * a / 21 + 11 * r * r / 504) / 21 + (2 * r / 3 + a * r / 42) / 84 - r * r / 14112;
}

}  // namespace oclair::test
