// A ray and a triangle in high precision on the same float inputs, with a rigorous bound of what float32 may make of them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "random.h"

namespace oclair::test {

using Corners = std::array<packed_float3, 3>;

// Sheared vertices a_x = (v_x - o_x) - s_x a_z, edge functions U = c_x b_y - c_y b_x, ...; in float each sheared coordinate
// errs by u (|v_x - o_x| + 3 |s_x a_z| + |a_x|): the difference, two roundings of s_x and one of a_z, the fma. The products of
// an edge function add u (|c_x b_y| + |c_y b_x| + |U|), and 2^-126 for each of three operations whose result may be flushed to
// zero. The parameter z = sum U_i z_i / sum U_i then errs by sum e_i |z_i - z| / |det'|, exactly, and by 10 roundings of |z| at
// most. All division and square root correctly rounded.
template <class Real>
struct TriangleOracle {
  bool certain_hit = false;   // whatever the rounding, for 0 < t < infinity
  bool certain_miss = false;
  Real t = 0, b1 = 0, b2 = 0;
  Real t_error = std::numeric_limits<Real>::infinity(), b_error = std::numeric_limits<Real>::infinity();
};

template <class Real>
TriangleOracle<Real> exact_intersection(const Ray& ray, const Corners& corners) {
  const Real u = Real(unit_roundoff) * Real(1.001);  // 1.001: products of errors
  const std::array<Real, 3> o{ray.origin.x, ray.origin.y, ray.origin.z}, d{ray.direction.x, ray.direction.y, ray.direction.z};
  int kz = 0;
  for (int i = 1; i < 3; ++i)
    if (std::abs(d[i]) > std::abs(d[kz])) kz = i;
  const int kx = (kz + 1) % 3, ky = (kz + 2) % 3;
  const Real sx = d[kx] / d[kz], sy = d[ky] / d[kz];
  std::array<Real, 3> x, y, z, ex, ey;
  Real z_largest = 0;
  for (int i = 0; i < 3; ++i) {
    const std::array<Real, 3> v{corners[i].x - o[0], corners[i].y - o[1], corners[i].z - o[2]};
    z[i] = v[kz];
    x[i] = v[kx] - sx * z[i];
    y[i] = v[ky] - sy * z[i];
    ex[i] = u * (std::abs(v[kx]) + 3 * std::abs(sx * z[i]) + std::abs(x[i]));
    ey[i] = u * (std::abs(v[ky]) + 3 * std::abs(sy * z[i]) + std::abs(y[i]));
    z_largest = std::max(z_largest, std::abs(z[i]));
  }
  std::array<Real, 3> edge, error;
  Real det = 0, det_error = 0;
  int above = 0, below = 0;
  for (int i = 0; i < 3; ++i) {
    const int b = (i + 1) % 3, c = (i + 2) % 3;
    edge[i] = x[c] * y[b] - y[c] * x[b];
    error[i] = std::abs(x[c]) * ey[b] + std::abs(y[b]) * ex[c] + std::abs(y[c]) * ex[b] + std::abs(x[b]) * ey[c] +
               ex[c] * ey[b] + ey[c] * ex[b] + u * (std::abs(x[c] * y[b]) + std::abs(y[c] * x[b]) + std::abs(edge[i])) +
               3 * Real(0x1p-126);
    det += edge[i];
    det_error += error[i];
    above += edge[i] > error[i];
    below += edge[i] < -error[i];
  }
  TriangleOracle<Real> result;
  const bool inside = above == 3 || below == 3;
  result.certain_miss = above > 0 && below > 0;
  const Real least_det = std::abs(det) - det_error;
  if (!(least_det > 0)) return result;
  Real hit_z = 0, spread = 0;
  for (int i = 0; i < 3; ++i) hit_z += edge[i] / det * z[i];
  for (int i = 0; i < 3; ++i) spread += error[i] * std::abs(z[i] - hit_z);
  result.t = hit_z / d[kz];
  result.b1 = edge[1] / det;
  result.b2 = edge[2] / det;
  if (!result.certain_miss) {
    result.t_error = (spread / least_det + 10 * u * z_largest) / std::abs(d[kz]);
    result.b_error = (std::max(error[1], error[2]) + det_error) / least_det + 4 * u;
    result.certain_miss = result.t < -result.t_error;
  }
  result.certain_hit = inside && result.t > result.t_error && std::abs(det) > Real(0x1p-100);  // below, products may underflow
  return result;
}

}  // namespace oclair::test
