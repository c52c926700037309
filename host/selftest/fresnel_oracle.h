// Fresnel's equations as textbooks print them (Born and Wolf 1999, sec. 1.5.2), in long double.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>

namespace oclair::test {

using Exact = long double;

// `eta` is the transmitted index over the incident one, `c` the incident cosine. Unpolarised light. Snell's law, without the
// cancellation of 1 - sin_i^2 / eta^2 at grazing incidence on nearly equal indices.
inline Exact exact_cos2_t(Exact c, Exact eta) { return (c * c + (eta - 1) * (eta + 1)) / (eta * eta); }

inline Exact exact_reflectance(Exact c, Exact eta) {
  const Exact cos2_t = exact_cos2_t(c, eta);
  if (cos2_t <= 0) return eta == 1 ? 0 : 1;
  const Exact t = std::sqrt(cos2_t);
  const Exact s = (c - eta * t) / (c + eta * t), p = (eta * c - t) / (eta * c + t);
  return (s * s + p * p) / 2;
}

// From the transmitted amplitudes 2 c / (c + eta t) and 2 c / (eta c + t), each squared times eta t / c: 1 - reflectance would
// lose all digits at grazing incidence.
inline Exact exact_transmittance(Exact c, Exact eta) {
  const Exact cos2_t = exact_cos2_t(c, eta);
  if (cos2_t <= 0) return eta == 1 ? 1 : 0;
  const Exact t = std::sqrt(cos2_t), s = c + eta * t, p = eta * c + t;
  return 2 * eta * t * c * (1 / (s * s) + 1 / (p * p));
}

// Cosine beyond which (towards grazing) everything is reflected; 0 if nothing ever is.
inline Exact critical_cosine(Exact eta) { return eta < 1 ? std::sqrt((1 - eta) * (1 + eta)) : 0; }

// Complex index eta + i k relative to the medium outside.
inline Exact exact_conductor(Exact c, Exact eta, Exact k) {
  const std::complex<Exact> n(eta, k);
  const std::complex<Exact> t = std::sqrt((c * c + (n - Exact(1)) * (n + Exact(1))) / (n * n));
  const std::complex<Exact> s = (c - n * t) / (c + n * t), p = (n * c - t) / (n * c + t);
  return (std::norm(s) + std::norm(p)) / 2;
}

}  // namespace oclair::test
