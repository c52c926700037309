#include "fresnel_oracle.h"
#include "groups.h"

namespace oclair::selftest {
namespace {

struct Rows {
  std::vector<float> cosine, eta;
  std::vector<cl_uint> front;
  Exact true_eta(std::size_t i) const { return front[i] ? Exact(eta[i]) : 1 / Exact(eta[i]); }
};

// Air, almost air, water, glass, diamond and an absurd index, from both sides: cosines on a grid, down to 1e-20, and
// beside 1.
Rows rows() {
  Rows list;
  for (const float eta : {1.0f, 1.000001f, 1.0001f, 1.33f, 1.5f, 2.42f, 1e3f})
    for (const cl_uint front : {0u, 1u}) {
      const auto add = [&](double cosine) {
        list.cosine.push_back(static_cast<float>(cosine));
        list.eta.push_back(eta);
        list.front.push_back(front);
      };
      add(0.0);
      for (int k = 1; k <= 20; ++k) add(std::pow(10.0, -k));
      for (int k = 0; k <= 8; ++k) add(1.0 - k * 0x1p-24);
      for (int k = 1; k < 4000; ++k) add(k / 4000.0);
    }
  return list;
}

// How far the result is from what the formula gives between cosines 4 u below and above the given one: near the critical
// angle no code in float has a small error for the cosine itself.
double distance(Exact formula(Exact, Exact), Exact cosine, Exact eta, Exact result) {
  if (std::isnan(result)) return std::numeric_limits<double>::quiet_NaN();
  const auto [least, most] = std::minmax({formula(cosine * (1 - 4 * Exact(unit_roundoff)), eta), formula(cosine, eta),
                                          formula(std::min(cosine * (1 + 4 * Exact(unit_roundoff)), Exact(1)), eta)});
  return static_cast<double>(std::max({least - result, result - most, Exact(0)}));
}

}  // namespace

// Both within 1e-6 of Fresnel's equations in long double, some 16 roundings of quantities of order 1, the transmittance of
// itself; the refracted direction has unit length, and its sine obeys Snell's law to the rounding of its own components.
void check_fresnel(const Session& session, Group& group) {
  const Rows list = rows();
  const std::size_t count = list.cosine.size();
  std::vector<cl_float4> result(count), refracted(count);
  run(session, "fresnel", count, list.cosine, list.eta, list.front, out(result), out(refracted));
  double reflectance = 0, transmittance = 0, lost = 0, length = 0, snell = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Exact cosine = list.cosine[i], eta = list.true_eta(i);
    keep_worst(reflectance, distance(exact_reflectance, cosine, eta, result[i].s[0]));
    const Exact through = exact_transmittance(cosine, eta);
    if (through > 0)
      keep_worst(transmittance, distance(exact_transmittance, cosine, eta, result[i].s[1]) / static_cast<double>(through));
    else
      keep_worst(transmittance, result[i].s[1]);
    keep_worst(lost, std::abs(static_cast<double>(result[i].s[0]) + result[i].s[1] - 1.0));
    if (!(result[i].s[1] > 0.0f) || eta > 3)
      continue;  // Snell's law to u eta: the lengths of absurd indices are not asked for
    const auto& d = refracted[i].s;
    keep_worst(length, std::abs(std::hypot(d[0], d[1], d[2]) - 1.0));
    keep_worst(snell, std::abs(-static_cast<double>(eta) * d[0] - d[3]) / std::max(1.0, static_cast<double>(eta)));
  }
  group.measure("angles", static_cast<double>(count));
  group.bound("error of R", reflectance, 1e-6 * slack(session));
  group.bound("of T, of itself", transmittance, 1e-6 * slack(session));
  group.bound("|R + T - 1|", lost, 1e-6 * slack(session));
  group.bound("refracted length", length, 1e-6 * slack(session));
  group.bound("Snell's law", snell, 8 * unit_roundoff * slack(session));
}

}  // namespace oclair::selftest
